"""What all stepping engines do alike: refuse, compare, settle, step, record.

A physics engine says how to open a world and how to step it in chunks; the order of things, and
what is written down of them, is here, once.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

from harness.case import Case, Value
from harness.engines.base import Capabilities, Effort, Gap, Setting, World, resolve
from harness.engines.chunk import Chunk
from harness.engines.foresight import Foresight
from harness.engines.horizon import countable, longest_time, natural_time
from harness.engines.looks import Looks
from harness.engines.parity import parity
from harness.engines.recorder import SAMPLES_IN_TIME
from harness.engines.recording import record
from harness.engines.schedule import (
    LARGEST_SHARE,
    SMALLEST_SHARE,
    Adaptive,
    Fixed,
    Schedule,
    power_of_two,
)
from harness.engines.settling import settle
from harness.simulation import Outcome, ParityRow, Simulation
from harness.trajectory import Trajectory
from models.errors import InvalidValueError
from models.rim import released
from models.state import Pose, Twist

W = TypeVar("W", bound=World)

_FEWEST = 16
MOST = 16384
"""Steps in a chunk: enough to pay for the look, few enough to be held, 180 bytes each."""

_FIRST = 64
"""Steps in the first chunk of fixed steps; each that follows may be four times as long. What starts
wrong breaks within some tens of steps, and four short looks are little beside a run that does not.
"""

_ADAPTIVE_LOOK = 1024
"""Steps in a chunk whose stages may be short: a look costs as much as thirty steps."""


class PhysicsEngine(ABC, Generic[W]):
    """An engine that advances a world by timesteps."""

    name: str
    settings: tuple[Setting, ...]
    capabilities: Capabilities
    default_timestep: float
    matched_timestep: float
    imposed_by_default: frozenset[str]
    gaps: tuple[Gap, ...] = ()
    efforts: tuple[Effort, ...] = ()

    @property
    @abstractmethod
    def version(self) -> str:
        """The version of the engine's package."""

    @abstractmethod
    def open(self, case: Case) -> W:
        """Compile the scene of a case."""

    @abstractmethod
    def chunks(self, world: W, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s; the largest of an adaptive one.

        Raises
        ------
        InvalidSettingError
            If it is so short that nobody could count the steps.
        """
        if case.timestep is not None:
            countable(case.timestep, case.scene)
        if case.profile == "adaptive":
            return power_of_two(case.timestep or LARGEST_SHARE * natural_time(case.scene))
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
        prepared, pose, twist = self._prepare(case)
        if pose is None or twist is None:
            return prepared
        world = self.open(case)  # a fresh one, so that nothing of the probes is left in it
        world.place(pose, twist)
        return self._run(world, prepared)

    def _prepare(self, case: Case) -> tuple[Simulation, Pose | None, Twist | None]:
        """Return a case checked and settled: what is known before the run, and its release.

        Without a release the run is over before it began, and its outcome says why.
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
        pose, twist = released(case.scene)
        rows: tuple[ParityRow, ...] = ()
        try:
            rows = self.parity(case)
            differing = ", ".join(row.quantity for row in rows if row.verdict == "mismatch")
            if differing:
                setup = time.perf_counter() - started
                return replace(empty, note=differing, parity=rows, setup_s=setup), None, None
            depth, pose = settle(self.open(case), case.scene, pose, twist)
        except InvalidValueError as error:  # a pose or twist read back holds no numbers
            note = f"within the probes before the run: {error}"
            return replace(empty, outcome=Outcome.DIVERGED, note=note, parity=rows), None, None
        setup = time.perf_counter() - started
        done = replace(empty, parity=rows, setup_s=setup, static_penetration=depth)
        return done, pose, twist

    def simulate_many(self, cases: Sequence[Case]) -> list[Simulation]:
        """Run cases, with the same results as one by one; an engine may know a faster way."""
        return [self.simulate(case) for case in cases]

    def leanest(self, world: W, steps: int) -> None:
        """Step so many times and do nothing else: no reading, no record."""
        for _ in range(steps):
            world.step()

    def keeping(self, world: W, steps: int) -> None:
        """Step so many times and keep each state and contact: the leanest loop with a record."""
        kept = []
        for _ in range(steps):
            state = world.pose(), world.twist()
            world.step()
            kept.append((*state, world.contact()))

    def _run(self, world: W, prepared: Simulation) -> Simulation:
        """Step until the watch or the horizon ends it; return what was prepared, completed."""
        schedule, size = self._schedule(prepared)
        foresight = Foresight(prepared.case.scene)

        def seen(kept: Trajectory) -> None:
            foresight.see(kept)
            if isinstance(schedule, Fixed):
                schedule.size = _size(foresight, schedule.largest)

        wall, cpu = time.perf_counter(), time.process_time()
        done = record(prepared, self.chunks(world, schedule, size), seen)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        return replace(done, wall_s=wall, cpu_s=cpu)

    def _schedule(self, prepared: Simulation) -> tuple[Schedule, int]:
        """Return the schedule of a case, and how many steps to take between two looks."""
        case, timestep = prepared.case, self.timestep(prepared.case)
        scene, limit = case.scene, longest_time(case.scene)
        looks = Looks(natural_time(scene) / SAMPLES_IN_TIME)
        if case.profile != "adaptive":
            fixed = Fixed(timestep, limit, _size(Foresight(scene), timestep), _FIRST)
            fixed.looks = looks
            return fixed, 1  # a stage is a chunk
        adaptive = Adaptive(
            scene.can,
            largest=timestep,
            smallest=SMALLEST_SHARE * natural_time(scene),
            limit=limit,
            eta=float(prepared.settings["eta"]),  # type: ignore[arg-type]
            unit=natural_time(scene),
        )
        adaptive.looks = looks
        return adaptive, _ADAPTIVE_LOOK


def _size(foresight: Foresight, timestep: float) -> int:
    """Return the steps to take before looking at the horizon."""
    return int(min(max(foresight.ahead() / timestep, _FEWEST), MOST))
