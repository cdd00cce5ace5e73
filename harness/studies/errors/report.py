"""From the evaluations of a plan to the three errors, and from those to artefacts.

The three errors in plain sentences, made from the numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.report_model import Artefact, Prose
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, Number, Quantity
from harness.studies.errors.extrapolation import limit
from harness.studies.errors.figures import effort_figure, ensemble_figure, ladder_figure
from harness.studies.errors.plan import ErrorsPlan, Way
from harness.studies.errors.split import Split, Spread, split, spread
from harness.studies.errors.tables import effort_table, ensemble_table, ladder_table, split_table
from harness.studies.shared.perturbation import MEMBERS, SIZES


def sentences(
    plan: ErrorsPlan,
    splits: Mapping[tuple[str, str], Split],
    spreads: Mapping[tuple[str, float], Spread],
) -> tuple[str, ...]:
    """Return a sentence or two a way, and one on what is not decidable."""
    told = []
    quantity = next(
        (
            q
            for q in _quantities(plan)
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


_OF_THE_BOUNCE = ("turn_deg", "bounce_time_s", "phi_min_rad", "peak_friction_ratio")
_OF_THE_END = ("psi_end_deg", "phi_end_deg")


def _quantities(plan: ErrorsPlan) -> tuple[Quantity, ...]:
    """Return the numbers of a run that have a limit: of its first bounce, or of its end."""
    keys = _OF_THE_BOUNCE if plan.scene.horizon.seconds is None else _OF_THE_END
    return tuple(QUANTITIES[key] for key in keys)


def _way(plan: ErrorsPlan, name: str, quantity: Quantity, found: Split) -> list[str]:
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
        f"{plan.engine}, {name}, at a timestep of {plan.probe:.2g} s: the {quantity.label} of "
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
        f"Releases that differ by {SIZES[-1]:.0e} spread the {quantity.label} by "
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThreeErrors:
    """A plan with its evaluations and what they say.

    Parameters
    ----------
    plan : Plan
    evaluations : mapping of Case to Evaluation
    spreads : mapping of (str, float) to Spread
        By quantity and relative size of the perturbations.
    splits : mapping of (str, str) to Split
        By way and quantity.
    sentences : tuple of str
    """

    plan: ErrorsPlan
    evaluations: Mapping[Case, Evaluation]
    spreads: Mapping[tuple[str, float], Spread]
    splits: Mapping[tuple[str, str], Split]
    sentences: tuple[str, ...]


def three_errors(plan: ErrorsPlan, evaluations: Sequence[Evaluation]) -> ThreeErrors:
    """Return the three errors, from the evaluations of the plan's cases in any order."""
    found = {e.simulation.case: e for e in evaluations}
    known = _quantities(plan)
    spreads = {(q.key, size): _spread(plan, found, q, size) for q in known for size in SIZES}
    splits = {
        (way.name, q.key): _split(plan, found, way, q, spreads) for way in plan.ways for q in known
    }
    return ThreeErrors(
        plan=plan,
        evaluations=found,
        spreads=spreads,
        splits=splits,
        sentences=sentences(plan, splits, spreads),
    )


def _spread(
    plan: ErrorsPlan, found: Mapping[Case, Evaluation], quantity: Quantity, size: float
) -> Spread:
    """Return how far perturbed releases of one size spread."""
    members = [found[plan.member(size, number)] for number in range(MEMBERS)]
    return spread(
        _both(found[plan.tried(plan.ways[0], None)], quantity),
        [_both(e, quantity) for e in members],
    )


def _both(e: Evaluation, quantity: Quantity) -> tuple[Number, Number]:
    return quantity.of_run(e), quantity.of_truth(e)


def _split(
    plan: ErrorsPlan,
    found: Mapping[Case, Evaluation],
    way: Way,
    quantity: Quantity,
    spreads: Mapping[tuple[str, float], Spread],
) -> Split:
    """Return the three errors of one quantity on one way."""
    ladder = [quantity.of_run(found[plan.on_ladder(way, step)]) for step in plan.timesteps]
    own = found[plan.tried(way, None)]
    return split(
        true=quantity.of_truth(own),
        value=quantity.of_run(own),
        converged=quantity.of_run(found[plan.on_ladder(way, plan.probe)]),
        # releases that differ by no more than a few roundings show how much of a value is noise
        limit=limit(plan.timesteps, ladder, noise=spreads[quantity.key, SIZES[0]].of_error or 0.0),
        band=spreads[quantity.key, SIZES[-1]].band,
    )


def errors_report(found: ThreeErrors) -> tuple[Artefact, ...]:
    """Return the artefacts: words, figures, tables."""
    plan, known = found.plan, _quantities(found.plan)
    figures = (
        ladder_figure(plan, found.evaluations, found.splits, known),
        effort_figure(plan, found.evaluations, known),
        ensemble_figure(plan, found.spreads, known),
    )
    return (
        Prose(
            name=f"{plan.scene.name}-{plan.engine}-three-errors",
            title=f"Three errors of {plan.engine}, never mixed",
            text=" ".join(found.sentences),
            scene=plan.scene.name,
        ),
        *(figure for figure in figures if figure is not None),
        split_table(plan, found.splits, known),
        ladder_table(plan, found.evaluations, found.splits, known),
        effort_table(plan, found.evaluations, known),
        ensemble_table(plan, found.spreads, known),
    )
