"""Numbers as a person reads them: a few significant digits, powers of ten written out.

Names: of files and anchors, and of columns as a person reads them.
"""

import math
import numbers
import re
import unicodedata
from collections.abc import Iterable

from harness.core.plain_json import is_missing

SIGNIFICANT = 4  # enough to tell 0.15 from 0.1499, few enough to compare at a glance
NOTHING = "\N{EN DASH}"

SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_MINUS = "\N{MINUS SIGN}"
_TIMES = "\N{MULTIPLICATION SIGN}"
_THIN = "\N{NARROW NO-BREAK SPACE}"
_PLAIN_FROM, _PLAIN_BELOW = 1e-3, 1e5  # outside, leading zeros and long numbers stop being readable


def is_number(value: object) -> bool:
    """Return whether a cell holds a number; a truth value is none."""
    if type(value) is float or type(value) is int:  # nearly all of them: no look at a registry
        return True
    # numpy's numbers are registered with the standard library's abstract ones; its bool is not
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def readable(value: object) -> str:
    """Return a cell as the page and the summary show it.

    Whole numbers keep all digits; others are rounded to `SIGNIFICANT` ones.
    """
    if type(value) is str:
        return value
    if is_missing(value):
        return NOTHING
    if type(value).__name__ in {"bool", "bool_"}:
        return "yes" if value else "no"
    if isinstance(value, numbers.Integral):
        grouped = f"{int(value):,}" if abs(int(value)) >= _PLAIN_BELOW / 10 else str(int(value))
        return grouped.replace(",", _THIN).replace("-", _MINUS)
    if isinstance(value, numbers.Real):
        return _rounded(float(value))
    return str(value)


def _rounded(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0.0 else f"{_MINUS}∞"
    if value == 0.0:
        return "0"
    # 0.002 stays 0.002: digits beyond an exact few say nothing
    tried = (f"{value:.{digits - 1}e}" for digits in range(1, SIGNIFICANT))
    written = next((t for t in tried if float(t) == value), f"{value:.{SIGNIFICANT - 1}e}")
    mantissa, _, exponent = written.partition("e")
    if _PLAIN_FROM <= abs(value) < _PLAIN_BELOW:
        decimals = max(len(mantissa.lstrip("-").replace(".", "")) - 1 - int(exponent), 0)
        return f"{value:.{decimals}f}".replace("-", _MINUS)
    power = str(int(exponent)).translate(SUPERSCRIPT)
    return f"{mantissa.replace('-', _MINUS)}{_TIMES}10{power}"


_UNITS = {
    "rad_s2": "rad/s²",
    "m_s2": "m/s²",
    "s_s": "s/s",
    "rad_s": "rad/s",
    "deg_s": "°/s",
    "mm_s": "mm/s",
    "m_s": "m/s",
    "kg_m2": "kg m²",
    "percent": "%",
    "bytes": "bytes",
    "deg": "°",
    "rad": "rad",
    "kg": "kg",
    "um": "µm",
    "mm": "mm",
    "us": "µs",
    "ms": "ms",
    "ns": "ns",
    "Hz": "Hz",
    "N": "N",
    "J": "J",
    "m": "m",
    "s": "s",
}  # longer suffixes first: the first that fits is taken


def slug(text: str) -> str:
    """Return a text as lower-case letters, digits and dashes, safe as a file name and an anchor."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode("ascii")
    return re.sub(r"[^a-z0-9]+", "-", plain.lower()).strip("-")[:80].strip("-") or "unnamed"


def slugs(texts: Iterable[str]) -> list[str]:
    """Return a slug for each text; later ones that would repeat an earlier one get a number."""
    given: list[str] = []
    for text in texts:
        base = name = slug(text)
        count = 1
        while name in given:
            count += 1
            name = f"{base}-{count}"
        given.append(name)
    return given


def heading(column: str) -> tuple[str, str]:
    """Return a column's name in words and its unit, which may be empty.

    Parameters
    ----------
    column : str
        Words joined by underscores, the unit last: ``angle_of_turn_deg``.
    """
    for suffix, unit in _UNITS.items():
        stem = column.removesuffix(f"_{suffix}")
        if stem and stem != column:
            return stem.replace("_", " "), unit
    return column.replace("_", " "), ""
