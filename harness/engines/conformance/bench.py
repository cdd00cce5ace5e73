"""Where an engine is tried: the scenes and cases of the suite, and runs that checks share.

Everything is the release `gentle-rock` of the catalogue: for 20 ms, of which every timestep is
recorded; through its bounce; or thrown so that it flies.
"""

from dataclasses import replace

from harness.case import Case, Value
from harness.engines.base import Engine
from harness.engines.soundness import fault
from harness.simulation import Simulation
from harness.trajectory import Trajectory
from models.catalogue import load
from models.scene import Horizon, Scene

COARSE = 1e-3
"""s: longer than the recorder's time step for the can of the suite, so that no step is left out."""

FINE = 1e-4
"""s: the bounce of the suite's scene is resolved."""

BRIEF = 0.02
"""s: long enough for a contact to come to rest, too short for the bounce."""


class BrokenContractError(Exception):
    """A run that is no simulation of its case; the message says why."""


class Bench:
    """One engine under test.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.gentle: Scene = load("gentle-rock")
        self.brief: Scene = replace(self.gentle, horizon=Horizon(seconds=BRIEF))
        release = replace(self.gentle.release, phi_dot=60.0)  # the centre outruns the falling rim
        self.thrown: Scene = replace(self.gentle, release=release, horizon=Horizon(seconds=5e-3))
        self._runs: dict[Case, Simulation] = {}

    @property
    def steps(self) -> bool:
        """Whether the engine takes timesteps, rather than choosing its own."""
        return self.engine.timestep(Case(scene=self.brief, engine=self.engine.name)) is not None

    def case(self, scene: Scene, timestep: float = COARSE, **options: Value) -> Case:
        """Return a case of the engine, matched; the timestep is left out where it takes none."""
        return Case(
            scene=scene,
            engine=self.engine.name,
            timestep=timestep if self.steps else None,
            options=tuple(options.items()),
        )

    def run(self, case: Case) -> Simulation:
        """Return a run of a case, the same one whenever it is asked for."""
        if case not in self._runs:
            self._runs[case] = self.run_anew(case)
        return self._runs[case]

    def run_anew(self, case: Case) -> Simulation:
        """Run a case.

        Raises
        ------
        BrokenContractError
            If the answer is no simulation of it.
        """
        answer = self.engine.simulate(case)
        reason = fault(answer, case)
        if reason:
            raise BrokenContractError(reason)
        return answer

    def trajectory(self, case: Case) -> Trajectory:
        """Return the trajectory of a run.

        Raises
        ------
        BrokenContractError
            If there is none.
        """
        simulation = self.run(case)
        if simulation.trajectory is None:
            raise BrokenContractError(
                f"no trajectory: {simulation.outcome.value} {simulation.note}".strip()
            )
        return simulation.trajectory
