"""The part that all stepping engines share: refuse, compare, settle, step, record.

A physics engine says how to open a world and how to step it in chunks; the order of the run, and
what is recorded of it, is here.

A look at the horizon costs as much as a hundred steps, and steps past the end are wasted. The end
is not known beforehand, but rocking is symmetric in time: a rise takes about as long as the fall
before it, and a run ends soon after a can has risen, or at a time that is given.
`HorizonPrediction` predicts the end from this; the prediction decides how a run is cut into chunks,
and nothing else.
"""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Generic, TypeVar

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.public_paths import warn_renamed
from harness.core.simulation import Outcome, ParityRow, Simulation
from harness.core.trajectory import Floats
from harness.engines.base import Capabilities, ModelDifference, Setting, SolverEffort, resolve
from harness.engines.description import Description, Precision
from harness.engines.parity.checks import parity
from harness.engines.stepping.horizon import countable, longest_time, natural_time
from harness.engines.stepping.recording import SAMPLES_IN_TIME, Chunk, SamplingInterval, record
from harness.engines.stepping.schedule import (
    LARGEST_SHARE,
    RISE_MARGIN,
    SMALLEST_SHARE,
    Adaptive,
    Fixed,
    Schedule,
    power_of_two,
)
from harness.engines.stepping.settling import ALOFT, AT_REST, above_origin, settle, stepped
from harness.engines.world import World, signed_distance
from harness.execution.worker_main import compiling
from models import InvalidValueError, Scene
from models.rim import released

SHORTEST = 0.02
"""Natural times sqrt(R/g) between two looks where the end is near, or nothing is known yet."""


class HorizonPrediction:
    """Follows the samples of a run and foresees its end.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Scene) -> None:
        self._shortest = SHORTEST * natural_time(scene)
        self._timed = scene.horizon.seconds is not None
        self._rising = False
        self._turned = self._now = self._fall = self._seen_falling = 0.0
        self._extreme, self._highest = -scene.release.phi, scene.release.phi

    def see(self, time: Floats, phi: Floats) -> None:
        """Take samples into account that follow those before; one turn of the tilt is enough.

        Parameters
        ----------
        time, phi : ndarray, shape (n,)
            s, and nutation in rad.
        """
        self._now = float(time[-1])
        if not self._seen_falling:
            # what shows at the end that a rise is over takes as long as it took at the release
            falls = phi < (1.0 - PROMINENCE) * self._highest
            self._seen_falling = float(time[int(np.argmax(falls))]) if falls.any() else 0.0
        height = phi if self._rising else -phi
        at = int(np.argmax(height))
        if height[at] >= self._extreme:
            self._extreme, extreme = float(height[at]), float(time[at])
        else:
            extreme = float(time[0])
        if at < len(phi) - 1:
            self._fall, self._turned = extreme - self._turned, extreme
            self._rising, self._extreme = not self._rising, -float(height[-1])

    def ahead(self) -> float:
        """Return the time to step before looking again, s."""
        if self._timed:
            return np.inf
        since = self._now - self._turned
        if self._rising:
            # a rise takes as long as the fall
            left = RISE_MARGIN * (self._fall + self._seen_falling) - since
        elif self._turned == 0.0:
            # as long as the fall has taken
            left = since
        else:
            # the run may be over: until a fall would show, and then half as long again;
            # what takes long to show is no fall from rest, and tells nothing of the next
            shown = RISE_MARGIN * self._seen_falling - since
            soon = shown > 0.0 and self._seen_falling < self._fall / 2.0
            left = shown if soon else since / 2.0
        return max(left, self._shortest)


W = TypeVar("W", bound=World)

MOST = 16384
"""Steps in a chunk: enough to pay for the look, few enough to be held, 180 bytes each."""

_FIRST = 64
"""Steps in the first chunk of fixed steps, but where a look costs more than these; each chunk that
follows may be four times as long. What starts wrong breaks within some tens of steps, and four
short looks cost little in a run that does not.
"""

_ADAPTIVE_LOOK = 1024
"""Steps in a chunk whose stages may be short: a look costs as much as thirty steps."""


_INTERVAL = 1e-3
"""Natural times that a world of an engine with error control is advanced by in the probes: a
thousandth of a fall, which is some of its steps."""

_OWN_LOOK = 256
"""Steps of an engine with error control in a chunk."""

_COMPILED: set[object] = set()
"""What decides the program of an engine, of each that this process has compiled."""


class WorldEngine(ABC, Generic[W]):
    """An engine that advances a world, by timesteps or by steps of its own choice."""

    name: str
    settings: tuple[Setting, ...]
    capabilities: Capabilities
    description = Description()
    imposed: Mapping[str, Mapping[str, float] | frozenset[str]] = MappingProxyType({})
    """By profile, the rows of parity in which the engine goes its own way; see `imposed_in`."""
    model_differences: tuple[ModelDifference, ...] = ()
    solver_efforts: tuple[SolverEffort, ...] = ()
    fewest_steps = 16
    """Steps between two looks, at least: more where a step takes microseconds, as a look takes a
    hundred."""

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

    @abstractmethod
    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, s; None for an engine that chooses its own steps."""

    @abstractmethod
    def interval(self, case: Case) -> float:
        """Return how far `World.step` advances in the probes of a case, s."""

    @abstractmethod
    def schedule(self, prepared: Simulation) -> tuple[Schedule, int]:
        """Return the schedule of a case, and how many steps to take between two looks.

        Of what was prepared the case, the timestep and the settings count.
        """

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        timestep = self.timestep(case) or 0.0
        return resolve(case, self.settings, timestep, self.for_effects(case, timestep))

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide, in every profile."""
        del case, timestep
        return {}

    def parity(self, case: Case) -> tuple[ParityRow, ...]:
        """Return the compiled model of a case against its scene."""
        said, (world, interval) = self.description, self.probed(case)
        return parity(
            world,
            case.scene,
            interval,
            self.imposed_in(case),
            self.precision(case),
            method=said.method,
            tells_forces=said.tells_forces,
        )

    def probed(self, case: Case) -> tuple[W, float]:
        """Return the world that parity asks, and how far a step of it advances, s."""
        return self.open(case), self.interval(case)

    def precision(self, case: Case) -> Precision:
        """Return the precision of the engine's numbers in a case; some let a setting choose it."""
        del case
        return self.description.precision

    def imposed_in(self, case: Case) -> Mapping[str, float]:
        """Return the rows of parity in which the engine goes its own way in a case.

        Each with how far it does: the largest share of the declared, or of the can's mass, size or
        moment where that is zero, or of one unit. A set of rows excuses any deviation.
        """
        rows = self.imposed_rows().get(case.profile, {})
        return rows if isinstance(rows, Mapping) else dict.fromkeys(rows, math.inf)

    def imposed_rows(self) -> Mapping[str, Mapping[str, float] | frozenset[str]]:
        """Return `imposed`, or what an adapter of the previous release calls by its old name."""
        old: frozenset[str] | None = getattr(self, "imposed_by_default", None)
        if old is None:
            return self.imposed
        new = 'imposed = {"default": ...}'
        warn_renamed(
            f"`imposed_by_default` of {self.name} is now `{new}`; the old name goes with "
            "the next release"
        )
        return {"default": old}

    def simulate(self, case: Case) -> Simulation:
        """Run a case to its horizon; numerical failure is its outcome.

        Raises
        ------
        UnknownSettingError, InvalidSettingError
            If the case asks for what the engine does not have.
        """
        compiled = self.compile_s(case)
        started = time.perf_counter()
        prepared = Simulation(
            case=case,
            outcome=Outcome.MISMATCH,
            trajectory=None,
            engine_version=self.version,
            model=self.name,
            timestep=self.timestep(case),
            settings=self.resolve(case),
            compile_s=compiled,
        )
        pose, twist = released(case.scene)
        depth = 0.0
        try:
            prepared = replace(prepared, parity=self.parity(case))
            differing = [row.quantity for row in prepared.parity if row.verdict == "mismatch"]
            if not differing:
                depth, pose = settle(self.open(case), case.scene, pose, twist)
        except InvalidValueError as error:  # a pose or twist read back holds no numbers
            note = f"within the probes before the run: {error}"
            return replace(prepared, outcome=Outcome.DIVERGED, note=note)
        setup = time.perf_counter() - started
        if differing:
            return replace(prepared, note=", ".join(differing), setup_s=setup)
        world = self.open(case)  # a fresh one, so that nothing of the probes is left in it
        world.place(pose, twist)
        return self._run(world, replace(prepared, setup_s=setup, static_penetration=depth))

    def compile_s(self, case: Case) -> float:
        """Let an engine that compiles itself do so; return how long it took by the clock, s.

        One step aloft, of which contact and distance are read, takes every function once.
        """
        program = self.name, case.profile, case.options, case.scene.effects.declared()
        if not self.description.compiles or program in _COMPILED:
            return 0.0
        _COMPILED.add(program)
        started = time.perf_counter()
        with compiling(self.name):
            world = stepped(self.open(case), above_origin(ALOFT), AT_REST)
            world.contact()
            signed_distance(world)
        return time.perf_counter() - started

    def simulate_many(self, cases: Sequence[Case]) -> list[Simulation]:
        """Run cases, with the same results as one by one; an engine may know a faster way."""
        return [self.simulate(case) for case in cases]

    def bare_loop(self, world: W, steps: int) -> None:
        """Step so many times and do nothing else: no reading, no record."""
        for _ in range(steps):
            world.step()

    def _run(self, world: W, prepared: Simulation) -> Simulation:
        """Step until the watch or the horizon ends it; return what was prepared, completed."""
        schedule, size = self.schedule(prepared)
        prediction = HorizonPrediction(prepared.case.scene)

        def seen(time: Floats, phi: Floats) -> None:
            prediction.see(time, phi)
            if isinstance(schedule, Fixed):
                schedule.size = _size(prediction, schedule.largest, self.fewest_steps)

        wall, cpu = time.perf_counter(), time.process_time()
        done = record(prepared, self.chunks(world, schedule, size), seen)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        return replace(done, wall_s=wall, cpu_s=cpu)


class PhysicsEngine(WorldEngine[W]):
    """An engine that advances a world by timesteps."""

    default_timestep: float
    matched_timestep: float

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s; the largest of an adaptive one.

        Raises
        ------
        InvalidSettingError
            If it is so short that the steps cannot be counted in a double.
        """
        if case.timestep is not None:
            countable(case.timestep, case.scene)
        if case.profile == "adaptive":
            return power_of_two(case.timestep or LARGEST_SHARE * natural_time(case.scene))
        if case.timestep is not None:
            return case.timestep
        return self.default_timestep if case.profile == "default" else self.matched_timestep

    def interval(self, case: Case) -> float:
        """Return the timestep of a case, s."""
        return self.timestep(case)

    def schedule(self, prepared: Simulation) -> tuple[Schedule, int]:
        """Return the schedule of a case that steps, and the steps between two looks."""
        return schedule_of(prepared, self.fewest_steps)


class ErrorControlledEngine(WorldEngine[W]):
    """An engine that chooses its steps by their error, which one of its settings bounds.

    The setting is the `accuracy_setting` of its description. Its `chunks` takes the state after
    each of its own steps, up to `Schedule.largest`. Steps follow the motion in every profile, and
    there is none called `adaptive`.
    """

    def timestep(self, case: Case) -> None:
        """Return None: the engine chooses its own steps.

        Raises
        ------
        InvalidSettingError
            If the case asks for one.
        """
        if case.timestep is not None:
            setting = self.description.accuracy_setting
            allowed = f"none at all: {self.name} chooses its own steps, by its setting '{setting}'"
            raise InvalidSettingError("timestep", case.timestep, allowed)

    def interval(self, case: Case) -> float:
        """Return a thousandth of the natural time of the scene, s."""
        return _INTERVAL * natural_time(case.scene)

    def schedule(self, prepared: Simulation) -> tuple[Schedule, int]:
        """Return a schedule that is one step, as long as the run, and the steps in a chunk."""
        limit = longest_time(prepared.case.scene)
        return Fixed(limit, limit, 1), _OWN_LOOK


def schedule_of(prepared: Simulation, fewest: int = 1) -> tuple[Schedule, int]:
    """Return the schedule of a case that steps, and how many steps to take between two looks.

    Of what was prepared the case, the timestep and the settings count.
    """
    scene, timestep = prepared.case.scene, prepared.timestep or 0.0
    unit, limit = natural_time(scene), longest_time(scene)
    schedule: Schedule
    if prepared.case.profile == "adaptive":
        eta, smallest = float(prepared.settings["eta"]), SMALLEST_SHARE * unit  # type: ignore[arg-type]
        schedule = Adaptive(
            scene.can, largest=timestep, smallest=smallest, limit=limit, eta=eta, unit=unit
        )
        size = _ADAPTIVE_LOOK
    else:
        first = _size(HorizonPrediction(scene), timestep, fewest)
        # a stage is a chunk
        schedule, size = Fixed(timestep, limit, first, max(_FIRST, fewest), MOST), 1
    schedule.sampling = SamplingInterval(unit / SAMPLES_IN_TIME)
    return schedule, size


def _size(prediction: HorizonPrediction, timestep: float, fewest: int) -> int:
    """Return the steps to take before looking at the horizon."""
    return int(min(max(prediction.ahead() / timestep, fewest), MOST))
