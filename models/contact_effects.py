"""Effects at the contact: the laws of a rim on a plane that is not ideal.

Each class holds the constants of one law, in SI units. N is the normal force of the plane on the
can, v_c the velocity of the can's material at the contact relative to the plane.
"""

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar

from models.errors import InvalidValueError
from models.quantity import finite, not_negative, positive

ADDED_LATER = MappingProxyType({"left out at its default": True})
"""Metadata of a constant that a law got later: scenes that leave it out keep their digest."""
NEWTON, POISSON = IMPACT_LAWS = ("newton", "poisson")
"""Laws of restitution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slip:
    """Coulomb friction: the rim sticks while |F| <= mu N, else F = -mu N v_c/|v_c|.

    Modelling choices: static friction equals kinetic friction unless `mu_static` is given, and the
    cone is of friction alone; drilling and rolling resistance have limits of their own. With
    `patch` sliding and drilling share the friction of a round patch under Hertz's pressure
    (Contensou 1963): its force is F while it does not turn, and less the faster it turns.

    Parameters
    ----------
    mu : float
        Coefficient of friction of the pair of can and plane; zero is a frictionless plane.
    mu_static : float, optional
        Coefficient up to which the rim sticks, at least `mu`; left out, `mu`.
    patch : float, optional
        Radius of the patch of contact, m; left out or zero, a point. It needs friction, `mu` > 0.

    Raises
    ------
    InvalidValueError
        If `mu` is negative or not finite, `mu_static` below it, or `patch` negative, or a patch
        without friction.
    """

    modelling_choice: ClassVar[str] = (
        "Friction has one coefficient, static equal to kinetic unless mu_static is declared, and a "
        "cone of its own: what drilling and rolling resistance take is not taken from it. A patch, "
        "where one is declared, is round, under Hertz's pressure, and does not grow with the load."
    )

    mu: float
    mu_static: float | None = field(default=None, metadata=ADDED_LATER)
    patch: float | None = field(default=None, metadata=ADDED_LATER)

    def __post_init__(self) -> None:
        """Refuse friction that would drive the can."""
        object.__setattr__(self, "mu", not_negative("mu", self.mu))
        patch = 0.0 if self.patch is None else not_negative("patch", self.patch)
        if patch > 0.0 and self.mu == 0.0:
            allowed = "zero where `mu` is: without friction there is none for a patch to share"
            raise InvalidValueError("patch", patch, allowed)
        # no patch is a point, with one digest
        object.__setattr__(self, "patch", patch or None)
        if self.mu_static is None:
            return
        allowed = f"at least `mu` = {self.mu!r}: a rim that sticks needs no less to let go"
        static = finite("mu_static", self.mu_static, allowed)
        if static < self.mu:
            raise InvalidValueError("mu_static", static, allowed)
        # equal coefficients are one coefficient, with one digest
        object.__setattr__(self, "mu_static", None if static == self.mu else static)


@dataclass(frozen=True, slots=True, kw_only=True)
class Compliance:
    """A contact that gives way, at the depth d of the rim's lowest point in the plane.

    With the exponent n = 1 the normal force is N = max(0, k d + b d'), a linear spring and damper.
    With n > 1 it is N = max(0, d^n (k + b d')), which is Hertz's contact for n = 3/2, with the
    damping of Hunt and Crossley (J. Appl. Mech. 42, 1975, 440), which is zero at the first touch.

    Parameters
    ----------
    stiffness : float
        k, N/m^n, greater than zero; rigid is its limit at infinity.
    damping : float
        b, zero or greater; N s/m for n = 1, N s/m^(n+1) for n > 1.
    exponent : float
        n, from 1 to 2.

    Raises
    ------
    InvalidValueError
        If a constant is out of its range.
    """

    modelling_choice: ClassVar[str] = (
        "A compliant contact is a spring and a damper at the lowest point of the rim, by one law "
        "whatever the depth and its rate, and never pulls."
    )

    stiffness: float
    damping: float = 0.0
    exponent: float = field(default=1.0, metadata=ADDED_LATER)

    def __post_init__(self) -> None:
        """Refuse a contact that pulls or drives."""
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness))
        object.__setattr__(self, "damping", not_negative("damping", self.damping))
        allowed = "a number from 1 (linear) to 2; 1.5 is Hertz's"
        exponent = finite("exponent", self.exponent, allowed)
        if not 1.0 <= exponent <= 2.0:  # noqa: PLR2004 - as the sentence says
            raise InvalidValueError("exponent", exponent, allowed)
        object.__setattr__(self, "exponent", exponent)

    @property
    def linear(self) -> bool:
        """Whether it is a linear spring and damper."""
        return self.exponent == 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Restitution:
    """How much an impact gives back, by Newton's law or by Poisson's.

    Declared, be it with a coefficient of 0, the contact is unilateral: a can that the plane would
    have to pull leaves it, flies, and lands. An effect that is left out makes the same of a can
    that is released above the plane, with a coefficient of 0.

    Parameters
    ----------
    coefficient : float
        e, from 0 (the rim stays on the plane) to 1 (nothing is lost along the normal).
    law : str
        "newton": the normal velocity of the contact after an impact is -e times that before;
        "poisson": the normal impulse after the greatest compression is e times that until then.
        Without friction the two are one.

    Raises
    ------
    InvalidValueError
        If the coefficient lies outside [0, 1], or there is no such law.
    """

    modelling_choice: ClassVar[str] = (
        "An impact gives back the same share of the normal velocity (Newton's law) or of the "
        "normal impulse (Poisson's law) however fast it is. Static friction has no part in an "
        "impact. A patch of contact acts in it as a point. Contour friction gives no impulse. "
        "Films of air and contour friction end in flight."
    )

    coefficient: float
    law: str = field(default=NEWTON, metadata=ADDED_LATER)

    def __post_init__(self) -> None:
        """Refuse an impact that makes energy."""
        allowed = "a number from 0 to 1: no impact gives back more than it got"
        value = finite("coefficient", self.coefficient, allowed)
        if not 0.0 <= value <= 1.0:
            raise InvalidValueError("coefficient", value, allowed)
        object.__setattr__(self, "coefficient", value)
        if self.law not in IMPACT_LAWS:
            raise InvalidValueError("law", self.law, " or ".join(map(repr, IMPACT_LAWS)))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Resistance:
    """A moment that the contact holds against turning: at most `length` N.

    Parameters
    ----------
    length : float
        Its arm, m, greater than zero.

    Raises
    ------
    InvalidValueError
        If the length is not positive and finite.
    """

    length: float

    def __post_init__(self) -> None:
        """Refuse a moment that would drive the can."""
        object.__setattr__(self, "length", positive("length", self.length))


@dataclass(frozen=True, slots=True, kw_only=True)
class Drilling(_Resistance):
    """Torsional friction: a moment of at most `length` N about the normal, against drilling.

    Modelling choices: its limit is apart from the cone of friction, though in a patch of contact
    both come of the same pressure, and it holds with as large a moment as it slows with.

    The arm is the radius of the patch times its coefficient of friction.
    """

    modelling_choice: ClassVar[str] = (
        "Drilling friction has a limit of its own, its arm times the normal force, beside the "
        "cone of friction, and holds with as large a moment as it slows with."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RollingResistance(_Resistance):
    """A moment of at most `length` N in the plane, against the angular velocity in the plane.

    Modelling choices: its limit is apart from the cone of friction and from that of drilling, and
    it holds with as large a moment as it slows with.
    """

    modelling_choice: ClassVar[str] = (
        "Rolling resistance has a limit of its own, its arm times the normal force, beside the "
        "cone of friction, and holds with as large a moment as it slows with."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ContourFriction:
    """Friction of the contact point that runs along the rim: a moment that slows theta'.

    The force on theta is -(coulomb N + viscous R |theta'|) R sign(theta').

    Parameters
    ----------
    coulomb : float
        Dry: the force against the motion along the rim over the normal force, zero or greater.
    viscous : float
        That force over its velocity R theta', N s/m, zero or greater; one of the two is positive.

    Raises
    ------
    InvalidValueError
        If a constant is out of its range, or both are zero.
    """

    modelling_choice: ClassVar[str] = (
        "Contour friction opposes the motion of the contact point along the rim and nothing else, "
        "and is not taken from the cone of friction."
    )

    coulomb: float = 0.0
    viscous: float = 0.0

    def __post_init__(self) -> None:
        """Refuse friction that would drive the can, and none at all."""
        for name in ("coulomb", "viscous"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))
        if self.coulomb == self.viscous == 0.0:
            allowed = "greater than zero where `viscous` is zero: else there is no such friction"
            raise InvalidValueError("coulomb", self.coulomb, allowed)


@dataclass(frozen=True, slots=True, kw_only=True)
class AirFilm:
    """The air between a disk and the plane: a moment that slows theta'.

    Parameters
    ----------
    viscosity : float
        Of the air, Pa s, greater than zero.
    density : float
        kg/m^3: zero is a film that shears through the whole gap (Moffatt 2000), greater than zero
        boundary layers as thin as sqrt(viscosity/(density theta')) (Bildsten 2002).

    Raises
    ------
    InvalidValueError
        If a constant is out of its range.
    """

    modelling_choice: ClassVar[str] = (
        "The air below the disk takes the power of an estimate, by the film's thickness or, with a "
        "density, by that of its boundary layer; it does not resist the fall itself."
    )

    viscosity: float
    density: float = 0.0

    def __post_init__(self) -> None:
        """Refuse air that is none."""
        object.__setattr__(self, "viscosity", positive("viscosity", self.viscosity))
        object.__setattr__(self, "density", not_negative("density", self.density))


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundedRim:
    """A rim rounded to an arc: the outline keeps its radius R and half height H.

    Parameters
    ----------
    radius : float
        Of the arc, m, greater than zero, less than R and H.

    Raises
    ------
    InvalidValueError
        If the radius is not positive and finite; against the can it is checked by the scene.
    """

    modelling_choice: ClassVar[str] = (
        "A rounded rim is a rigid arc inside the declared radius and height; mass and moments "
        "stay as declared."
    )

    radius: float

    def __post_init__(self) -> None:
        """Refuse a rim that is no arc."""
        object.__setattr__(self, "radius", positive("radius", self.radius))
