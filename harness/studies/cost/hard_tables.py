"""What one degree costs as the bounce gets harder, and how that grows."""

from collections.abc import Mapping, Sequence

import pandas as pd

from harness.core.report_model import Table
from harness.studies.cost.design import Exponent, exponent
from harness.studies.cost.points import Point
from harness.studies.cost.prices import cost_of, offers
from harness.studies.cost.results import Cost

ONE_DEGREE = 1.0

_ROWS: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "steps": "Fixed, or following the motion.",
    "epsilon": "B_{-2}^2 (a_p + 1) of the exact motion: 1.4e-10 at the paper's release.",
    "cost_s_s": "Processor seconds per simulated second for one degree of turn, between rungs.",
    "at_most": "Whether no coarser step has an error to go by, so that it costs this or less.",
    "case": "Digest of the finer of the two cases; its command is in the list of cases.",
    "command": "Runs it again, in the folder given as --out.",
}

_EXPONENTS: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "steps": "Fixed, or following the motion.",
    "exponent": "Of the cost of one degree against epsilon: -1/2 doubles it for a quarter.",
    "confidence": "Half-width of its 95 % interval; empty for two points.",
    "points": "Hardnesses that it comes from; bounds count where there are not two others.",
}


def hard_rows(cost: Cost) -> list[dict[str, object]]:
    """Return what a degree costs at each hardness."""
    rows = []
    for hard, ladders in cost.hardness:
        for family, ladder in ladders:
            found = cost_of(offers(ladder, "turn_deg", steps=True), ONE_DEGREE)
            told = _told(ladder, reached=found is not None)
            rows.append(
                {
                    "engine": family.engine,
                    "steps": family.name,
                    "epsilon": hard.epsilon,
                    "cost_s_s": None if found is None else found[0],
                    "at_most": None if found is None else found[1],
                    "case": told.digest,
                    "command": hard_command(told),
                }
            )
    return rows


def _told(ladder: Sequence[Point], *, reached: bool) -> Point:
    """Return the coarsest rung within a degree, the finest if there is none."""
    sold = offers(ladder, "turn_deg", steps=True)
    within = [offer.point for offer in sold if offer.error <= ONE_DEGREE]
    return within[0] if reached else ladder[-1]


def hard_command(point: Point) -> str:
    """Return what runs a case of a scene that the study wrote beside its report."""
    name = point.case.scene.name
    return point.case.command().replace(name, f"scenes/{name}.toml", 1)


def exponents(cost: Cost) -> dict[tuple[str, str], Exponent]:
    """Return the exponent of the cost of a degree, by engine and kind of step.

    Costs that are but bounds count where there are not two others.
    """
    ladders: dict[tuple[str, str], list[tuple[float, float, bool]]] = {}
    for row in hard_rows(cost):
        if row["cost_s_s"] is not None:
            seen = float(row["epsilon"]), float(row["cost_s_s"]), bool(row["at_most"])  # type: ignore[arg-type]
            ladders.setdefault((str(row["engine"]), str(row["steps"])), []).append(seen)
    found = {}
    for key, rows in ladders.items():
        sure = [row for row in rows if not row[2]]
        used = sure if len(sure) > 1 else rows
        found[key] = exponent([row[0] for row in used], [row[1] for row in used])
    return {key: value for key, value in found.items() if value is not None}


def hardness(cost: Cost) -> Table:
    """Return the table of costs against hardness."""
    return Table(
        name=f"{cost.plan.scene.name}-degree",
        title="What one degree costs as the bounce gets harder",
        frame=pd.DataFrame(hard_rows(cost), columns=list(_ROWS)),
        columns=_ROWS,
        scene=cost.plan.scene.name,
    )


def growth(cost: Cost) -> Table:
    """Return the table of exponents."""
    rows = [
        {
            "engine": engine,
            "steps": steps,
            "exponent": found.exponent,
            "confidence": None if found.points < 3 else found.confidence,  # noqa: PLR2004
            "points": found.points,
        }
        for (engine, steps), found in exponents(cost).items()
    ]
    return Table(
        name=f"{cost.plan.scene.name}-exponents",
        title="How the cost of a degree grows",
        frame=pd.DataFrame(rows, columns=list(_EXPONENTS)),
        columns=_EXPONENTS,
        scene=cost.plan.scene.name,
    )
