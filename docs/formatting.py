"""Tables and digits as the texts have them, of the files that were measured."""

import math
from collections.abc import Hashable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from harness.engines.registry import our_names

ROOT = Path(__file__).parents[1]
BASELINE = ROOT / "reports" / "baseline"

Row = Mapping[Hashable, Any]

ENGINES = {"mujoco": "MuJoCo", "pybullet": "PyBullet"}
"""Engines that are measured for the texts, by name."""


def csv(name: str) -> pd.DataFrame:
    """Return a table below `reports/baseline`; an empty cell is an empty string or NaN."""
    return pd.read_csv(BASELINE / name)


def markdown(head: Iterable[str], rows: Iterable[Iterable[str]], words: int = 1) -> str:
    """Return a table in Markdown; all columns but the first ones hold numbers."""
    head = list(head)
    rule = ["---"] * words + ["---:"] * (len(head) - words)
    lines = [head, rule, *rows]
    return "\n" + "".join("| " + " | ".join(line) + " |\n" for line in lines)


def digits(value: float, count: int = 3) -> str:
    """Return a number with so many digits that count, or to its unit where it has more."""
    if abs(value) >= 100.0:  # noqa: PLR2004 - three digits
        return f"{value:,.0f}"
    mantissa, power, exponent = f"{value:.{count}g}".partition("e")
    return mantissa + (power and f"e{int(exponent)}")


def adapter_of(name: str) -> str:
    """Return the adapter of an engine; empty of one that is not of this project.

    An engine in an environment of its own has a version behind the name of its adapter.
    """
    own = (own for own in our_names() if f"{name}-".startswith(f"{own}-"))
    return max(own, key=len, default="")


def error_words(row: Row, column: str) -> str:
    """Return the error of a run, or in words why it has none."""
    kind, _, why = str(row[f"{column}_verdict"]).partition(": ")
    error = float(row[column])
    if kind == "not decidable":
        return kind
    if kind in {"failed", "unsupported"} or math.isnan(error):
        return {"flat": "falls flat", "overturned": "overturns", "diverged": "diverges"}.get(
            why, why.removesuffix(" the turns") or kind
        )
    return digits(error)
