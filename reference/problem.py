"""What is to be solved: a can, its release, and how long to follow it.

Everything is dimensionless: angles in rad, times in sqrt(R/g), rates in sqrt(g/R).
"""

import math
from dataclasses import dataclass, fields

from reference.effects import IDEAL, Effects
from reference.parameters import Parameters


class ProblemError(ValueError):
    """A release or a horizon that makes no sense."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """An initial-value problem of the rocking can.

    Parameters
    ----------
    parameters : Parameters
    phi : float
        Nutation at release, inside (0, pi/2).
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

    Raises
    ------
    ProblemError
        If a value is not finite, phi lies outside (0, pi/2), or the horizon is not exactly one
        positive number.
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

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, float) and not math.isfinite(value):
                raise ProblemError(f"`{field.name}` must be finite, got {value!r}")
        if not 0 < self.phi < math.pi / 2:
            raise ProblemError(f"`phi` must lie inside (0, pi/2), got {self.phi!r}")
        if self.slip != (0.0, 0.0) and self.effects.mu is None:
            raise ProblemError(f"`slip` must be none without declared friction, got {self.slip!r}")
        if not all(math.isfinite(part) for part in self.slip):
            raise ProblemError(f"`slip` must be finite, got {self.slip!r}")
        if (self.bounces is None) == (self.duration is None):
            raise ProblemError("give exactly one of `bounces` and `duration`")
        if self.bounces is not None and self.bounces < 1:
            raise ProblemError(f"`bounces` must be at least 1, got {self.bounces!r}")
        if self.duration is not None and not self.duration > 0:
            raise ProblemError(f"`duration` must be positive, got {self.duration!r}")
