"""The three errors in plain sentences, made from the numbers."""

from collections.abc import Mapping

from harness.studies.errors.ensemble import SIZES
from harness.studies.errors.plan import Plan
from harness.studies.errors.quantities import Number, Quantity, quantities
from harness.studies.errors.split import Split
from harness.studies.errors.spread import Spread


def sentences(
    plan: Plan,
    splits: Mapping[tuple[str, str], Split],
    spreads: Mapping[tuple[str, float], Spread],
) -> tuple[str, ...]:
    """Return a sentence or two a way, and one on what is not decidable."""
    told = []
    quantity = next(
        (
            q
            for q in quantities(plan.scene)
            if all(splits[way.name, q.key].total is not None for way in plan.ways)
        ),
        None,
    )
    if quantity is None:
        nothing = (
            f"{plan.engine} completes no motion of {plan.scene.name} at {plan.probe:.2g} s that "
            "could be compared, so that its errors cannot be told apart."
        )
        return (nothing,)
    for way in plan.ways:
        told += _way(plan, way.name, quantity, splits[way.name, quantity.key])
    told.append(_undecidable(quantity, spreads))
    return tuple(told)


def _way(plan: Plan, name: str, quantity: Quantity, found: Split) -> list[str]:
    """Return the three errors on one way."""
    parts = [
        f"model form {_amount(quantity, found.model_form)}"
        + (
            f" (known to {_amount(quantity, found.limit.uncertainty, sign=False)})"
            if found.limit
            else ""
        ),
        f"discretisation {_amount(quantity, found.discretisation)}",
        f"solver {_amount(quantity, found.solver)}",
    ]
    opening = (
        f"{plan.engine}, {name}, at a timestep of {plan.probe:.2g} s: the {quantity.words} of "
        f"{plan.scene.name} is off by {_amount(quantity, found.total)}, of which "
        f"{', '.join(parts)}."
    )
    order = None if found.limit is None else found.limit.order
    approach = (
        "no order is seen on the way to its limit"
        if order is None
        else f"it approaches its limit with order {order:.2f}{_give_or_take(found)}"
    )
    return [
        opening,
        {
            "model error": f"However small the timestep, this is another can: {approach}.",
            "no model error seen": f"For a timestep of zero no model error is seen; {approach}.",
            "undecidable": f"That is less than releases spread that differ by 1e-6; {approach}.",
            "unknown": "Its limit is not known.",
        }[found.verdict],
    ]


def _give_or_take(found: Split) -> str:
    """Return how far the observed orders spread."""
    spread = None if found.limit is None else found.limit.spread
    return "" if spread is None else f", give or take {spread:.2f}"


def _undecidable(quantity: Quantity, spreads: Mapping[tuple[str, float], Spread]) -> str:
    """Return how far releases spread that no one can tell apart."""
    small, large = spreads[quantity.key, SIZES[0]], spreads[quantity.key, SIZES[-1]]
    return (
        f"Releases that differ by {SIZES[-1]:.0e} spread the {quantity.words} by "
        f"{_amount(quantity, large.of_truth, sign=False)} in the exact motion and by "
        f"{_amount(quantity, large.of_engine, sign=False)} in the engine (by "
        f"{_amount(quantity, small.of_truth, sign=False)} and "
        f"{_amount(quantity, small.of_engine, sign=False)} for {SIZES[0]:.0e}): a discrepancy "
        "smaller than that is not decidable."
    )


def _amount(quantity: Quantity, value: Number, *, sign: bool = True) -> str:
    if value is None:
        return "an unknown amount"
    number = f"{value:+.2g}" if sign else f"{value:.2g}"
    return f"{number} {quantity.unit}".rstrip()
