"""From the evaluations of a plan to the three errors, and from those to artefacts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.artefact import Artefact, Prose
from harness.case import Case
from harness.runner import Evaluation
from harness.studies.errors.ensemble import MEMBERS, SIZES
from harness.studies.errors.extrapolation import limit
from harness.studies.errors.figures import effort_figure, ensemble_figure, ladder_figure
from harness.studies.errors.plan import Plan, Way
from harness.studies.errors.quantities import Number, Quantity, quantities
from harness.studies.errors.split import Split, split
from harness.studies.errors.spread import Spread, spread
from harness.studies.errors.tables import effort_table, ensemble_table, ladder_table, split_table
from harness.studies.errors.words import sentences


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

    plan: Plan
    evaluations: Mapping[Case, Evaluation]
    spreads: Mapping[tuple[str, float], Spread]
    splits: Mapping[tuple[str, str], Split]
    sentences: tuple[str, ...]


def three_errors(plan: Plan, evaluations: Sequence[Evaluation]) -> ThreeErrors:
    """Return the three errors, from the evaluations of the plan's cases in any order."""
    found = {e.simulation.case: e for e in evaluations}
    known = quantities(plan.scene)
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
    plan: Plan, found: Mapping[Case, Evaluation], quantity: Quantity, size: float
) -> Spread:
    """Return how far perturbed releases of one size spread."""
    members = [found[plan.member(size, number)] for number in range(MEMBERS)]
    return spread(
        _both(found[plan.tried(plan.ways[0], None)], quantity),
        [_both(e, quantity) for e in members],
    )


def _both(e: Evaluation, quantity: Quantity) -> tuple[Number, Number]:
    return quantity.found(e), quantity.true(e)


def _split(
    plan: Plan,
    found: Mapping[Case, Evaluation],
    way: Way,
    quantity: Quantity,
    spreads: Mapping[tuple[str, float], Spread],
) -> Split:
    """Return the three errors of one quantity on one way."""
    ladder = [quantity.found(found[plan.on_ladder(way, step)]) for step in plan.timesteps]
    own = found[plan.tried(way, None)]
    return split(
        true=quantity.true(own),
        value=quantity.found(own),
        converged=quantity.found(found[plan.on_ladder(way, plan.probe)]),
        # releases that differ by no more than a few roundings show how much of a value is noise
        limit=limit(plan.timesteps, ladder, noise=spreads[quantity.key, SIZES[0]].of_error or 0.0),
        band=spreads[quantity.key, SIZES[-1]].band,
    )


def read(found: ThreeErrors) -> tuple[Artefact, ...]:
    """Return the artefacts: words, figures, tables."""
    plan, known = found.plan, quantities(found.plan.scene)
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
