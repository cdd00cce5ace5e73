"""Names: of files and anchors, and of columns as a person reads them."""

import re
import unicodedata
from collections.abc import Iterable

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
