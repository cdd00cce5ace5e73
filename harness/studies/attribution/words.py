"""The attribution in two sentences, made from the numbers."""

from collections.abc import Mapping

from harness.case import Case
from harness.runner import Evaluation
from harness.studies.attribution.accounts import Account, Level, total
from harness.studies.attribution.path import Path
from harness.studies.attribution.quantities import QUANTITIES, Quantity, uncounted

_NOTHING = 1e-6
"""Share of the largest discrepancy on the way below which a gap takes away nothing."""

_HARDLY = 0.01
"""Share of the whole below which an interaction is not worth a word."""


def sentences(
    way: Path, evaluations: Mapping[Case, Evaluation], accounts: Mapping[str, Account]
) -> tuple[str, str]:
    """Return two sentences on the first quantity whose whole is known."""
    lost = uncounted(evaluations.values())
    doubt = _doubt(lost, len(evaluations), accounts) if lost else ""
    for quantity in QUANTITIES:
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
    quantity = QUANTITIES[0]
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


def _in_order(way: Path, quantity: Quantity, found: Account) -> str:
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
        f"{quantity.words} of {way.scene.name}, and matched, at a timestep of "
        f"{way.matched_timestep:.2g} s, by {_amount(quantity, found.remains)}; closing the gaps in "
        f"the order {', '.join(way.names)} takes away, largest first: {told}"
    )


def _together(way: Path, quantity: Quantity, found: Account) -> str:
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
    number = f"{value * quantity.scale:+.3g}"
    return f"{number} {quantity.unit}".rstrip() if unit else number
