"""The release of a can: the paper's angles and their rates."""

import math
from dataclasses import dataclass, fields

from models.errors import InvalidValueError
from models.quantity import finite


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """The angles and rates with which a can is let go, rad and rad/s, and how high.

    Parameters
    ----------
    phi : float
        Nutation, the tilt of the symmetry axis from the vertical; between 0 and pi/2, exclusive.
    psi, theta : float
        Precession and rotation (spin about the symmetry axis).
    phi_dot, psi_dot, theta_dot : float
        Their rates.
    height : float
        Of the lowest point of the rim above the plane, m; negative starts inside it. At zero,
        which is what is left out, the can stands on its rim.

    Raises
    ------
    InvalidValueError
        If a number is not finite, or if `phi` is out of its range.
    """

    phi: float
    psi: float = 0.0
    theta: float = 0.0
    phi_dot: float = 0.0
    psi_dot: float = 0.0
    theta_dot: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a can whose lowest point is not one point of its rim."""
        for field in fields(self):
            object.__setattr__(self, field.name, finite(field.name, getattr(self, field.name)))
        if not 0.0 < self.phi < math.pi / 2.0:
            raise InvalidValueError("phi", self.phi, "greater than 0 and less than pi/2 (radians)")
