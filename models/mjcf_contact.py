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

Restitution asks for the other end, d near 1: R vanishes, and the acceleration of the contact along
the normal is a = (K/d) depth + (B/d) closing speed, whatever the effective mass, the other rows of
the contact, or its friction. A step of dt by semi-implicit Euler then turns a closing speed v into

    v' = -(B dt/d - 1) v - (K dt^2/d) depth/dt

of separation, the depth of a contact that was made within the step before being some share s < 1
of v dt. So with K = d kappa/dt^2, kappa small, and B = d (1 + e - kappa/2)/dt an impact takes one
step and gives back e + kappa (s - 1/2): Newton's law, with half of kappa the most it is missed by.
Friction takes all of the slip in that step if its cone lets it. Where the rim slips through an
impact to a slip of w, MuJoCo's own coupling of normal and friction throws it off by mu w more.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from models.effects import NO_SLIP_FRICTION, Effects
from models.mass import body
from models.scene import Scene

SOFTEST = 1e-4
"""The least impedance that MuJoCo allows: the share by which the spring's law is missed."""

SOFT_SOLIMP = (SOFTEST, SOFTEST, 0.001, 0.5, 2.0)

SOFT_IMPRATIO = 100.0 * 9.0 * (1.0 - SOFTEST) / SOFTEST
"""Beside a spring, friction with the R that an `impratio` of 100 gives at an impedance of 0.9."""

HARD_IMPRATIO = 100.0
"""Beside an impact, friction a hundred times as hard as the normal."""

SHIPPED_TIMESTEP = 0.002
"""s: MuJoCo's own, for a file that says none."""


HARDEST = 0.9999
"""The greatest impedance that MuJoCo allows: the share by which Newton's law is met."""

HARD_SOLIMP = (HARDEST, HARDEST, 0.001, 0.5, 2.0)

DEPTH_TAKEN = 0.002
"""kappa: the share of the depth that a step takes back beside an impact."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactRows:
    """MuJoCo's numbers of a contact that has a declared law.

    Parameters
    ----------
    solref, solreffriction : tuple of float
        Stiffness and damping, negative, of the normal row and of those of friction.
    solimp : tuple of float
        With the impedance d.
    impratio : float
        Hardness of friction over that of the normal.
    """

    solref: tuple[float, float]
    solreffriction: tuple[float, float]
    solimp: tuple[float, ...]
    impratio: float


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


def contact_rows(
    scene: Scene, timestep: float | None = None, largest: float | None = None
) -> ContactRows | None:
    """Return the contact by which a scene's laws are followed, None where MuJoCo's own does.

    Parameters
    ----------
    scene : Scene
    timestep : float, optional
        s; left out, `SHIPPED_TIMESTEP`, and only what the scene itself declares has a law.
    largest : float, optional
        s; where steps change, the longest: a depth of a long step, taken back by the share of a
        short one, would throw the can off.
    """
    restitution, step = scene.effects.restitution, timestep or SHIPPED_TIMESTEP
    if restitution is not None:
        speed = HARDEST * (1.0 + restitution.coefficient - DEPTH_TAKEN / 2.0) / step
        return ContactRows(
            solref=(-HARDEST * DEPTH_TAKEN / (largest or step) ** 2, -speed),
            solreffriction=(-1.0, -HARDEST / step),
            solimp=HARD_SOLIMP,
            impratio=HARD_IMPRATIO,
        )
    solref = spring(scene, timestep)
    if solref is None:
        return None
    return ContactRows(
        solref=solref,
        solreffriction=friction_solref(step),
        solimp=SOFT_SOLIMP,
        impratio=SOFT_IMPRATIO,
    )


def friction_solref(timestep: float) -> tuple[float, float]:
    """Return `solreffriction` of a contact with a spring: a step takes back half of the slip."""
    return (-1.0, -SOFTEST / (2.0 * timestep))


def surface(scene: Scene, timestep: float | None = None) -> dict[str, str]:
    """Return the attributes of both geoms; lengths of effects that are off have no part in it."""
    effects, rows = scene.effects, contact_rows(scene, timestep)
    slip, drilling, rolling = effects.slip, effects.drilling, effects.rolling_resistance
    mu = NO_SLIP_FRICTION if slip is None else slip.mu
    condim = contact_dimension(effects)
    # MuJoCo's own where the contact has no such row; a row that is only a neighbour's gets none
    torsion, roll = (0.0, 0.0) if condim > 3 else (0.005, 0.0001)  # noqa: PLR2004 - a condim
    torsion = torsion if drilling is None else drilling.length
    roll = roll if rolling is None else rolling.length
    attributes = {"friction": numbers(mu, torsion, roll), "condim": str(condim)}
    if rows is not None:
        attributes |= {"solref": numbers(*rows.solref), "solimp": numbers(*rows.solimp)}
    return attributes


def cone(scene: Scene) -> dict[str, str]:
    """Return the attributes of `option` that a declared law of the contact calls for."""
    rows = contact_rows(scene)
    return {} if rows is None else {"impratio": numbers(rows.impratio), "cone": "elliptic"}


def pair(material: Mapping[str, str], rows: ContactRows) -> dict[str, str]:
    """Return the attributes of `contact/pair` for two geoms of one material."""
    mu, torsion, roll = material["friction"].split()
    return dict(material) | {
        "geom1": "ground",
        "geom2": "can",
        "friction": f"{mu} {mu} {torsion} {roll} {roll}",
        "solreffriction": numbers(*rows.solreffriction),
    }


def numbers(*values: float) -> str:
    """Return numbers as an attribute, each to its last digit."""
    return " ".join(repr(float(value)) for value in values)
