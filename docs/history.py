"""The tables of the histories: at which release of an engine its contact changed."""

import math

from docs.formatting import Row, csv, digits, markdown
from harness.metrics.quantities import QUANTITIES

HISTORIES = ("mujoco", "mujoco-implicitfast", "pybullet")
"""Folders `history-...` of `reports/baseline`."""


def history() -> dict[str, str]:
    """Return for each history what changed at which release, and what was run."""
    facts: dict[str, str] = {}
    for name in HISTORIES:
        key = name.replace("-", "_")
        points, versions = (
            csv(f"history-{name}/{table}.csv") for table in ("change-points", "versions")
        )
        ran, absent = versions[versions["cases"] > 0], versions[versions["cases"] == 0]
        head = ("between", "and", "cases", "quantities", "most", "before", "after", "factor")
        rows = [_point(row) for row in points.to_dict("records")]
        facts |= {
            f"{key}_ran": str(len(ran)),
            f"{key}_listed": str(len(versions)),
            f"{key}_first": str(ran["version"].iloc[0]),
            f"{key}_last": str(ran["version"].iloc[-1]),
            f"{key}_cases": str(ran["cases"].max()),
            f"{key}_compared": str(ran["quantities"].max()),
            f"{key}_versions": ", ".join(ran["version"]),
            f"{key}_absent": "; ".join(
                f"{row['version']}: {row['reason']}" for row in absent.to_dict("records")
            )
            or "none",
            f"{key}_releases_changed": str(len(points)),
            f"{key}_quantities": str(points["quantities"].sum()),
            f"{key}_table": markdown(head, rows, words=5) if rows else "\nNothing changed.\n",
        }
    return facts


def _point(row: Row) -> list[str]:
    """Return a row of the table of releases that changed something."""
    step = "" if math.isnan(row["timestep_s"]) else f" at {row['timestep_s']:g} s"
    case = f"{row['scene']} {_PROFILES[row['profile']]}{step}"
    counts = [str(row["from_version"]), str(row["to_version"])]
    counts += [str(row["cases"]), str(row["quantities"])]
    if row["quantity"] not in QUANTITIES:
        return [*counts, f"{row['quantity']} of {case}", "", "", ""]
    quantity = QUANTITIES[row["quantity"]]
    unit = f", {quantity.unit}" if quantity.unit else ""
    values = ("" if math.isnan(row[name]) else digits(row[name]) for name in _VALUES)
    return [*counts, f"{quantity.label}{unit}: {case}", *values]


_PROFILES = {"default": "as shipped", "matched": "matched", "adaptive": "adaptive"}
_VALUES = ("before", "after", "factor")
