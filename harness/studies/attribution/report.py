"""From the evaluations of a path to accounts, and from those to artefacts.

The attribution in two sentences, made from the numbers.

The attribution in a waterfall: from the engine as it ships down to what remains.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Artefact, Figure, Panel, Prose, Series
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import Quantity
from harness.studies.attribution.ablation import (
    AblationPath,
    Account,
    Closed,
    Level,
    account,
    case,
    total,
)
from harness.studies.attribution.tables import (
    ATTRIBUTED,
    gap_table,
    interaction_table,
    run_table,
    uncounted,
)

_NOTHING = 1e-6
"""Share of the largest discrepancy on the way below which a gap takes away nothing."""

_HARDLY = 0.01
"""Share of the whole below which an interaction is not worth a word."""


def sentences(
    way: AblationPath, evaluations: Mapping[Case, Evaluation], accounts: Mapping[str, Account]
) -> tuple[str, str]:
    """Return two sentences on the first quantity whose whole is known."""
    lost = uncounted(evaluations.values())
    doubt = _doubt(lost, len(evaluations), accounts) if lost else ""
    for quantity in ATTRIBUTED:
        found = accounts[quantity.key]
        if found.whole is not None:
            return (
                _in_order(way, quantity, found) + doubt + ".",
                _together(way, quantity, found) + ".",
            )
    ends = sorted({e.simulation.outcome.name.lower() for e in evaluations.values()})
    nothing = (
        f"Nothing of what {way.engine} does to {way.scene.name} can be attributed, because one end "
        "of the way has no motion to compare."
    )
    return nothing, f"The runs ended: {', '.join(ends)}."


def _doubt(lost: int, runs: int, accounts: Mapping[str, Account]) -> str:
    """Return in how many runs the turn is not known, and what is known of it all the same."""
    quantity = ATTRIBUTED[0]
    found = accounts[quantity.key]
    known = [
        (abs(value), name, value)
        for name, value in zip(found.names, found.in_order, strict=True)
        if value is not None
    ]
    told = f" (the turn cannot be counted in {lost} of {runs} runs"
    if known and found.whole is None:
        _, name, value = max(known)
        told += f"; where it can, most is taken away by {name}, {_amount(quantity, value)}"
    return told + ")"


def _in_order(way: AblationPath, quantity: Quantity, found: Account) -> str:
    """Return what each gap takes away, largest first."""
    parts = sorted(
        zip(way.names, found.in_order, strict=True),
        key=lambda part: -abs(part[1]) if part[1] is not None else 0.0,
    )
    least = _NOTHING * max(abs(value) for value in found.levels if value is not None)
    told = "; ".join(
        f"{name} nothing"
        if value is not None and abs(value) <= least
        else f"{name} {_amount(quantity, value, unit=False)}"
        for name, value in parts
    )
    return (
        f"As it ships, {way.engine} is off by {_amount(quantity, found.shipped)} in the "
        f"{quantity.label} of {way.scene.name}, and matched, at a timestep of "
        f"{way.matched_timestep:.2g} s, by {_amount(quantity, found.remains)}; closing the gaps in "
        f"the order {', '.join(way.names)} takes away, largest first: {told}"
    )


def _together(way: AblationPath, quantity: Quantity, found: Account) -> str:
    """Return how far the gaps alone are from the whole, and which gap is behind it most."""
    whole, alone, interaction = found.whole, total(found.alone), found.interaction
    if whole is None or alone is None or interaction is None:
        unknown = ", ".join(
            name for name, value in zip(way.names, found.alone, strict=True) if value is None
        )
        return (
            f"Together they take away {_amount(quantity, whole)}; how they interact is not known, "
            f"because the discrepancy with one gap closed alone is not, for {unknown}"
        )
    opening = (
        f"Closed one by one from the engine as it ships, they add up to {_amount(quantity, alone)}"
    )
    if abs(interaction) <= _HARDLY * abs(whole):
        return f"{opening}, the whole to within {_HARDLY:.0%}, so that they hardly interact"
    told = (
        f"{opening}, where the whole is {_amount(quantity, whole)}: an interaction of "
        f"{_amount(quantity, interaction)}"
    )
    shifts = [
        (abs(late - early), name, early, late)
        for name, early, late in zip(way.names, found.alone, found.in_order, strict=True)
        if early is not None and late is not None
    ]
    if not shifts:
        return told
    _, name, early, late = max(shifts)
    return (
        f"{told}, most of it in {name}, which takes away {_amount(quantity, early)} alone and "
        f"{_amount(quantity, late)} after those before it"
    )


def _amount(quantity: Quantity, value: Level, *, unit: bool = True) -> str:
    """Return a discrepancy in words; what is not known is said to be so."""
    if value is None:
        return "an unknown part"
    word, scale = _unit(quantity)
    number = f"{value * scale:+.3g}"
    return f"{number} {word}".rstrip() if unit else number


def _unit(quantity: Quantity) -> tuple[str, float]:
    """Return the unit in words and figures, and the factor from the unit of the column to it."""
    return {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}.get(quantity.unit, (quantity.unit, 1.0))


_PANELS = 4


def waterfall(
    way: AblationPath, evaluations: Mapping[Case, Evaluation], accounts: Mapping[str, Account]
) -> Figure:
    """Return the waterfall of the first quantities that are known anywhere on the way."""
    drawn = [
        quantity
        for quantity in ATTRIBUTED
        if any(level is not None for level in accounts[quantity.key].levels)
    ]
    return Figure(
        name=f"{way.scene.name}-{way.engine}-waterfall",
        title=f"From default to matched: {way.engine}",
        seen=_seen(way, evaluations),
        panels=tuple(_panel(way, quantity, accounts[quantity.key]) for quantity in drawn[:_PANELS]),
        scene=way.scene.name,
    )


def _panel(way: AblationPath, quantity: Quantity, found: Account) -> Panel:
    """Return the waterfall of one quantity."""
    levels = _numbers(found.levels, quantity)
    alone = _numbers(found.alone, quantity)
    places = np.arange(1.0, len(way.names) + 1.0)
    amounts = [_told(value, quantity) for value in found.in_order]
    word, _ = _unit(quantity)
    unit = f" [{word}]" if word else ""
    return Panel(
        title=quantity.label.capitalize(),
        x_label="gaps, closed from left to right",
        y_label=f"off by{unit}",
        x_names=("as shipped", *way.names, "matched"),
        series=(
            Series(
                label="discrepancy",
                kind=way.engine,
                x=np.array((0.0, len(way.names) + 1.0)),
                y=levels[[0, -1]],
                base=np.zeros(2),
                mark="bars",
            ),
            Series(
                label="taken away by a gap, in this order",
                kind=way.engine,
                x=places,
                y=levels[1:],
                base=levels[:-1],
                mark="bars",
                hover=tuple(map("{}: {}".format, way.names, amounts)),
            ),
            Series(
                label="where it would end if it took away as much as alone",
                kind="reference",
                x=places,
                y=levels[:-1] - alone,
                mark="points",
                hover=tuple(
                    f"{name}, alone: {_told(value, quantity)}"
                    for name, value in zip(way.names, found.alone, strict=True)
                ),
            ),
        ),
    )


def _numbers(values: Sequence[Level], quantity: Quantity) -> Floats:
    """Return values in the unit of the axis, NaN where they are not known."""
    _, scale = _unit(quantity)
    return np.array([math.nan if value is None else value * scale for value in values])


def _told(value: Level, quantity: Quantity) -> str:
    if value is None:
        return "not known"
    return f"takes away {_amount(quantity, value)}"


def _seen(way: AblationPath, evaluations: Mapping[Case, Evaluation]) -> str:
    """Return how to read the figure and what is missing in it."""
    lost = uncounted(evaluations.values())
    missing = (
        f"; bars that rest on the {lost} of {len(evaluations)} runs whose turn cannot be counted "
        "are left out"
        if lost
        else ""
    )
    return (
        f"Each bar is what closing one more gap takes away, from {way.engine} as it ships to "
        "matched. A mark off the end of its bar is interaction: alone, that gap takes away "
        f"another amount{missing}."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attribution:
    """A path with its evaluations and accounts.

    Parameters
    ----------
    path : Path
    evaluations : mapping of Case to Evaluation
    accounts : mapping of str to Account
        By the key of the quantity.
    sentences : tuple of str
        Two, in plain words.
    """

    path: AblationPath
    evaluations: Mapping[Case, Evaluation]
    accounts: Mapping[str, Account]
    sentences: tuple[str, ...]


def attribution(way: AblationPath, evaluations: Sequence[Evaluation]) -> Attribution:
    """Return who accounts for what, from the evaluations of the path's cases in any order."""
    found = {e.simulation.case: e for e in evaluations}
    accounts = {
        quantity.key: account(way.names, partial(_level, way, found, quantity))
        for quantity in ATTRIBUTED
    }
    return Attribution(
        path=way,
        evaluations=found,
        accounts=accounts,
        sentences=sentences(way, found, accounts),
    )


def _level(
    way: AblationPath,
    found: Mapping[Case, Evaluation],
    quantity: Quantity,
    closed: Closed,
) -> float | None:
    """Return a discrepancy with a set of gaps closed."""
    return quantity.of_run(found[case(way, closed)])


def attribution_report(found: Attribution) -> tuple[Artefact, ...]:
    """Return the artefacts of an attribution: words, figure, tables."""
    way = found.path
    return (
        Prose(
            name=f"{way.scene.name}-{way.engine}-attribution",
            title=f"What makes {way.engine} differ",
            text=" ".join(found.sentences),
            scene=way.scene.name,
        ),
        waterfall(way, found.evaluations, found.accounts),
        gap_table(way, found.accounts),
        interaction_table(way, found.accounts),
        run_table(way, found.evaluations, found.accounts),
    )
