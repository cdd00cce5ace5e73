"""What all stepping engines do alike: refuse, compare, settle, step, record.

A physics engine says how to open a world and how to step it in chunks; the order of things, and
what is written down of them, is here, once.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from harness.case import Case, Value
from harness.engines.base import Capabilities, Setting, World, resolve
from harness.engines.horizon import Watch, longest_time, natural_time
from harness.engines.parity import parity
from harness.engines.recorder import Recorder
from harness.engines.settling import settle
from harness.simulation import Outcome, ParityRow, Simulation
from harness.trajectory import Integers, Trajectory
from models.errors import InvalidValueError
from models.rim import release_state

W = TypeVar("W", bound=World)

_LOOK_SHARE = 0.1
"""Natural times sqrt(R/g) between two looks at the horizon, so that little is stepped in vain."""

_FEWEST, _MOST = 16, 4096
"""Steps in a chunk: enough to pay for the look, few enough to stay in the cache."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunk:
    """Consecutive steps: the states before each of them with the contacts that they solved.

    Parameters
    ----------
    trajectory : Trajectory or None
        Every step; None if not one of the states is a state.
    constraint_rows : ndarray of int, shape (n,)
        Rows that each step solved for.
    sound : bool
        False if the engine's numbers broke within or right after these steps.
    """

    trajectory: Trajectory | None
    constraint_rows: Integers
    sound: bool


class PhysicsEngine(ABC, Generic[W]):
    """An engine that advances a world by timesteps."""

    name: str
    settings: tuple[Setting, ...]
    capabilities: Capabilities
    default_timestep: float
    matched_timestep: float
    imposed_by_default: frozenset[str]

    @property
    @abstractmethod
    def version(self) -> str:
        """The version of the engine's package."""

    @abstractmethod
    def open(self, case: Case) -> W:
        """Compile the scene of a case."""

    @abstractmethod
    def chunks(self, world: W, steps: int, size: int) -> Iterator[Chunk]:
        """Step so many times from where the world is, at most `size` steps a chunk."""

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s."""
        if case.timestep is not None:
            return case.timestep
        return self.default_timestep if case.profile == "default" else self.matched_timestep

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case."""
        return resolve(case, self.settings, self.timestep(case))

    def parity(self, case: Case) -> tuple[ParityRow, ...]:
        """Return the compiled model of a case against its scene."""
        imposed = self.imposed_by_default if case.profile == "default" else frozenset[str]()
        return parity(self.open(case), case.scene, self.timestep(case), imposed)

    def simulate(self, case: Case) -> Simulation:
        """Run a case to its horizon; numerical failure is its outcome.

        Raises
        ------
        UnknownSettingError, InvalidSettingError
            If the case asks for what the engine does not have.
        """
        started = time.perf_counter()
        empty = Simulation(
            case=case,
            outcome=Outcome.MISMATCH,
            trajectory=None,
            engine_version=self.version,
            model=self.name,
            timestep=self.timestep(case),
            settings=self.resolve(case),
        )
        pose, twist = release_state(case.scene.can, case.scene.release)
        rows: tuple[ParityRow, ...] = ()
        try:
            rows = self.parity(case)
            differing = ", ".join(row.quantity for row in rows if row.verdict == "mismatch")
            if differing:
                setup = time.perf_counter() - started
                return replace(empty, note=differing, parity=rows, setup_s=setup)
            depth, pose = settle(self.open(case), case.scene, pose, twist)
        except InvalidValueError as error:  # a pose or twist read back holds no numbers
            note = f"within the probes before the run: {error}"
            return replace(empty, outcome=Outcome.DIVERGED, note=note, parity=rows)
        world = self.open(case)  # a fresh one, so that nothing of the probes is left in it
        world.place(pose, twist)
        setup = time.perf_counter() - started
        return self._run(
            world, replace(empty, parity=rows, setup_s=setup, static_penetration=depth)
        )

    def _run(self, world: W, prepared: Simulation) -> Simulation:
        """Step until the watch or the horizon ends it; return what was prepared, completed."""
        case = prepared.case
        recorder, watch = Recorder(case.scene), Watch(case.scene)
        timestep, limit = self.timestep(case), longest_time(case.scene)
        at_limit = Outcome.FINISHED if case.scene.horizon.seconds else Outcome.TIMED_OUT
        size = round(natural_time(case.scene) / timestep * _LOOK_SHARE)
        # both ends of the horizon are recorded; the share absorbs the round-off of the division
        total = int(limit / timestep * (1.0 + 1e-12)) + 1
        rows_of_steps: list[Integers] = []
        outcome: Outcome | None = None
        wall, cpu = time.perf_counter(), time.process_time()
        for chunk in self.chunks(world, total, min(max(size, _FEWEST), _MOST)):
            rows_of_steps.append(chunk.constraint_rows)
            if chunk.trajectory is not None:
                kept = recorder.add(chunk.trajectory)
                outcome = watch.over(kept) if kept is not None else None
            if outcome is None and not chunk.sound:
                outcome = Outcome.DIVERGED
            if outcome is not None:
                break
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        trajectory = recorder.trajectory(watch.ended_at)
        steps = round(float(trajectory.time[-1]) / timestep) + 1
        return replace(
            prepared,
            outcome=outcome or at_limit,
            trajectory=trajectory,
            steps=steps,
            constraint_rows=int(np.concatenate(rows_of_steps)[:steps].sum()),
            wall_s=wall,
            cpu_s=cpu,
        )
