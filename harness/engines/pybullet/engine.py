"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

Each of the three readings of a step is a call, and together they cost more than the step. So most
steps of a slow motion are taken without a reading, in one call; `SamplingInterval` says which. A
reading is packed into its numbers at once: the tuples in which PyBullet returns them, if held, cost
the collector of garbage and the memory more than the packing. The contacts that a step leaves are
paired with the state before it.
"""

from collections.abc import Iterator
from functools import partial
from importlib.metadata import version
from itertools import repeat
from struct import Struct
from typing import Any

import numpy as np

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
    step_by_stages,
    take_stage,
    trajectory_of,
)
from harness.engines.pybullet import DESCRIPTION
from harness.engines.pybullet import settings as declared
from harness.engines.pybullet.contact_points import POINT, resultants
from harness.engines.pybullet.frames import Numbers
from harness.engines.pybullet.suppress_output import pybullet
from harness.engines.pybullet.world import ANY_LINK, PybulletWorld, in_parts

_ROWS_PER_CONTACT = 3  # the normal and two directions of friction
_READING = Struct("14d")
"""Position, quaternion (scalar last), velocity, angular velocity; number of contact points."""

_SCALAR_FIRST = [6, 3, 4, 5]


class PybulletSteps:
    """Steps a world; holds the states before the steps that it reads, and the contacts solved.

    Parameters
    ----------
    world : PybulletWorld
    sampling : SamplingInterval or None
        Of the run; None reads every step.
    """

    def __init__(self, world: PybulletWorld, sampling: SamplingInterval | None) -> None:
        self._world, self._sampling = world, sampling
        self._times: list[Floats] = []
        self._spans: list[Integers] = []
        self._readings, self._points = bytearray(), bytearray()

    def state(self) -> tuple[Numbers, Numbers]:
        """Return quaternion (scalar first) and angular velocity of the can."""
        _, (x, y, z, w), _, spin = self._world.state()
        return (w, x, y, z), spin

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage, reading the state before a step and the contacts after."""
        world = self._world
        world.set_timestep(stage.timestep)
        client, can, ground, centred = world.client, world.can, world.ground, world.reading
        step, pose_of = world.stepper(stage.times), pybullet.getBasePositionAndOrientation
        velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
        readings, reading = self._readings.extend, _READING.pack
        points, point = self._points.extend, POINT.pack

        def read_and_step(steps: int) -> tuple[Numbers, Numbers]:
            for _ in repeat(None, steps):
                position, quaternion = pose_of(can, client)
                velocity, spin = velocity_of(can, client)
                if centred is not None:
                    state = centred(position, quaternion, velocity, spin)
                    position, quaternion, velocity, spin = state
                step(client)
                # by place: PyBullet takes a quarter longer where the client is named
                contacts = contacts_of(can, ground, ANY_LINK, ANY_LINK, client)
                # number by number: arguments out of tuples take half as long again
                for _, _, _, _, _, own, other, (g, h, i), j, k, l_, (m, n, o), p, last in contacts:
                    (a, b, c), (d, e, f), (q, r, s) = own, other, last
                    points(point(a, b, c, d, e, f, g, h, i, j, k, l_, m, n, o, p, q, r, s))
                readings(reading(*position, *quaternion, *velocity, *spin, len(contacts)))
            return quaternion, spin

        skip = partial(world.skip, step=step)
        places, spans = take_stage(stage, self._sampling, read_and_step, skip)
        if len(places) > 0:
            self._times.append(stage.times[places])
            self._spans.append(spans)
        return True

    def chunk(self) -> Chunk | None:
        """Return the readings since the last chunk; None without any."""
        if not self._spans:
            return None
        times, spans = np.concatenate(self._times), np.concatenate(self._spans)
        rows = np.frombuffer(self._readings).reshape(-1, _READING.size // 8)
        points = np.frombuffer(self._points).reshape(-1, POINT.size // 8)
        contacts, parts = rows[:, 13].astype(np.int64), self._world.parts
        self._times, self._spans = [], []
        self._readings, self._points = bytearray(), bytearray()
        # numbers that break stay broken: the last state speaks for all before it
        count = len(rows)
        if not np.isfinite(rows[-1]).all():
            count = int(np.argmin(np.isfinite(rows).all(axis=1)))
        resultant = resultants(points, contacts)
        contacts[count:] = 0

        def trajectory(time: Floats, rows: Floats, contact: Floats) -> Trajectory:
            rows[:, 3:7] = rows[:, _SCALAR_FIRST]
            force = contact[:, 3:6] * parts
            motion, count = rows[:, :13], contact[:, 7]
            return trajectory_of(time, motion, contact[:, :3], force, contact[:, 6], count)

        return Chunk(
            times=times,
            quaternions=rows[:count, _SCALAR_FIRST],
            velocities=rows[:count, 7:10],
            constraint_rows=contacts * _ROWS_PER_CONTACT,
            spans=spans,
            sound=count == len(rows),
            readings=(rows, resultant),
            trajectory=trajectory,
        )


_ADAPTIVE = """\
# The timestep follows the motion. Before each stepSimulation of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   pybullet.setTimeStep(step)                     # of schedule.next(quaternion, angular velocity)
"""


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
    fewest_steps = 128
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    mesh_colliders = declared.MESH_COLLIDERS
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

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("pybullet")

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide."""
        del timestep
        return declared.for_effects(case.scene)

    def probed(self, case: Case) -> tuple[PybulletWorld, float]:
        """Return the world that parity asks, and how far a step of it advances, s.

        Of a step in parts PyBullet tells the force of the last one, so that a part is asked.
        """
        world = self.open(case)
        world.take_parts()
        return world, world.timestep

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which PyBullet goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case))

    def open(self, case: Case) -> PybulletWorld:
        """Open a world with the scene of a case."""
        return PybulletWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PybulletWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return step_by_stages(PybulletSteps(world, schedule.sampling), schedule, size)

    def counted_step(self, world: PybulletWorld) -> int:
        """Step, and return the sweeps of the solver, summed over all islands."""
        here = {"physicsClientId": world.client}
        pybullet.setPhysicsEngineParameter(reportSolverAnalytics=1, **here)
        islands: tuple[dict[str, Any], ...] = pybullet.stepSimulation(**here) or ()
        return sum(int(island["numIterationsUsed"]) for island in islands)

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a world that is connected and a file can.urdf."""
        settings = self.resolve(case)
        timestep = in_parts(self.timestep(case), max(int(settings["numSubSteps"]), 1))  # type: ignore[arg-type]
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
        """Step so many times, in one call where it can be, and do nothing else."""
        world.skip(steps, world.stepper(np.arange(steps) * np.float64(world.timestep)))


def _arguments(settings: dict[str, Any]) -> str:
    """Return settings as arguments; a setting that is a word is one of PyBullet's constants."""
    written = {n: f"pybullet.{v}" if isinstance(v, str) else repr(v) for n, v in settings.items()}
    return ", ".join(f"{name}={value}" for name, value in written.items())
