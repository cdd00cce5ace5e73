"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

There is no batched stepping: each step is a call, and so is each of the three readings, which
together cost more than the step. So most steps of a slow motion are taken without a reading;
`SamplingInterval` says which. The numbers are kept as PyBullet returns them, and put into arrays
chunk by chunk; the contacts that a step leaves are paired with the state before it.
"""

from collections.abc import Iterator, Sequence
from importlib.metadata import version
from itertools import chain, repeat
from typing import Any

import numpy as np
import pybullet

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    Floats,
    Integers,
    PhysicsEngine,
    SamplingInterval,
    Schedule,
    Stage,
    Trajectory,
    Value,
    take_stage,
    trajectory_of,
)
from harness.engines.pybullet import settings as declared
from harness.engines.pybullet.world import ContactPoint, Numbers, PybulletWorld, State, resultant

_ROWS_PER_CONTACT = 3  # the normal and two directions of friction
_STATE = 13  # numbers of a state: position, quaternion, velocity, angular velocity
_POINT = 19  # numbers of a contact point that matter, in PyBullet's order
_NONE = (0.0,) * _POINT


class Steps:
    """The states before consecutive steps that were read, and the contacts that they solved.

    Parameters
    ----------
    sampling : SamplingInterval or None
        Of the run; None reads every step.
    """

    def __init__(self, sampling: SamplingInterval | None) -> None:
        self._sampling = sampling
        self._times: list[Floats] = []
        self._parts = 1
        self._spans: list[int] = []
        self._states: list[State] = []
        self._contacts: list[tuple[ContactPoint, ...]] = []
        self.taken = 0

    def take(self, world: PybulletWorld, stage: Stage) -> None:
        """Take the steps of a stage, reading the state before a step and the contacts after."""
        client, can, ground, centred = world.client, world.can, world.ground, world.reading
        step, pose_of = world.stepper(stage.times), pybullet.getBasePositionAndOrientation
        velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
        keep, touch = self._states.append, self._contacts.append

        def read_and_step() -> tuple[Numbers, Numbers]:
            position, quaternion = pose_of(can, client)
            velocity, spin = velocity_of(can, client)
            if centred is not None:
                position, quaternion, velocity, spin = centred(position, quaternion, velocity, spin)
            step(client)
            touch(contacts_of(can, ground, physicsClientId=client))
            keep((position, quaternion, velocity, spin))
            return quaternion, spin

        def skip(steps: int) -> None:
            for _ in repeat(None, steps):
                step(client)

        places, spans = take_stage(stage, self._sampling, read_and_step, skip)
        self._parts = world.parts
        self._times.append(stage.times[places])
        self._spans += spans
        self.taken += len(stage.times)

    @property
    def seen(self) -> bool:
        """Whether any step was read."""
        return len(self._states) > 0

    def chunk(self) -> Chunk:
        """Return what was read as a chunk."""
        times, numbers = np.concatenate(self._times), chain.from_iterable(self._states)
        states = np.fromiter(chain.from_iterable(numbers), np.float64).reshape(-1, _STATE)
        states[:, 3:7] = states[:, [6, 3, 4, 5]]
        good = np.isfinite(states).all(axis=1)
        count = len(states) if np.all(good) else int(np.argmin(good))
        contacts = np.fromiter(map(len, self._contacts), np.int64)
        contacts[count:] = 0

        def read(keep: Integers) -> Trajectory:
            point, force, depth, bearing = _resultants([self._contacts[n] for n in keep.tolist()])
            return trajectory_of(
                times[keep], states[keep], (point, force * self._parts, depth, bearing)
            )

        return Chunk(
            times=times,
            quaternions=states[:count, 3:7],
            constraint_rows=contacts * _ROWS_PER_CONTACT,
            spans=np.array(self._spans),
            sound=count == len(states),
            read=read,
        )


def _resultants(
    contacts: Sequence[tuple[ContactPoint, ...]],
) -> tuple[Floats, Floats, Floats, Integers]:
    """Return point (n, 3), force (n, 3), depth (n,) and bearing points (n,) of some steps."""
    single = [_numbers(*points) if len(points) == 1 else _NONE for points in contacts]
    p = np.array(single).reshape(-1, _POINT)
    normal = p[:, 10:11]
    bears = normal[:, 0] > 0.0
    # weighted and divided again, as of several points, so that both ways give the same bits
    weighted = normal * (p[:, 0:3] + p[:, 3:6]) / 2.0
    point = np.divide(weighted, normal, out=np.full_like(weighted, np.nan), where=normal > 0.0)
    force = normal * p[:, 6:9] + p[:, 11:12] * p[:, 12:15] + p[:, 15:16] * p[:, 16:19]
    force[~bears] = 0.0
    depth, bearing = -p[:, 9], bears.astype(np.int64)
    for row, points in enumerate(contacts):
        if len(points) != 1:
            x, y, z, f_x, f_y, f_z, deepest, number, _ = resultant(points)
            point[row], force[row] = (x, y, z), (f_x, f_y, f_z)
            depth[row], bearing[row] = deepest, int(number)
    return point, force, depth, bearing


def _numbers(p: ContactPoint) -> tuple[float, ...]:
    """Return the numbers of a contact point that matter, in PyBullet's order."""
    return (*p[5], *p[6], *p[7], p[8], p[9], p[10], *p[11], p[12], *p[13])


_ADAPTIVE = """\
# The timestep follows the motion. Before each stepSimulation of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   pybullet.setTimeStep(step)                     # of schedule.next(quaternion, angular velocity)
"""


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    capabilities = Capabilities(
        honours=frozenset(
            {
                "slip",
                "compliance",
                "restitution",
                "drilling",
                "rolling_resistance",
                "damping",
                "rim",
                "tilt",
                "shake",
                "point_mass",
            }
        ),
        imposes={
            "stabilisation": "penetration is taken away by ERP, which adds energy",
            "gyroscopic term": "taken explicitly, and a free spin gains energy",
            "turn in a step": "past pi/4 the body turns by less than its spin asks for",
            "friction direction": "sliding friction, and so rolling resistance, points a few "
            "hundredths of a radian astray, whatever the timestep",
            "cached contacts": "old points of the rim stay in the solver until they drift away",
        },
    )
    imposed_by_default = declared.IMPOSED_BY_DEFAULT

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("pybullet")

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        return declared.in_force(case, self.timestep(case))

    def open(self, case: Case) -> PybulletWorld:
        """Open a world with the scene of a case."""
        return PybulletWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PybulletWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        # the schedule is asked after a chunk was seen: what is seen may change what comes
        while (stage := _next(schedule, world)) is not None:
            steps = Steps(schedule.sampling)
            while stage is not None:
                world.set_timestep(stage.timestep)
                steps.take(world, stage)
                # until so many are taken, and any of them was read
                stage = None if steps.taken >= size and steps.seen else _next(schedule, world)
            yield steps.chunk()

    def counted_step(self, world: PybulletWorld) -> int:
        """Step, and return the sweeps of the solver over all islands."""
        here = {"physicsClientId": world.client}
        pybullet.setPhysicsEngineParameter(reportSolverAnalytics=1, **here)
        islands: tuple[dict[str, Any], ...] = pybullet.stepSimulation(**here) or ()
        return sum(int(island["numIterationsUsed"]) for island in islands)

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a world that is connected and a file can.urdf."""
        timestep, settings = self.timestep(case), self.resolve(case)
        solver = dict(declared.PROCESS_WIDE) | declared.given(declared.SOLVER, settings)
        dynamics = declared.given(declared.DYNAMICS, settings)
        flags = [f"pybullet.{name}" for name in declared.urdf_flags(settings)]
        load = ['"can.urdf"', *([f"flags={' | '.join(flags)}"] if flags else [])]
        load += ["useMaximalCoordinates=True"] if settings["useMaximalCoordinates"] else []
        lines = [
            "import pybullet",
            "",
            f"pybullet.setTimeStep({timestep!r})",
            f"pybullet.setPhysicsEngineParameter({_arguments(solver)})",
            f"can = pybullet.loadURDF({', '.join(load)})",
        ]
        if dynamics:
            lines.append(f"pybullet.changeDynamics(can, -1, {_arguments(dynamics)})")
        head = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        return head + "\n".join(lines) + "\n"

    def bare_loop(self, world: PybulletWorld, steps: int) -> None:
        """Step so many times and do nothing else: no reading, no record."""
        times = np.arange(steps) * np.float64(world.timestep)
        step, client = world.stepper(times), world.client
        for _ in range(steps):
            step(client)

    def recording_loop(self, world: PybulletWorld, steps: int) -> None:
        """Step so many times and keep what PyBullet says of each state and contact, as it is."""
        step = world.stepper(np.arange(steps) * np.float64(world.timestep))
        can, ground, client = world.can, world.ground, world.client
        kept = []
        for _ in range(steps):
            pose = pybullet.getBasePositionAndOrientation(can, client)
            twist = pybullet.getBaseVelocity(can, client)
            step(client)
            contacts = pybullet.getContactPoints(can, ground, physicsClientId=client)
            kept.append((pose, twist, contacts))


def _next(schedule: Schedule, world: PybulletWorld) -> Stage | None:
    """Return the stage that the world's state calls for."""
    _, (x, y, z, w), _, spin = world.state()
    return schedule.next((w, x, y, z), spin)


def _arguments(settings: dict[str, Any]) -> str:
    """Return settings as arguments; a setting that is a word is one of PyBullet's constants."""
    told = {n: f"pybullet.{v}" if isinstance(v, str) else repr(v) for n, v in settings.items()}
    return ", ".join(f"{name}={value}" for name, value in told.items())
