"""From the runs of an effects study to verdicts, and from those to artefacts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.artefact import Artefact, Prose
from harness.case import Case
from harness.runner import Evaluation
from harness.studies.effects.figure import bars
from harness.studies.effects.plan import Plan
from harness.studies.effects.price import Price, Times, price
from harness.studies.effects.tables import effect_table, factor_table, run_table
from harness.studies.effects.verdict import Effect, effect
from harness.studies.effects.words import sentences
from models.effects import KINDS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Study:
    """A plan with its runs and what they say.

    Parameters
    ----------
    plan : Plan
    evaluations : mapping of Case to Evaluation
    effects : tuple of Effect
        Each effect in each engine.
    prices : mapping of (engine, effect) to Price
    sentences : tuple of str
    """

    plan: Plan
    evaluations: Mapping[Case, Evaluation]
    effects: tuple[Effect, ...]
    prices: Mapping[tuple[str, str], Price]
    sentences: tuple[str, ...]


def study(made: Plan, evaluations: Sequence[Evaluation], times: Times) -> Study:
    """Return what the runs of a plan say.

    Parameters
    ----------
    made : Plan
    evaluations : sequence of Evaluation
        Of the plan's cases, in any order.
    times : mapping of Case to what was measured alone
        May lack cases: their ratio of processor times is then not known.
    """
    found = {e.simulation.case: e for e in evaluations}
    effects = tuple(effect(made, found, mover, name) for mover in made.engines for name in KINDS)
    own = made.declared
    prices = {
        (one.mover, one.name): price(
            made, found, times, one.mover, (own | {one.name}, own - {one.name})
        )
        for one in effects
    }
    return Study(
        plan=made,
        evaluations=found,
        effects=effects,
        prices=prices,
        sentences=sentences(made, effects),
    )


def read(found: Study) -> tuple[Artefact, ...]:
    """Return the artefacts of a study: words, figure, tables."""
    made = found.plan
    artefacts: list[Artefact] = [
        Prose(
            name=f"{made.scene.name}-effects-words",
            title="Which effects the scene calls for",
            text=" ".join(found.sentences),
            scene=made.scene.name,
        ),
        bars(made, found.evaluations, found.effects),
        effect_table(made, found.evaluations, found.effects, found.prices),
    ]
    factors = factor_table(made, found.effects)
    if factors is not None:
        artefacts.append(factors)
    artefacts.append(run_table(made, found.evaluations))
    return tuple(artefacts)
