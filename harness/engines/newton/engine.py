"""Newton as an engine: several solvers on kernels of Warp, in single precision.

A reading costs as much as a step: most steps of a slow motion are taken without one.
"""

from collections.abc import Iterator
from importlib.metadata import version

from harness.engines import (
    MESH_SETTING,
    Capabilities,
    Case,
    Chunk,
    PhysicsEngine,
    Schedule,
    walk,
)
from harness.engines.newton import DESCRIPTION
from harness.engines.newton import settings as declared
from harness.engines.newton.world import NewtonWorld, handed

_PASTE = """\
import newton

model.shape_gap.fill_({gap!r})
{damping}solver = newton.solvers.{solver}({arguments})
timestep = {timestep!r}
"""

_ADAPTIVE = """\
# The timestep follows the motion. Before each solver.step(..., timestep) of a can with these
# measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   timestep = step                                # of schedule.next(quaternion, angular velocity)
"""


class NewtonEngine(PhysicsEngine[NewtonWorld]):
    """Newton: Steel or XPBD on contacts that its own collision finds."""

    name = "newton"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    colliders = declared.COLLIDERS
    mesh_colliders = declared.MESH_COLLIDERS
    variants = declared.VARIANTS
    capabilities = Capabilities(
        honours=frozenset({"slip", "tilt"}),
        imposes={
            "single precision": "a state is known to 6e-8 of itself, and near the flat state the "
            "formula of the rim's lowest point loses more than that",
            "several contacts": "below 22.5 degrees three more points of the rim are contacts, "
            "which do not go round with its lowest point",
            "rest": "under SolverXPBD a velocity below 1e-4 m/s is none, and a spin below 1e-4 "
            "rad/s likewise",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("newton")

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which the solver of a case goes its own way."""
        return declared.imposed_in(case, self.resolve(case), self.timestep(case))

    def open(self, case: Case) -> NewtonWorld:
        """Open a world with the scene of a case."""
        return NewtonWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: NewtonWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a `model` that has its bodies."""
        timestep, chosen = self.timestep(case), self.resolve(case)
        text = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        own = [name for name in (declared.SHAPE, MESH_SETTING.name) if name in dict(case.options)]
        if own:  # of the harness's model, which is the reader's own here
            text += f"# Not in here: {', '.join(own)}.\n"
        damping = ""
        if chosen["solver"] == declared.STEEL:
            lost = chosen["rigid_body_angular_damping"]
            damping = f"model.steel.rigid_body_angular_damping.fill_({lost!r})\n"
        arguments = [f"{name}={value!r}" for name, value in handed(chosen).items()]
        return text + _PASTE.format(
            gap=chosen["gap"],
            damping=damping,
            solver=chosen["solver"],
            arguments=", ".join(["model", *arguments]),
            timestep=timestep,
        )
