"""The contact in MuJoCo for a scene's effects: `condim`, `friction`, and perhaps a spring.

MuJoCo's contact row with regularisation R and impedance d, both its own, gives the force

    f = (aref - a_0)/(R + 1/m_c),    aref = (K/d) depth + (B/d) closing speed,    R = (1 - d)/(d M)

with a_0 the acceleration without it, m_c the can's effective mass at the contact, and K and B the
two numbers of a negative `solref`. For small d the row is so soft that neither a_0 nor m_c matters,
and the row is a spring and a damper: f = (K depth + B speed) M/(1 - d), M the total mass. So
K = (1 - d) k/M and B = (1 - d) b/M make them k and b, to a share of d M/m_c. Friction is to stay as
hard as it is beside a stiff contact: `impratio` makes up for the softness, and a `pair` gives the
friction rows a `solreffriction` of their own, without which slip would never be corrected.

The same spring, as stiff as a timestep can resolve, stands in for a rigid contact wherever the can
slides or turns against friction. MuJoCo's own contact mixes normal and friction rows there: what
slides at v is thrown off the plane at some mu v, however short the timestep, and lands again; it
spends most of its time in the air. Beside the stiffness of a spring that share is d.
"""

from collections.abc import Mapping

from models.effects import NO_SLIP_FRICTION, Effects
from models.mass import body
from models.scene import Scene

SOFTEST = 1e-4
"""The least impedance that MuJoCo allows: the share by which the spring's law is missed."""

SOFT_SOLIMP = (SOFTEST, SOFTEST, 0.001, 0.5, 2.0)

SOFT_IMPRATIO = 100.0 * 9.0 * (1.0 - SOFTEST) / SOFTEST
"""Beside a spring, friction with the R that an `impratio` of 100 gives at an impedance of 0.9."""

SHIPPED_TIMESTEP = 0.002
"""s: MuJoCo's own, for a file that says none."""


def contact_dimension(effects: Effects) -> int:
    """Return MuJoCo's `condim`: 1 normal, 3 friction, 4 drilling too, 6 rolling resistance too."""
    if effects.slip is not None and effects.slip.mu == 0.0:
        return 1
    if effects.rolling_resistance is not None:
        return 6
    return 3 if effects.drilling is None else 4


def spring(scene: Scene, timestep: float | None = None) -> tuple[float, float] | None:
    """Return `solref` of a contact that is a spring, or None for MuJoCo's own.

    Parameters
    ----------
    scene : Scene
    timestep : float, optional
        s; where given, a contact that slides or turns against friction is a spring too: its time
        constant sqrt(M/k) is four timesteps, two with the can's effective mass at the contact, and
        it is damped about critically.
    """
    effects, mass = scene.effects, body(scene).mass
    if effects.compliance is not None:
        stiffness, damping = effects.compliance.stiffness, effects.compliance.damping
    elif timestep is not None and rubs(effects):
        rate = 1.0 / (4.0 * timestep)
        stiffness, damping = mass * rate**2, mass * rate
    else:
        return None
    share = (1.0 - SOFTEST) / mass
    return -share * stiffness, -share * damping


def rubs(effects: Effects) -> bool:
    """Return whether the can may slide or turn against a limited friction."""
    turning = effects.drilling is not None or effects.rolling_resistance is not None
    return turning or (effects.slip is not None and effects.slip.mu > 0.0)


def friction_solref(timestep: float) -> tuple[float, float]:
    """Return `solreffriction` of a contact with a spring: a step takes back half of the slip."""
    return (-1.0, -SOFTEST / (2.0 * timestep))


def surface(scene: Scene) -> dict[str, str]:
    """Return the attributes of both geoms; lengths of effects that are off have no part in it."""
    effects, soft = scene.effects, spring(scene)
    slip, drilling, rolling = effects.slip, effects.drilling, effects.rolling_resistance
    mu = NO_SLIP_FRICTION if slip is None else slip.mu
    condim = contact_dimension(effects)
    # MuJoCo's own where the contact has no such row; a row that is only a neighbour's gets none
    torsion, roll = (0.0, 0.0) if condim > 3 else (0.005, 0.0001)  # noqa: PLR2004 - a condim
    torsion = torsion if drilling is None else drilling.length
    roll = roll if rolling is None else rolling.length
    attributes = {"friction": numbers(mu, torsion, roll), "condim": str(condim)}
    if soft is not None:
        attributes |= {"solref": numbers(*soft), "solimp": numbers(*SOFT_SOLIMP)}
    return attributes


def softness(effects: Effects) -> dict[str, str]:
    """Return the attributes of `option` that a compliant contact calls for."""
    if effects.compliance is None:
        return {}
    return {"impratio": numbers(SOFT_IMPRATIO), "cone": "elliptic"}


def pair(material: Mapping[str, str], timestep: float | None) -> dict[str, str]:
    """Return the attributes of `contact/pair` for two geoms of one material."""
    mu, torsion, roll = material["friction"].split()
    return dict(material) | {
        "geom1": "ground",
        "geom2": "can",
        "friction": f"{mu} {mu} {torsion} {roll} {roll}",
        "solreffriction": numbers(*friction_solref(timestep or SHIPPED_TIMESTEP)),
    }


def numbers(*values: float) -> str:
    """Return numbers as an attribute, each to its last digit."""
    return " ".join(repr(float(value)) for value in values)
