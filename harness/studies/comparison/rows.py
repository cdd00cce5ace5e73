"""What every table of the comparison has in common: the columns that name a case."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from harness.runner import Evaluation

Row = dict[str, Any]

CASE: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "profile": "default: as it ships; matched: what the scene declares; adaptive: and own steps.",
    "timestep_s": "Timestep of the engine, s; the largest of an adaptive run.",
}


def key(e: Evaluation) -> Row:
    """Return what names a case in every table."""
    case = e.simulation.case
    return {
        "scene": case.scene.name,
        "engine": case.engine,
        "profile": case.profile,
        "timestep_s": e.simulation.timestep,
    }


def frame(rows: list[Row], columns: Mapping[str, str]) -> pd.DataFrame:
    """Return rows as a frame with just these columns, in this order."""
    return pd.DataFrame(rows, columns=list(columns))


LINK: Mapping[str, str] = {"case": "Digest of the case; its command is in the list of cases."}
"""The column that leads to the case behind a row."""


def link(e: Evaluation) -> Row:
    """Return what leads to the case behind a row."""
    return {"case": e.simulation.case.digest(e.simulation.engine_version)}
