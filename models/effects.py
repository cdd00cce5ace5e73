"""What a scene adds to the ideal can: each effect is present, or is None, its ideal limit.

The ideal can is rigid, rolls without slipping, loses nothing, and stands on a level plane at rest.
An effect is a small frozen class that holds the constants of its law, in SI units.
"""

from dataclasses import dataclass, fields

from models.errors import InvalidValueError
from models.quantity import not_negative

NO_SLIP_FRICTION = 2.0
"""Coefficient of friction of an engine model whose scene declares no slip.

An engine has no no-slip constraint, so it gets twice the friction that rolling calls for: 1.021 in
the bounces of the scene `wobble`, the most of any whose plane need not pull; the paper's release
needs 0.508. With 1 that scene slips. More changes little: from 2 to 5, psi after two bounces of
`wobble` at a timestep of 1e-5 moves by 1e-8 degrees in MuJoCo and by 0.011 in PyBullet.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slip:
    """Coulomb friction: the rim slips where the rolling can would need |F| > mu N.

    Parameters
    ----------
    mu : float
        Coefficient of friction of the pair of can and plane; zero is a frictionless plane.

    Raises
    ------
    InvalidValueError
        If `mu` is negative or not finite.
    """

    mu: float

    def __post_init__(self) -> None:
        """Refuse friction that would drive the can."""
        object.__setattr__(self, "mu", not_negative("mu", self.mu))


@dataclass(frozen=True, slots=True, kw_only=True)
class Effects:
    """The effects of a scene; what is left out is the ideal limit.

    Parameters
    ----------
    slip : Slip, optional
        Coulomb friction; left out, the can never slips.
    """

    slip: Slip | None = None

    def __post_init__(self) -> None:
        """Refuse what is not an effect."""
        if self.slip is not None and not isinstance(self.slip, Slip):
            raise InvalidValueError("slip", self.slip, "a Slip or None")

    def declared(self) -> tuple[str, ...]:
        """Return the names of the effects that are present, in the order of the fields."""
        return tuple(field.name for field in fields(self) if getattr(self, field.name) is not None)


IDEAL = Effects()
"""No effect at all: rigid, no slip, no loss, level, at rest."""
