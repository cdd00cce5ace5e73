"""A problem: a can, its release, and the horizon.

Everything is dimensionless: angles in rad, times in sqrt(R/g), rates in sqrt(g/R).
"""

import math
from dataclasses import dataclass

from reference.problem.can import Parameters
from reference.problem.effects import IDEAL, ROUNDED, Effects
from reference.problem.validation import (
    FINITE,
    NOT_NEGATIVE,
    POSITIVE,
    RefusedError,
    is_whole,
    require,
    require_numbers,
    require_vector,
)

LEAST = 1e-150
"""Least phi, and the reciprocal of the largest rate: beyond them squares leave the doubles."""

_ALLOWED_PHI, _ALLOWED_RATE = f"inside [{LEAST:g}, pi/2)", f"below {1 / LEAST:g}"


class ProblemError(RefusedError):
    """A release or a horizon that makes no sense."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """An initial-value problem of the rocking can.

    Parameters
    ----------
    parameters : Parameters
    phi : float
        Nutation at release, inside [1e-150, pi/2).
    psi, theta : float
        Precession and rotation at release.
    phi_dot, psi_dot, theta_dot : float
        Their rates.
    bounces : int or None
        Stop at the maximum of phi that closes this many bounces.
    duration : float or None
        Stop after this time; give exactly one of the two.
    effects : Effects
        What is added to the ideal can; nothing unless given.
    slip : tuple of float
        Velocity of the rim's material at the contact, along (cos psi, sin psi) and (-sin psi, cos
        psi); it rests unless given, and slips only where friction is declared.
    height : float
        Of the lowest point of the rim above the plane at the release, in R, not negative. In the
        air, too, this point's material has the velocity `slip`, and none along the vertical. More
        than zero only where restitution or a compliant contact is declared. At zero the rim is on
        the plane, and a compliant one as deep in it as bears the normal force of a rigid contact.

    Raises
    ------
    ProblemError
        If a value is not finite or of the wrong type, phi lies outside [1e-150, pi/2), a rate is
        too large for its square, the horizon is not exactly one positive number, or an effect does
        not fit the can: a rim rounded by more than the can has, or a point mass outside it.
    """

    parameters: Parameters
    phi: float
    psi: float = 0.0
    theta: float = 0.0
    phi_dot: float = 0.0
    psi_dot: float = 0.0
    theta_dot: float = 0.0
    bounces: int | None = None
    duration: float | None = None
    effects: Effects = IDEAL
    slip: tuple[float, float] = (0.0, 0.0)
    height: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        fits = isinstance(self.parameters, Parameters)
        require(ProblemError, "parameters", self.parameters, "Parameters", when=fits)
        fits = isinstance(self.effects, Effects)
        require(ProblemError, "effects", self.effects, "Effects", when=fits)
        numbers = ("phi", "psi", "theta", "phi_dot", "psi_dot", "theta_dot")
        require_numbers(ProblemError, {name: getattr(self, name) for name in numbers}, FINITE)
        inside = LEAST <= self.phi < math.pi / 2
        require(ProblemError, "phi", self.phi, _ALLOWED_PHI, when=inside)
        for name in ("phi_dot", "psi_dot", "theta_dot"):
            rate = getattr(self, name)
            require(ProblemError, name, rate, _ALLOWED_RATE, when=abs(rate) < 1 / LEAST)
        require_vector(ProblemError, "slip", self.slip, 2)
        fits = self.slip == (0.0, 0.0) or self.effects.mu is not None
        require(ProblemError, "slip", self.slip, "(0, 0) without declared friction", when=fits)
        require_numbers(ProblemError, {"height": self.height}, NOT_NEGATIVE)
        effects, allowed = self.effects, "0 without restitution or a compliant contact"
        lands = effects.compliance is not None or effects.restitution is not None
        require(ProblemError, "height", self.height, allowed, when=self.height == 0.0 or lands)
        if (self.bounces is None) == (self.duration is None):
            given, allowed = (
                (self.bounces, self.duration),
                "exactly one of `bounces` and `duration`",
            )
            sentence = f"give {allowed}, got {self.bounces!r} and {self.duration!r}"
            raise ProblemError("horizon", given, allowed, sentence)
        if self.bounces is not None:
            fits = is_whole(self.bounces) and self.bounces >= 1
            require(ProblemError, "bounces", self.bounces, "a whole number, at least 1", when=fits)
        if self.duration is not None:
            require_numbers(ProblemError, {"duration": self.duration}, POSITIVE)
        self._require_fit()

    def _require_fit(self) -> None:
        """Refuse a rim that is rounder than the can, and a mass outside it."""
        h, rim, mass = self.parameters.h, self.effects.rim, self.effects.mass
        if rim > h * (1 + ROUNDED):
            allowed = f"at most `h` = {h!r}, half the height, where the arcs of both rims meet"
            raise ProblemError("effects.rim", rim, allowed)
        allowed = "less than 1: the patch of contact is no wider than the can"
        patch = self.effects.patch
        require(ProblemError, "effects.patch", patch, allowed, when=patch < 1)
        if mass is None:
            return
        inside = math.hypot(mass.x, mass.y) <= 1 + ROUNDED and abs(mass.z) <= h * (1 + ROUNDED)
        allowed = f"inside the can: at most 1 from its axis, and `h` = {h!r} from its middle"
        require(ProblemError, "effects.mass", mass, allowed, when=inside)
