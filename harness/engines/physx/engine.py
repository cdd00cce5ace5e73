"""PhysX as an engine: Gauss-Seidel over substeps, friction at anchors of patches, 32 bits.

A reading costs as much as a step: most steps of a slow motion are taken without one.
"""

from collections.abc import Iterator
from importlib.metadata import version

from harness.engines import Capabilities, Case, Chunk, PhysicsEngine, Schedule, Value, walk
from harness.engines.physx import DESCRIPTION
from harness.engines.physx import settings as declared
from harness.engines.physx.stage import stage_text
from harness.engines.physx.world import PhysxWorld

_PASTE = """\
# The stage below as can.usda, and on an `ovphysx.PhysX` that has it attached:
#   physx.step_sync({timestep!r})
# Before a stage is attached:
#   ovphysx.set_global_config(ovphysx.GlobalConfigKey.{key}, {custom!r})
"""

_ADAPTIVE = """\
# The timestep follows the motion. Before each step_sync of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   physx.step_sync(step)                          # of schedule.next(quaternion, angular velocity)
"""


class PhysxEngine(PhysicsEngine[PhysxWorld]):
    """PhysX: velocities and positions in single precision, anchors of friction."""

    name = "physx"
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
        honours=frozenset({"slip", "tilt", "damping"}),
        imposes={
            "anchors": "friction holds points of the can that it has held before, as long as they "
            "are near the plane",
            "friction of two directions": "each has all of the declared friction, up to 1.41 of it "
            "between them",
            "single precision": "a state is known to 6e-8 of itself, and near the flat state the "
            "rim's lowest point to no better than that",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("ovphysx")

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which PhysX goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case), self.timestep(case))

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the solver whose friction is a cone, where a scene has its can slip.

        What slides is held by its anchors alone: those are kept that a rim could be at, which
        rises by (v dt)^2/(2 R) behind its contact in a step, and v^2/R is some m/s^2.
        """
        if case.scene.effects.slip is None:
            return {}
        near = {} if case.profile == "default" else dict.fromkeys(declared.ANCHORS, timestep**2)
        return {"solverType": "TGS", **near}

    def open(self, case: Case) -> PhysxWorld:
        """Open a world with the scene of a case."""
        return PhysxWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PhysxWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def export_settings(self, case: Case) -> str:
        """Return the stage of a case with its settings, as USD."""
        timestep = self.timestep(case)
        text = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        chosen = self.resolve(case)
        stage = stage_text(case, chosen)
        key = declared.CUSTOM_GEOMETRY
        paste = _PASTE.format(timestep=timestep, key=key, custom=chosen[key])
        magic, rest = stage.split("\n", 1)  # which has to be the first line
        return f"{magic}\n{text}{paste}{rest}"
