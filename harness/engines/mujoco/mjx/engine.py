"""MJX as an engine: MuJoCo's equations in JAX, in single or in double precision."""

from dataclasses import replace
from importlib.metadata import version

from harness.engines import Case, Floats, LinearisedMotion, Precision, Value, settle
from harness.engines.mujoco import settings as of_mujoco
from harness.engines.mujoco.array_stepping import RIM_DIRECTION, ArrayEngine
from harness.engines.mujoco.engine import MujocoEngine
from harness.engines.mujoco.mjx import DESCRIPTION
from harness.engines.mujoco.mjx import settings as declared
from harness.engines.mujoco.mjx.linearised import linearised
from harness.engines.mujoco.mjx.world import MjxWorld
from models.rim import released

_SWITCH = """\
<!-- Before `mjx.put_model(model)`:
jax.config.update("jax_enable_x64", {double})
-->
"""

_SET_STEP = """\
solref = jnp.full_like(model.geom_solref, 1.0).at[:, 0].set(2 * step)  # the contact is tied to it
model = model.tree_replace({"opt.timestep": jnp.asarray(step), "geom_solref": solref})"""


class MjxEngine(ArrayEngine[MjxWorld]):
    """MJX: MuJoCo's equations in JAX."""

    name = "mjx"
    description = DESCRIPTION
    settings = declared.SETTINGS
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    linearise_variants = (declared.DIFFERENTIABLE,)
    capabilities = replace(
        MujocoEngine.capabilities,
        imposes={**MujocoEngine.capabilities.imposes, "rim direction": RIM_DIRECTION},
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("mujoco-mjx")

    def precision(self, case: Case) -> Precision:
        """Return single or double precision, as the setting of JAX says."""
        return Precision.DOUBLE if self.resolve(case)[declared.X64] else Precision.SINGLE

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide.

        A contact without friction has no cone, and MJX knows it beside the pyramid alone.
        """
        decided = super().for_effects(case, timestep)
        return decided | ({"cone": "pyramidal"} if decided.get("condim") == 1 else {})

    def open(self, case: Case) -> MjxWorld:
        """Compile the scene of a case."""
        return MjxWorld(case, self.resolve(case), self.timestep(case))

    def counted_step(self, world: MjxWorld) -> int:
        """Step, and return the iterations of the solver."""
        world.step()
        return world.iterations

    def linearise(
        self, case: Case, changes: Floats, *, seconds: float, step: float
    ) -> LinearisedMotion:
        """Return a run and its derivatives by changes of the release, by `jax.jvp`."""
        del step  # of differences, and a program is differentiated
        pose, twist = released(case.scene)
        world = self.open(case)
        _, pose = settle(world, case.scene, pose, twist)
        world.place(pose, twist)
        cone = str(self.resolve(case)["cone"])
        return linearised(world, changes, seconds=seconds, cone=cone)

    def export_settings(self, case: Case) -> str:
        """Return the settings of a case as MJCF, with the switch of JAX."""
        chosen = self.resolve(case)
        text = of_mujoco.as_mjcf(case, chosen, self.timestep(case), _SET_STEP)
        return _SWITCH.format(double=bool(chosen[declared.X64])) + text
