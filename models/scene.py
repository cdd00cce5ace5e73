"""The scene: a can, its release, the effects it is subject to, and how long to watch."""

import re
from dataclasses import asdict, dataclass, field
from typing import Any

from models.can import Can
from models.effects import Effects, check_fits
from models.errors import InvalidValueError
from models.quantity import not_negative, positive
from models.release import Release

NAME_PATTERN = r"[a-z0-9][a-z0-9._-]{0,63}"
"""Pattern of a scene's name: safe as a file name, an XML name and a table key alike."""

LONGEST_CITE = 500
"""Characters of a citation."""

MOST_BOUNCES = 100_000
"""Beyond the thousand bounces of the hardest case, short of a run that never ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Horizon:
    """Horizon of a run: a number of bounces, or a time; exactly one is given.

    Parameters
    ----------
    bounces : int, optional
        Passages of phi through a minimum and up to its next maximum, 1 to 100,000.
    seconds : float, optional
        Greater than zero.

    Raises
    ------
    InvalidValueError
        If neither or both are given, or one is out of range.
    """

    bounces: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        """Refuse a horizon that does not end, or ends twice."""
        if (self.bounces is None) == (self.seconds is None):
            given = "neither" if self.bounces is None else "both"
            raise InvalidValueError("horizon", given, "exactly one of `bounces` and `seconds`")
        if self.seconds is not None:
            object.__setattr__(self, "seconds", positive("seconds", self.seconds))
        elif (
            isinstance(self.bounces, bool)
            or not isinstance(self.bounces, int)
            or not 1 <= self.bounces <= MOST_BOUNCES
        ):
            allowed = f"an integer from 1 to {MOST_BOUNCES}"
            raise InvalidValueError("bounces", self.bounces, allowed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """All that a run is about, whatever engine runs it. SI units and radians.

    Parameters
    ----------
    name : str
        Lower-case letters, digits, dots, dashes and underscores; at most 64, no sign first.
    cite : str
        Where the scene comes from; at most 500 printable characters.
    gravity : float
        g, m/s^2; zero or greater, pointing down.
    can : Can
    release : Release
    effects : Effects
        None at all unless given: the ideal can.
    horizon : Horizon

    Raises
    ------
    InvalidValueError
        If a value is out of its range.
    """

    name: str
    cite: str = ""
    gravity: float
    can: Can
    release: Release
    effects: Effects = field(default_factory=Effects)
    horizon: Horizon

    def __post_init__(self) -> None:
        """Refuse what cannot be named, cited or dropped."""
        name: object = self.name
        if not isinstance(name, str) or re.fullmatch(NAME_PATTERN, name) is None:
            allowed = (
                "1 to 64 lower-case letters, digits, dots, dashes and underscores, "
                "the first a letter or digit"
            )
            raise InvalidValueError("name", name, allowed)
        cite: object = self.cite
        if not isinstance(cite, str) or len(cite) > LONGEST_CITE or not cite.isprintable():
            allowed = f"at most {LONGEST_CITE} printable characters on one line"
            raise InvalidValueError("cite", cite, allowed)
        object.__setattr__(self, "gravity", not_negative("gravity", self.gravity))
        for key, kind in (
            ("can", Can),
            ("release", Release),
            ("effects", Effects),
            ("horizon", Horizon),
        ):
            if not isinstance(getattr(self, key), kind):
                raise InvalidValueError(key, getattr(self, key), f"a {kind.__name__}")
        try:
            check_fits(self.effects, self.can)
        except InvalidValueError as error:
            raise InvalidValueError(f"effects.{error.key}", error.value, error.allowed) from None

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as a scene file says it: plain, nested, in SI units.

        Equal scenes give equal dictionaries, so a digest of this is a digest of the scene.
        """
        can, release, horizon = self.can, self.release, self.horizon
        return {
            "name": self.name,
            "cite": self.cite,
            "gravity": self.gravity,
            "can": {
                "mass": can.mass,
                "radius": can.radius,
                "A": can.transverse_inertia,
                "C": can.axial_inertia,
                "H": can.half_height,
            },
            "release": {
                "phi": release.phi,
                "psi": release.psi,
                "theta": release.theta,
                "phi_dot": release.phi_dot,
                "psi_dot": release.psi_dot,
                "theta_dot": release.theta_dot,
            }
            # a can on its rim keeps the digest that it had when there was no other
            | ({"height": release.height} if release.height != 0.0 else {}),
            "horizon": (
                {"seconds": horizon.seconds}
                if horizon.bounces is None
                else {"bounces": horizon.bounces}
            ),
            "effects": {
                name: _constants(getattr(self.effects, name)) for name in self.effects.declared()
            },
        }


def _constants(effect: Any) -> dict[str, Any]:  # noqa: ANN401 - of any kind
    """Return the constants of an effect without those that are left out."""
    return {key: value for key, value in asdict(effect).items() if value is not None}
