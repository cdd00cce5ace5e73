"""Which colour and mark a curve has: by whose curve it is, the same in every figure of a report.

Each kind has two colours of one hue, one for a light and one for a dark page. Each stands out from
its page by at least 3:1 (WCAG 2.2, 1.4.11), and any two inks stay apart for the three
kinds of colour blindness; both are tested. Line, dash and mark repeat what the colour says.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

PAPER_LIGHT = "#fcfbf8"
PAPER_DARK = "#14171c"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ink:
    """How one kind of curve is drawn.

    Parameters
    ----------
    light, dark : str
        Colour on a light and on a dark page, #rrggbb.
    width : float
        Of the line, in CSS pixels; the truth is wide so that it shows below what lies on it.
    """

    light: str
    dark: str
    width: float = 1.8


REFERENCE = Ink(light="#16181d", dark="#f3f0e9", width=3.4)

_KNOWN: Mapping[str, Ink] = MappingProxyType(
    {
        "reference": REFERENCE,
        "mujoco": Ink(light="#0a6fb0", dark="#5cb8f0"),
        "pybullet": Ink(light="#d2560a", dark="#ff9d5c"),
    }
)
_FURTHER = (
    Ink(light="#1e2791", dark="#7f7cf0"),
    Ink(light="#3c561c", dark="#aff3a0"),
    Ink(light="#b8727d", dark="#d9525a"),
    Ink(light="#829151", dark="#e5cc1c"),
    Ink(light="#683964", dark="#ab7097"),
    Ink(light="#956391", dark="#e19dbc"),
)


def palette(kinds: Iterable[str]) -> Mapping[str, Ink]:
    """Return the ink of each kind; what is not known by name takes the further ones in order.

    Parameters
    ----------
    kinds : iterable of str
        Every kind in the report, in any order: the result does not depend on it.
    """
    chosen: dict[str, Ink] = {}
    further = 0
    for kind in sorted(set(kinds)):
        if kind in _KNOWN:
            chosen[kind] = _KNOWN[kind]
        else:
            chosen[kind] = _FURTHER[further % len(_FURTHER)]
            further += 1
    return MappingProxyType(chosen)
