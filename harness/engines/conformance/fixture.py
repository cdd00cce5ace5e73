"""The scenes, cases and shared runs of the suite, and the clauses of the contract.

Every scene is the release `gentle-rock` of the catalogue: for 20 ms, of which every timestep is
recorded; through its bounce; or thrown so that it flies. A clause passes, fails or does not apply,
and says by which number.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

from harness.core.case import Case, Value
from harness.core.simulation import Simulation
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine
from harness.engines.contract import contract_violation
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


class Fixture:
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
        reason = contract_violation(answer, case)
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


class ClauseStatus(Enum):
    """How a check ended."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClauseResult:
    """The result of one check.

    Parameters
    ----------
    name, sentence : str
        Of the check; empty until `conform` puts them in.
    result : ClauseStatus
    number, allowed : float or None
        What was measured, and the most that passes; None where the answer is yes or no.
    unit : str
    detail : str
        What was looked at, or what was wrong.
    """

    name: str = ""
    sentence: str = ""
    result: ClauseStatus
    number: float | None = None
    allowed: float | None = None
    unit: str = ""
    detail: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One clause of the contract.

    Parameters
    ----------
    name : str
        A word or two.
    sentence : str
        What an adapter promises.
    look : callable
        Finds out; whatever it raises is a failure of the adapter.
    needs_run : bool
        Whether it has nothing to look at where no run hands over a trajectory.
    """

    name: str
    sentence: str
    look: Callable[[Fixture], ClauseResult]
    needs_run: bool = True


CHECKS: list[Check] = []
"""Every clause, in the order in which the modules of the suite define them."""

_Look = Callable[[Fixture], ClauseResult]


def clause(name: str, sentence: str, *, needs_run: bool = True) -> Callable[[_Look], _Look]:
    """Return a decorator that enters a function into the contract."""

    def enter(look: _Look) -> _Look:
        CHECKS.append(Check(name=name, sentence=sentence, look=look, needs_run=needs_run))
        return look

    return enter


def within(number: float, allowed: float, unit: str, detail: str) -> ClauseResult:
    """Return passed if a number is at most what is allowed; a number that is none fails."""
    result = ClauseStatus.PASSED if number <= allowed else ClauseStatus.FAILED
    return ClauseResult(result=result, number=number, allowed=allowed, unit=unit, detail=detail)


def holds(wrong: str, detail: str) -> ClauseResult:
    """Return failed with what is wrong, or passed with what was looked at if nothing is."""
    result = ClauseStatus.FAILED if wrong else ClauseStatus.PASSED
    return ClauseResult(result=result, detail=wrong or detail)


def not_applicable(why: str) -> ClauseResult:
    """Return that a check does not apply."""
    return ClauseResult(result=ClauseStatus.NOT_APPLICABLE, detail=why)
