"""MuJoCo's settings that matter to a rolling can, what it ships with, and what `matched` takes.

`matched` takes away what the scene does not declare. Contact in MuJoCo is always soft; with the
time constant of `solref` tied to twice the timestep, the shortest that its own rule allows, the
softness vanishes with the timestep, and the limit is the rigid can. Elliptic cones take the bias
out of the direction of friction, and `impratio` makes friction a hundred times harder than the
normal, so that the rim creeps a hundred times less.

What a scene declares comes on top, in every profile: the dimension of the contact, and a spring and
a damper in place of the stiffest contact there is.

The variants are settings worth a price, each one change to `matched`. A time constant of solref
held while the timestep shrinks keeps the can soft; tied to the timestep, as in `matched`, the
softness vanishes.

The differences between MuJoCo as shipped and matched are in the order in which they are removed:
the contact first, since friction and solver act through it, the timestep last, since a matched
contact is tied to it.
"""

import math
from collections.abc import Mapping

import mujoco

from harness.engines import (
    COMMON,
    ETA_SETTING,
    MESH_SETTING,
    TIMESTEP,
    Case,
    ModelDifference,
    Setting,
    SolverEffort,
    Value,
    Variant,
    outline_gap,
    rim_within,
)
from harness.engines.mujoco.colliders import (
    CCD_FLAGS,
    CCD_OPTIONS,
    SHAPES,
    is_flag,
    mesh_in,
)
from models.effects import Effects
from models.mjcf_contact import (
    DEPTH_TAKEN,
    HARDEST,
    ContactRows,
    contact_dimension,
    contact_rows,
    pair,
    surface,
)

FAINTEST = float(mujoco.mjMINMU)
"""What MuJoCo makes of a coefficient of friction, or an arm in m, that is smaller: 1e-5."""

DEFAULT_TIMESTEP = 0.002
MATCHED_TIMESTEP = 1e-4


def matched_solref(timestep: float) -> tuple[float, ...]:
    """Return the stiffest critically damped contact that refsafe lets pass."""
    return (2.0 * timestep, 1.0)


INTEGRATORS = tuple(
    word
    for word in ("Euler", "RK4", "implicit", "implicitfast", "discrete")
    if hasattr(mujoco.mjtIntegrator, f"mjINT_{word.upper()}")
)
"""Those of the version that is installed: `discrete` came with 3.13."""

OPTIONS = (
    Setting.as_shipped(
        "integrator",
        "Euler",
        "Time stepping; Euler and RK4 treat the gyroscopic term explicitly.",
        choices=INTEGRATORS,
    ),
    Setting(
        "cone",
        "pyramidal",
        "elliptic",
        "Shape of the friction cone; a pyramid mixes normal force and friction.",
        choices=("pyramidal", "elliptic"),
    ),
    Setting(
        "impratio",
        1.0,
        100.0,
        "Hardness of friction over that of the normal; slip creep goes with its inverse.",
        positive=True,
    ),
    Setting(
        "jacobian",
        "auto",
        "dense",
        "Storage of the constraint Jacobian; changes round-off and time only.",
        choices=("dense", "sparse", "auto"),
    ),
    Setting.as_shipped(
        "solver",
        "Newton",
        "Algorithm that finds the contact forces.",
        choices=("PGS", "CG", "Newton"),
    ),
    Setting.as_shipped("iterations", 100, "Most iterations of the solver in a step."),
    Setting("tolerance", 1e-8, 1e-12, "Scaled improvement below which the solver stops."),
    Setting.as_shipped("ls_iterations", 50, "Most iterations of the line search."),
    Setting.as_shipped("ls_tolerance", 0.01, "Slope at which the line search stops."),
    Setting.as_shipped(
        "noslip_iterations", 0, "Iterations of the solver that suppresses slip after the main one."
    ),
    Setting.as_shipped(
        "noslip_tolerance", 1e-6, "Improvement below which the noslip solver stops."
    ),
    *CCD_OPTIONS,
)

GEOM = (
    Setting(
        "solref",
        (0.02, 1.0),
        matched_solref,
        "Time constant (s) and damping ratio of the soft contact.",
    ),
    Setting(
        "solimp",
        (0.9, 0.95, 0.001, 0.5, 2.0),
        (0.9, 0.9, 0.001, 0.5, 2.0),
        "Impedance against depth; constant, and 0.9: at 0.99 the contact chatters.",
    ),
    Setting.as_shipped(
        "condim", 3, "Dimensions of the contact force: 1 normal, 3 friction, 4 torsion, 6 rolling."
    ),
    Setting.as_shipped("margin", 0.0, "Distance at which a contact becomes active, m."),
)

FLAGS = (
    tuple(
        Setting.as_shipped(name, "enable", meaning, choices=("enable", "disable"))
        for name, meaning in (
            ("refsafe", "Keeps the time constant of solref at two timesteps or more."),
            ("warmstart", "Starts the solver at the last step's forces."),
            ("eulerdamp", "Implicit treatment of joint damping in Euler; the can has none."),
        )
    )
    + CCD_FLAGS
)

BUILD = Setting(
    "build",
    "shipped",
    "lean",
    "Stages and sensors: MuJoCo's own, those that the scene needs, or all there are.",
    choices=("shipped", "lean", "everything"),
)
"""The harness's own word, in no file of MuJoCo: which stages of a step are compiled in."""

_PYRAMID = 1.0 - 1.0 / math.sqrt(2.0) + 0.005
"""Share of the declared friction that a pyramid lacks between its edges, and what solvers miss."""

_ARMS = ("arm of drilling", "arm of rolling resistance")


def imposed_in(case: Case, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows of parity in which MuJoCo goes its own way, each with its share.

    As shipped sliding and turning share so much that a moment is nearly none.
    """
    rows = {"friction between the axes": _PYRAMID} if chosen["cone"] == "pyramidal" else {}
    if (law := case.scene.effects.restitution) is not None:
        # a tenth of a thousandth, by the impedance, of what an impact changes, and round-off
        missed = DEPTH_TAKEN / 2.0 + 2.0 * (1.0 - HARDEST)
        rows["restitution"] = missed / (law.coefficient or 1.0)
    if mesh := mesh_in(chosen):
        rows |= rim_within(case.scene.can, outline_gap(mesh) * case.scene.can.radius)
    return rows | (dict.fromkeys(_ARMS, 1.0) if case.profile == "default" else {})


SETTINGS = (*OPTIONS, *GEOM, *FLAGS, BUILD, SHAPES, MESH_SETTING, ETA_SETTING)

_IDLE = (
    "equality",
    "frictionloss",
    "limit",
    "spring",
    "actuation",
    "clampctrl",
    "midphase",
    "filterparent",
    "island",
)
"""Stages that one can on one plane never needs, whatever its effects."""


def for_effects(case: Case, timestep: float) -> dict[str, Value]:
    """Return the settings that the effects of a scene decide.

    MuJoCo raises a coefficient of friction of zero to 1e-5, so that a frictionless plane needs a
    contact without friction.
    """
    effects, rows = case.scene.effects, rows_of(case, timestep)
    decided: dict[str, Value] = {}
    if {"slip", "drilling", "rolling_resistance"}.intersection(effects.declared()):
        decided["condim"] = contact_dimension(effects)
    if rows is not None:
        decided["solref"], decided["solimp"] = rows.solref, rows.solimp
        decided["impratio"], decided["cone"] = rows.impratio, "elliptic"
    return decided


def rows_of(case: Case, timestep: float, largest: float | None = None) -> ContactRows | None:
    """Return the contact of a case where it has a law of its own: see `models.mjcf_contact`.

    An option that says how stiff the contact is has the last word, and profile `default` ships
    without a spring that the scene does not declare. Of steps that change `largest` is the longest.
    """
    if {"solref", "solimp"}.intersection(dict(case.options)):
        return None
    declared = {"compliance", "restitution"}.intersection(case.scene.effects.declared())
    if case.profile == "default" and not declared:
        return None
    return contact_rows(case.scene, timestep, largest)


def stages(chosen: Mapping[str, Value], effects: Effects) -> dict[str, str]:
    """Return the flags of the stages that are left out, or, with everything, of those put in."""
    build = chosen.get("build")
    if build == "lean":
        idle = _IDLE if effects.damping is not None else (*_IDLE, "damper")
        return dict.fromkeys(filter(is_flag, idle), "disable")
    return {"energy": "enable"} if build == "everything" else {}


def attributes(case: Case, chosen: Mapping[str, Value]) -> tuple[dict[str, str], ...]:
    """Return the MJCF attributes of `option`, of the geoms and of `option/flag` for a case.

    Profile `default` writes only what the case sets itself, so that the engine stays as it ships;
    so does an engine that has not all of MuJoCo's settings.
    """
    explicit = {name for name, _ in case.options}
    return tuple(
        {
            setting.name: _text(chosen[setting.name])
            for setting in group
            if setting.name in chosen and (case.profile != "default" or setting.name in explicit)
        }
        for group in (OPTIONS, GEOM, FLAGS)
    )


_ADAPTIVE = """\
<!-- The timestep follows the motion. Before each step of a can with these measures:
from harness.engines import Adaptive  # schedule = Adaptive(can, largest={largest!r}, ...)
step = ...  # of schedule.next(quaternion, angular velocity)
{set_step}
-->
"""

_SET_STEP = """\
model.opt.timestep = step
model.geom_solref[:] = (2 * step, 1)  # the contact is tied to it"""


def as_mjcf(
    case: Case, chosen: Mapping[str, Value], timestep: float, set_step: str = _SET_STEP
) -> str:
    """Return the settings of a case as MJCF: `option`, and `default` for the geoms of the contact.

    Both belong right under `mujoco`, and so does the `contact` of a scene whose contact is a
    spring, for geoms named as in the model files.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    set_step : str
        How a program sets a `step` of profile `adaptive` in the engine.
    """
    # without the disabled stages: another model may need them, and they change no number
    option, geom, flag = attributes(case, chosen)
    option = {"timestep": repr(timestep)} | option
    lines = [f"<option {_spelled(option)}/>"]
    if flag:
        lines = [f"<option {_spelled(option)}>", f"  <flag {_spelled(flag)}/>", "</option>"]
    if geom:
        lines += ["<default>", f"  <geom {_spelled(geom)}/>", "</default>"]
    rows = rows_of(case, timestep)
    if rows is not None:
        lawful = pair(surface(case.scene, timestep) | geom, rows)
        lines += ["<contact>", f"  <pair {_spelled(lawful)}/>", "</contact>"]
    head = ""
    if case.profile == "adaptive":
        head = _ADAPTIVE.format(largest=timestep, set_step=set_step)
    own = [name for name in (SHAPES.name, MESH_SETTING.name) if name in dict(case.options)]
    if own:  # they are the reader's own
        head += f"<!-- Not in here: {', '.join(own)}. -->\n"
    return head + "\n".join(lines) + "\n"


def _spelled(attributes: dict[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in attributes.items())


def _text(value: Value) -> str:
    """Return a value as an XML attribute."""
    if isinstance(value, tuple):
        return " ".join(repr(number) for number in value)
    return repr(value) if isinstance(value, float) else str(value)


SHIPPED_SOLREF = 0.02
"""s: the time constant that MuJoCo ships with."""

VARIANTS = (
    *COMMON,
    Variant(name="adaptive RK4", profile="adaptive", settings=(("integrator", "RK4"),)),
    *(
        Variant.of("integrator", word, thorough=word in {"implicit", "discrete"})
        for word in INTEGRATORS[1:]
    ),
    Variant.of("cone", "pyramidal", imposes="a friction cone that is a pyramid"),
    *(
        Variant.of(
            "impratio",
            number,
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
    Variant.of("solver", "CG", thorough=True),
    Variant.of("solver", "PGS", thorough=True),
    Variant(name="3 noslip iterations", settings=(("noslip_iterations", 3),)),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="compliance",
        settings=("solref", "solimp"),
        sentence="The contact yields with a time constant of 0.02 s, so that the can sinks in.",
    ),
    ModelDifference(
        name="friction regularisation",
        settings=("cone", "impratio"),
        sentence="Friction is as soft as the normal, its cone a pyramid, and the rim creeps.",
    ),
    ModelDifference(
        name="solver",
        settings=("tolerance", "jacobian", "build"),
        sentence="The solver stops at an improvement of 1e-8, and idle stages run.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 2 ms are long beside the bounce.",
    ),
)

# below 1e-15 the solver's cost is round-off; no solve takes 200 iterations
_CONVERGED = (("tolerance", 1e-15), ("iterations", 200), ("ls_iterations", 200))

SOLVER_EFFORTS = (
    SolverEffort(name="1 iteration", settings=(("tolerance", 1e-15), ("iterations", 1))),
    SolverEffort(name="2 iterations", settings=(("tolerance", 1e-15), ("iterations", 2))),
    SolverEffort(name="3 iterations", settings=(("tolerance", 1e-15), ("iterations", 3))),
    SolverEffort(name="tolerance 1e-4", settings=(("tolerance", 1e-4),)),
    SolverEffort(name="tolerance 1e-8, as shipped", settings=(("tolerance", 1e-8),)),
    SolverEffort(name="converged", settings=_CONVERGED),
)
