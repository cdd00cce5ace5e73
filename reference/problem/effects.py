"""Effects that a problem adds to the ideal can, dimensionless; one left out is its ideal limit.

Lengths are in R, times in sqrt(R/g), masses in that of the can, accelerations in g. The world is
the frame of the plane, z along its normal: a tilted plane is a tilted gravity, a shaken plane a
gravity that changes with time.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reference.problem.validation import (
    FINITE,
    NOT_NEGATIVE,
    POSITIVE,
    RefusedError,
    require,
    require_numbers,
    require_vector,
)

# Strengths of the laws that oppose the motion of the contact point along the rim.
ALONG_THE_RIM = ("contour", "contour_damping", "film", "boundary_layer")
# A direction made of sines and cosines has length 1 up to some roundings of its parts.
ROUNDED = 16 * float(np.finfo(float).eps)


class EffectError(RefusedError):
    """An effect that makes no sense."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mass:
    """A point mass fixed to the can, in axes fixed to it.

    Parameters
    ----------
    share : float
        Its mass over that of the can, greater than zero.
    x, y, z : float
        Where, from the centre of the can: z along the symmetry axis away from the rim it rolls on,
        x away from the contact point where theta is zero. Inside the can, which `Problem` checks.

    Raises
    ------
    EffectError
        If a number is not finite, or the share not positive.
    """

    share: float
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a mass that is none."""
        require_numbers(EffectError, {"share": self.share}, POSITIVE)
        require_numbers(EffectError, {"x": self.x, "y": self.y, "z": self.z}, FINITE)


LINEAR, STEEPEST = 1.0, 2.0
"""Exponents between which the force of a compliant contact grows with its depth."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compliance:
    """A contact that gives way, by the depth d of the rim's lowest point in the plane.

    The normal force over m g is max(0, k d + b d') for the exponent n = 1 (Kelvin and Voigt), and
    max(0, d^n (k + b d')) for n > 1 (Hertz's n = 3/2 with the damping of Hunt and Crossley, which
    is zero at the first touch).

    Parameters
    ----------
    stiffness : float
        k, in m g/R^n, greater than zero.
    damping : float
        b, in m sqrt(g/R) for n = 1, else in m sqrt(g/R)/R^n.
    exponent : float
        n, inside [1, 2].

    Raises
    ------
    EffectError
        If a number is out of its range.
    """

    stiffness: float
    damping: float = 0.0
    exponent: float = LINEAR

    def __post_init__(self) -> None:
        """Refuse a contact that does not push."""
        require_numbers(EffectError, {"stiffness": self.stiffness}, POSITIVE)
        require_numbers(EffectError, {"damping": self.damping}, NOT_NEGATIVE)
        require_numbers(EffectError, {"exponent": self.exponent}, FINITE)
        inside = LINEAR <= self.exponent <= STEEPEST
        require(EffectError, "exponent", self.exponent, "inside [1, 2]", when=inside)

    def depth_under(self, load: float) -> float:
        """Return the depth in R at which a contact at rest bears a load in m g, not negative."""
        depth: float = (load / self.stiffness) ** (1 / self.exponent)
        return depth


@dataclass(frozen=True, slots=True, kw_only=True)
class Gravity:
    """Gravity in the frame of the plane: constant + amplitude sin(rate t + phase), in g.

    Parameters
    ----------
    constant : tuple of float
        Three components, of length 1; the third is negative, for the plane is below the can.
    amplitude : tuple of float
        Three components of what the shaking adds.
    rate, phase : float
        The rate is not negative.

    Raises
    ------
    EffectError
        If a number is not finite or out of its range.
    """

    constant: tuple[float, float, float] = (0.0, 0.0, -1.0)
    amplitude: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rate: float = 0.0
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Refuse another unit than g, and a plane that is a wall or a ceiling."""
        for name in ("constant", "amplitude"):
            require_vector(EffectError, name, getattr(self, name), 3)
        unit = abs(math.hypot(*self.constant) - 1) <= ROUNDED
        allowed = "a direction of length 1 (in g) that points into the plane (third component < 0)"
        down = unit and self.constant[2] < 0
        require(EffectError, "constant", self.constant, allowed, when=down)
        require_numbers(EffectError, {"rate": self.rate}, NOT_NEGATIVE)
        require_numbers(EffectError, {"phase": self.phase}, FINITE)

    @property
    def tilted(self) -> bool:
        """Return whether gravity has a part along the plane."""
        return self.constant[:2] != (0.0, 0.0)

    @property
    def shaken(self) -> bool:
        """Return whether gravity changes with time."""
        return self.amplitude != (0.0, 0.0, 0.0)

    def shaking(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the part of the shaking, shape (3, n)."""
        wave = np.sin(self.rate * np.asarray(times) + self.phase)
        return np.asarray(self.amplitude)[:, None] * wave


IMPACT_LAWS = ("newton", "poisson")


@dataclass(frozen=True, slots=True, kw_only=True)
class Restitution:
    """What an impact gives back (`reference.unilateral.impact`).

    Modelling choices: `mu_static` has no part in an impact; a patch acts in it as a point; contour
    friction gives no impulse; films of air and contour friction end in flight.

    Parameters
    ----------
    coefficient : float
        In [0, 1].
    law : str
        One of `IMPACT_LAWS`.

    Raises
    ------
    EffectError
        If the coefficient lies outside [0, 1], or there is no such law.
    """

    coefficient: float
    law: str = "newton"

    def __post_init__(self) -> None:
        """Refuse an impact that makes energy, and an unknown law."""
        require_numbers(EffectError, {"coefficient": self.coefficient}, NOT_NEGATIVE)
        fits = self.coefficient <= 1
        require(EffectError, "coefficient", self.coefficient, "at most 1", when=fits)
        allowed = " or ".join(IMPACT_LAWS)
        require(EffectError, "law", self.law, allowed, when=self.law in IMPACT_LAWS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Effects:
    """The effects of a problem.

    Parameters
    ----------
    mu : float or None
        Coefficient of Coulomb friction; None is a rim that never slips.
    mu_static : float or None
        Coefficient up to which the rim sticks, at least `mu`; None is `mu`.
    patch : float
        Radius, in R, of the patch of contact in which sliding and drilling share the friction
        (`reference.equations.patch_friction`); zero is a point. Excludes `drilling`.
    drilling, rolling_resistance : float
        Arms of the moments, in R, that the normal force makes about the normal and in the plane.
        A modelling choice: their limits and the cone of friction are apart, so that what one takes
        the others have not less of.
    contour : float
        Coefficient of dry friction against the motion of the contact point along the rim.
    contour_damping : float
        Force against that motion over its velocity, in m sqrt(g/R).
    film, boundary_layer : float
        Moments against that motion by the air below the can, over theta'/sin(phi) and over
        |theta'|^(3/2), in units of m, R and g (`reference.equations.dissipation`).
    linear_damping, angular_damping : float
        Rates: force -rate M v, moment -rate I omega, both at the centre of mass. A modelling
        choice: velocities are relative to the plane, also of one that is shaken.
    rim : float
        Radius of the arc that the rim is, in R. The centre of the arc is 1 - rim from the axis and
        h - rim from the middle of the can, neither of which may be negative: at most 1 here, and
        at most h in a `Problem`, which knows the can.
    gravity : Gravity
    mass : Mass or None
    compliance : Compliance or None
        How the contact gives way; None is a rigid contact.
    restitution : Restitution or None
        Of impacts; where it is declared, be it 0, the contact is unilateral: a rim that leaves the
        plane flies, and lands.

    Raises
    ------
    EffectError
        If a number is negative or not finite, or something is not the effect its name says.
    """

    mu: float | None = None
    mu_static: float | None = None
    patch: float = 0.0
    drilling: float = 0.0
    rolling_resistance: float = 0.0
    contour: float = 0.0
    contour_damping: float = 0.0
    film: float = 0.0
    boundary_layer: float = 0.0
    linear_damping: float = 0.0
    angular_damping: float = 0.0
    rim: float = 0.0
    gravity: Gravity = field(default_factory=Gravity)
    mass: Mass | None = None
    compliance: Compliance | None = None
    restitution: Restitution | None = None

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        numbers = ("drilling", "rolling_resistance", "linear_damping", "angular_damping", "rim")
        values = {name: getattr(self, name) for name in (*numbers, "patch", *ALONG_THE_RIM)}
        for name in ("mu", "mu_static"):
            if getattr(self, name) is not None:
                values[name] = getattr(self, name)
        require_numbers(EffectError, values, NOT_NEGATIVE)
        allowed = f"at least `mu` = {self.mu!r}, and given with `mu` alone"
        fits = self.mu_static is None or (self.mu is not None and self.mu_static >= self.mu)
        require(EffectError, "mu_static", self.mu_static, allowed, when=fits)
        allowed = "zero without friction `mu` > 0, whose moment the patch makes"
        require(EffectError, "patch", self.patch, allowed, when=not self.patch or bool(self.mu))
        allowed = "zero with `drilling`: both are friction against turning about the normal"
        fits = not (self.patch and self.drilling)
        require(EffectError, "patch", self.patch, allowed, when=fits)
        allowed = (
            "zero with `rolling_resistance`: both oppose rolling, by laws that exclude another"
        )
        fits = not (self.contour and self.rolling_resistance)
        require(EffectError, "contour", self.contour, allowed, when=fits)
        allowed = "zero with `mu` = 0: a plane without friction resists no motion along the rim"
        fits = not (self.contour and self.mu == 0)
        require(EffectError, "contour", self.contour, allowed, when=fits)
        allowed = "at most 1: an arc of a larger radius reaches beyond the axis"
        require(EffectError, "rim", self.rim, allowed, when=self.rim <= 1)
        fits = isinstance(self.gravity, Gravity)
        require(EffectError, "gravity", self.gravity, "a Gravity", when=fits)
        fits = self.mass is None or isinstance(self.mass, Mass)
        require(EffectError, "mass", self.mass, "a Mass or None", when=fits)
        fits = self.compliance is None or isinstance(self.compliance, Compliance)
        require(EffectError, "compliance", self.compliance, "a Compliance or None", when=fits)
        fits = self.restitution is None or isinstance(self.restitution, Restitution)
        allowed = "a Restitution or None"
        require(EffectError, "restitution", self.restitution, allowed, when=fits)
        allowed = "None with `compliance`: what a compliant contact gives back follows from its law"
        fits = self.restitution is None or self.compliance is None
        require(EffectError, "restitution", self.restitution, allowed, when=fits)

    def declared(self) -> tuple[str, ...]:
        """Return the names of the declared effects."""
        if self is IDEAL:
            return ()
        present = {
            "slip": self.mu is not None,
            "compliance": self.compliance is not None,
            "restitution": self.restitution is not None,
            "patch": self.patch > 0,
            "drilling": self.drilling > 0,
            "rolling_resistance": self.rolling_resistance > 0,
            "contour_friction": self.contour > 0 or self.contour_damping > 0,
            "air_film": self.film > 0 or self.boundary_layer > 0,
            "damping": self.linear_damping > 0 or self.angular_damping > 0,
            "rim": self.rim > 0,
            "tilt": self.gravity.tilted,
            "shake": self.gravity.shaken,
            "point_mass": self.mass is not None,
        }
        return tuple(name for name, there in present.items() if there)


IDEAL = Effects()
