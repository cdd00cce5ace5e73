"""MuJoCo Warp as an engine: MuJoCo's equations in kernels of Warp, in single precision."""

from dataclasses import replace
from importlib.metadata import version

from harness.engines import Case
from harness.engines.mujoco import settings as of_mujoco
from harness.engines.mujoco.array_stepping import RIM_DIRECTION, ArrayEngine
from harness.engines.mujoco.engine import MujocoEngine
from harness.engines.mujoco.warp import DESCRIPTION
from harness.engines.mujoco.warp import settings as declared
from harness.engines.mujoco.warp.world import WarpWorld

_SET_STEP = """\
model.opt.timestep.fill_(step)  # of the model that mujoco_warp.put_model returned
model.geom_solref.fill_(warp.vec2(2 * step, 1))  # the contact is tied to it"""


class WarpEngine(ArrayEngine[WarpWorld]):
    """MuJoCo Warp: MuJoCo's equations in kernels of Warp."""

    name = "mujoco-warp"
    description = DESCRIPTION
    settings = declared.SETTINGS
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    capabilities = replace(
        MujocoEngine.capabilities,
        imposes={**MujocoEngine.capabilities.imposes, "rim direction": RIM_DIRECTION},
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("mujoco-warp")

    def open(self, case: Case) -> WarpWorld:
        """Compile the scene of a case."""
        return WarpWorld(case, self.resolve(case), self.timestep(case))

    def counted_step(self, world: WarpWorld) -> int:
        """Step, and return the iterations of the solver."""
        world.step()
        return world.iterations

    def export_settings(self, case: Case) -> str:
        """Return the settings of a case as MJCF."""
        return of_mujoco.as_mjcf(case, self.resolve(case), self.timestep(case), _SET_STEP)
