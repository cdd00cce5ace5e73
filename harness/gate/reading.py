"""From differences to artefacts: the sentences, a figure of all factors, the table."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from harness.artefact import Artefact, Figure, Panel, Prose, Series, Table
from harness.gate.comparison import FACTOR, SPREADS, Change, Difference
from harness.gate.quantities import QUANTITIES, Kind
from harness.gate.scores import Scores
from harness.gate.words import Wording, changed, sentences

SHOWN = ("scene", "engine", "profile", "timestep_s", "quantity")


def read(
    found: Sequence[Difference],
    first: Scores,
    second: Scores,
    wording: Wording,
    spreads: Scores | None = None,
) -> tuple[Artefact, ...]:
    """Return the artefacts of a comparison; the text opens the report."""
    text = "\n\n".join(sentences(found, first, second, wording, spreads))
    figure = factors(found, wording)
    return (
        Prose(name="summary", title="Against accepted results", text=text),
        *((figure,) if figure else ()),
        table(found, wording),
    )


def table(found: Sequence[Difference], wording: Wording) -> Table:
    """Return the table of all differences, what has changed first."""
    first = changed(found)
    names = {id(one) for one in first}
    rest = [one for one in found if id(one) not in names]
    columns = {
        "scene": "Name of the scene.",
        "engine": "Name of the engine.",
        "profile": "default: as it ships; matched: what the scene declares; adaptive: own steps.",
        "timestep_s": "Timestep that was asked for; empty for the profile's own.",
        "options": "Settings of the suite on top of the profile.",
        "quantity": "What is compared: a column of the table of results, or the outcome.",
        wording.first: "Its magnitude there.",
        wording.second: "Its magnitude here.",
        "spread": "Largest departure among releases that differ by 1e-9 or less.",
        "tolerance": f"How much may differ: {SPREADS:g} spreads, and what round-off alone makes.",
        "factor": f"{wording.second} over {wording.first}.",
        "verdict": f"Judged by the tolerance and by a factor of {FACTOR:g}.",
        "note": "What the numbers do not say.",
        "case": "Digest of the case that made the number.",
    }
    frame = pd.DataFrame([_row(one, wording) for one in (*first, *rest)], columns=list(columns))
    return Table(
        name="gate",
        title="Quantity by quantity, what has changed first",
        frame=frame,
        columns=columns,
        shown=(
            *SHOWN,
            wording.first,
            wording.second,
            "tolerance",
            "factor",
            "verdict",
            "note",
            "case",
        ),
    )


def _row(one: Difference, wording: Wording) -> dict[str, object]:
    name = one.identity
    return {
        "scene": name.scene,
        "engine": name.engine,
        "profile": name.profile,
        "timestep_s": name.timestep or None,
        "options": name.options,
        "quantity": one.quantity,
        wording.first: one.first,
        wording.second: one.second,
        "spread": one.spread,
        "tolerance": one.tolerance,
        "factor": one.factor,
        "verdict": wording.verdict(one),
        "note": one.note,
        "case": one.digest,
    }


def factors(found: Sequence[Difference], wording: Wording) -> Figure | None:
    """Return the figure of all factors, a panel an engine; None if nothing can be drawn."""
    drawn = [one for one in found if one.change is not Change.INFORMATION and _finite(one)]
    if not drawn:
        return None
    quantities = [q for q in QUANTITIES if q.kind is not Kind.TIME]
    places = {q.column: float(place) for place, q in enumerate(quantities)}
    panels = []
    for engine in dict.fromkeys(one.identity.engine for one in drawn):
        own = [one for one in drawn if one.identity.engine == engine]
        kinds = {
            Change.SAME: engine,
            Change.UNDECIDABLE: engine,
            Change.LARGER: wording.verdicts[Change.LARGER],
            Change.SMALLER: wording.verdicts[Change.SMALLER],
        }
        series = [_points(own, change, kind, places, wording) for change, kind in kinds.items()]
        panels.append(
            Panel(
                title=engine,
                x_label="quantity",
                y_label=f"{wording.second} over {wording.first}",
                series=tuple(one for one in series if len(one.x)),
                log_y=True,
                x_names=tuple(q.words for q in quantities),
            )
        )
    moved = [one for one in drawn if one.change in {Change.LARGER, Change.SMALLER}]
    extreme = max((one.severity for one in drawn), default=1.0)
    return Figure(
        name="gate-factors",
        title=f"Every quantity, {wording.second} over {wording.first}",
        seen=(
            f"A point is a quantity of a case; on the line of one it is as it was. {len(moved)} of "
            f"{len(drawn)} have moved by more than their tolerance and by more than a factor of "
            f"{FACTOR:g}; the largest factor, either way, is {extreme:.3g}."
        ),
        panels=tuple(panels),
        columns=1,
    )


def _finite(one: Difference) -> bool:
    """Whether a difference has a factor that can be drawn."""
    return one.factor is not None and 0.0 < one.factor < math.inf


def _points(
    own: Sequence[Difference],
    change: Change,
    kind: str,
    places: dict[str, float],
    wording: Wording,
) -> Series:
    """Return the points of one verdict."""
    chosen = [one for one in own if one.change is change]
    return Series(
        label=wording.verdicts[change],
        kind=kind,
        x=np.array([places[one.quantity] for one in chosen]),
        y=np.array([one.factor for one in chosen], dtype=np.float64),
        mark="points",
        hover=tuple(one.identity.label() for one in chosen),
    )
