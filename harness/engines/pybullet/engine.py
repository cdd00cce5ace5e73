"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

There is no batched stepping: each step is a call, and so is each of the three readings, so that
states are read no oftener than the recorder needs them.

The variants are settings worth a price, each one change to `matched`. A margin makes another rim
than the scene's, which only profile `default` lets pass: so that variant is the engine as shipped
with all differences removed but this.

The differences between PyBullet as shipped and matched are in the order in which they are removed:
the body first (its rim, its moments), then what acts on a body in flight, then the contact and its
solver, the timestep last.
"""

from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

import numpy as np
import pybullet

from harness.core.case import Case, Value
from harness.engines.base import (
    COMMON,
    TIMESTEP,
    Capabilities,
    ModelDifference,
    SolverEffort,
    Variant,
)
from harness.engines.pybullet.settings import (
    DEFAULT_TIMESTEP,
    DYNAMICS,
    IMPOSED_BY_DEFAULT,
    MATCHED_TIMESTEP,
    PROCESS_WIDE,
    SETTINGS,
    SOLVER,
    URDF_FLAGS,
    in_force,
)
from harness.engines.pybullet.stepping import Steps
from harness.engines.pybullet.world import PybulletWorld
from harness.engines.registry import engine
from harness.engines.stepping.physics_engine import PhysicsEngine
from harness.engines.stepping.recording import Chunk
from harness.engines.stepping.schedule import Schedule, Stage

_ALL_BUT_THE_MARGIN = tuple(
    (setting.name, setting.matched)
    for setting in SETTINGS
    if setting.matched not in {None, setting.default} and not callable(setting.matched)
)

SHIPPED_ERP = 0.08
"""What contactERP is where PyBullet is not handed one."""

VARIANTS = (
    *COMMON,
    *(
        Variant(
            name=f"{count} sweeps at most",
            settings=(("numSolverIterations", count),),
            thorough=count != 5,  # noqa: PLR2004 - the middle one
        )
        for count in (2, 5, 10)
    ),
    *(
        Variant(
            name=f"contactERP {share:g}",
            settings=(("contactERP", share),),
            imposes="penetration that is taken away slowly",
            thorough=share > SHIPPED_ERP,
        )
        for share in (SHIPPED_ERP, 0.2)
    ),
    Variant(
        name="margin of 1 mm",
        profile="default",
        settings=tuple((dict(_ALL_BUT_THE_MARGIN) | {"collisionMargin": 0.001}).items()),
        imposes="a rim rounded by a margin of 1 mm",
    ),
    Variant(
        name="friction of two directions",
        settings=(("enableConeFriction", 0),),
        imposes="a friction cone that is a pyramid",
    ),
    Variant(name="maximal coordinates", settings=(("useMaximalCoordinates", True),)),
)


def counted_step(world: "PybulletWorld") -> int:
    """Step, and return the sweeps of the solver over all islands."""
    here = {"physicsClientId": world.client}
    pybullet.setPhysicsEngineParameter(reportSolverAnalytics=1, **here)
    islands: tuple[dict[str, Any], ...] = pybullet.stepSimulation(**here) or ()
    return sum(int(island["numIterationsUsed"]) for island in islands)


_ADAPTIVE = """\
# The timestep follows the motion. Before each stepSimulation of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   pybullet.setTimeStep(step)                     # of schedule.next(quaternion, angular velocity)
"""


def export_settings(case: Case) -> str:
    """Return the settings of a case as calls, for a world that is connected and a file can.urdf."""
    chosen = engine(case.engine)
    timestep = chosen.timestep(case)
    settings = in_force(case, timestep or 0.0)
    solver = {s.name: settings[s.name] for s in SOLVER if settings[s.name] is not None}
    solver = {**PROCESS_WIDE, **solver}
    dynamics = {s.name: settings[s.name] for s in DYNAMICS if settings[s.name] is not None}
    flags = [
        f"pybullet.{s.name}" for s in URDF_FLAGS if s.name.startswith("URDF_") and settings[s.name]
    ]
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
    text = "\n".join(lines) + "\n"
    if case.profile == "adaptive":
        text = _ADAPTIVE.format(largest=timestep) + text
    return text


def _arguments(settings: dict[str, Any]) -> str:
    """Return settings as arguments; a setting that is a word is one of PyBullet's constants."""
    told = {n: f"pybullet.{v}" if isinstance(v, str) else repr(v) for n, v in settings.items()}
    return ", ".join(f"{name}={value}" for name, value in told.items())


MODEL_DIFFERENCES = (
    ModelDifference(
        name="rim shape",
        settings=("URDF_USE_IMPLICIT_CYLINDER", "collisionMargin"),
        sentence="The rim is a polygon with 32 corners inside a margin of 1 mm.",
    ),
    ModelDifference(
        name="inertia",
        settings=("URDF_USE_INERTIA_FROM_FILE",),
        sentence="The moments are those of the collision shape, not the declared ones.",
    ),
    ModelDifference(
        name="damping",
        settings=("linearDamping", "angularDamping"),
        sentence="Velocities decay at 0.04 per second.",
    ),
    ModelDifference(
        name="velocity clamp",
        settings=("maxJointVelocity",),
        sentence="No component of velocity exceeds 100 m/s or rad/s.",
    ),
    ModelDifference(
        name="stabilisation",
        settings=("contactERP", "contactSlop"),
        sentence="A slop of 0.01 mm is left alone and what is deeper taken away at 8 % a step.",
    ),
    ModelDifference(
        name="solver",
        settings=("solverResidualThreshold", "enableConeFriction"),
        sentence="The sweeps stop at a squared residual of 1e-7.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1/240 s are long beside the bounce.",
    ),
)

# a squared residual of 1e-30 is round-off of velocities of 1 m/s; sweeps end there before 1000
_RESIDUAL = ("solverResidualThreshold", 1e-30)

SOLVER_EFFORTS = (
    SolverEffort(name="1 sweep", settings=(_RESIDUAL, ("numSolverIterations", 1))),
    SolverEffort(name="2 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 2))),
    SolverEffort(name="5 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 5))),
    SolverEffort(name="10 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 10))),
    SolverEffort(name="residual 1e-7, as shipped", settings=(("solverResidualThreshold", 1e-7),)),
    SolverEffort(name="converged", settings=(_RESIDUAL, ("numSolverIterations", 1000))),
)


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
    model_differences = MODEL_DIFFERENCES
    solver_efforts = SOLVER_EFFORTS
    variants = VARIANTS
    export_settings = staticmethod(export_settings)
    counted_step = staticmethod(counted_step)
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
    imposed_by_default = IMPOSED_BY_DEFAULT

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("pybullet")

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        return in_force(case, self.timestep(case))

    def open(self, case: Case) -> PybulletWorld:
        """Open a world with the scene of a case."""
        return PybulletWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PybulletWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        # the schedule is asked after a chunk was seen: what is seen may change what comes
        while (stage := _next(schedule, world)) is not None:
            steps = Steps(schedule.looks)
            while stage is not None:
                world.set_timestep(stage.timestep)
                steps.take(world, stage)
                # until so many are taken, and any of them was looked at
                stage = None if steps.taken >= size and steps.seen else _next(schedule, world)
            yield steps.chunk()

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
