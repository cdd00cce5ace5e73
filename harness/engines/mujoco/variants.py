"""MuJoCo's settings that are worth a price, and how to write them into a model of one's own.

Each is one change to `matched`. A time constant of solref held while the timestep shrinks keeps the
can soft; tied to it, as in `matched`, the softness vanishes.
"""

from typing import TYPE_CHECKING

from harness.case import Case
from harness.engines.mujoco.settings import attributes, in_force, soft_solref
from harness.engines.registry import engine
from harness.engines.variants import COMMON, Variant
from models.mjcf_contact import pair, surface

if TYPE_CHECKING:
    from harness.engines.mujoco.world import MujocoWorld

SHIPPED_SOLREF = 0.02
"""s: the time constant that MuJoCo ships with."""

VARIANTS = (
    *COMMON,
    Variant(name="adaptive RK4", profile="adaptive", settings=(("integrator", "RK4"),)),
    *(
        Variant(
            name=f"integrator {word}",
            settings=(("integrator", word),),
            thorough=word in {"implicit", "discrete"},
        )
        for word in ("RK4", "implicit", "implicitfast", "discrete")
    ),
    Variant(
        name="cone pyramidal",
        settings=(("cone", "pyramidal"),),
        imposes="a friction cone that is a pyramid",
    ),
    *(
        Variant(
            name=f"impratio {number:g}",
            settings=(("impratio", number),),
            imposes="friction that yields, so that the rim creeps",
            thorough=number > 1.0,
        )
        for number in (1.0, 10.0)
    ),
    *(
        Variant(
            name=f"solref held at {seconds:g} s",
            settings=(("solref", (seconds, 1.0)),),
            imposes="a contact that stays soft",
            thorough=seconds < SHIPPED_SOLREF,
        )
        for seconds in (SHIPPED_SOLREF, 0.002)
    ),
    Variant(name="1 solver iteration", settings=(("iterations", 1),)),
    Variant(name="solver CG", settings=(("solver", "CG"),), thorough=True),
    Variant(name="solver PGS", settings=(("solver", "PGS"),), thorough=True),
    Variant(name="3 noslip iterations", settings=(("noslip_iterations", 3),)),
)


def counted_step(world: "MujocoWorld") -> int:
    """Step, and return the iterations of the solver, of the last stage of RK4, over all islands."""
    world.step()
    data = world.data
    return int(data.solver_niter[: max(1, int(data.nisland))].sum())


_ADAPTIVE = """\
<!-- The timestep follows the motion. Before each mj_step of a can with these measures:
from harness.engines.schedule import Adaptive  # schedule = Adaptive(can, largest={largest!r}, ...)
model.opt.timestep = step                      # of schedule.next(quaternion, angular velocity)
model.geom_solref[:] = (2 * step, 1)           # the contact is tied to it
-->
"""


def paste(case: Case) -> str:
    """Return the settings of a case as MJCF: `option`, and `default` for the geoms of the contact.

    Both belong right under `mujoco`, and so does the `contact` of a scene whose contact is a
    spring, for geoms named as in the model files.
    """
    chosen = engine(case.engine)
    timestep = chosen.timestep(case)
    # not the stages that are left out: a model of one's own may need them, and no number does
    option, geom, flag = attributes(case, in_force(case, timestep or 0.0))
    if timestep is not None:
        option = {"timestep": repr(timestep)} | option
    lines = [f"<option {_spelled(option)}>", f"  <flag {_spelled(flag)}/>", "</option>"]
    if not flag:
        lines = [f"<option {_spelled(option)}/>"]
    if geom:
        lines += ["<default>", f"  <geom {_spelled(geom)}/>", "</default>"]
    if soft_solref(case, timestep or 0.0) is not None:
        springy = pair(surface(case.scene) | geom, timestep)
        lines += ["<contact>", f"  <pair {_spelled(springy)}/>", "</contact>"]
    text = "\n".join(lines) + "\n"
    if case.profile == "adaptive":
        text = _ADAPTIVE.format(largest=timestep) + text
    return text


def _spelled(attributes: dict[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in attributes.items())
