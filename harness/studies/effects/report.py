"""From the runs of an effects study to verdicts, and from those to artefacts.

The effects study in words: what the scene needs, what it lacks, what engines add.

The effects study in a figure: how much each effect changes, over the change that counts.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Artefact, Figure, Panel, Prose, Series
from harness.evaluation.evaluation import Evaluation
from harness.studies.effects.changes import CHANGED, EffectCost, Times, price
from harness.studies.effects.plan import EffectsPlan
from harness.studies.effects.tables import effect_table, factor_table, run_table
from harness.studies.effects.verdict import Effect, EffectStatus, effect, threshold
from models.effects import KINDS

_KNOWN = frozenset({EffectStatus.NEEDED, EffectStatus.HARMLESS, EffectStatus.MISSING})


def sentences(made: EffectsPlan, effects: tuple[Effect, ...]) -> tuple[str, ...]:
    """Return a sentence on what is declared, one on what is not, and one for each engine."""
    first = [one for one in effects if one.mover == made.engines[0]]
    said = []
    declared = [one for one in first if one.declared]
    if declared:
        told = "; ".join(f"{one.name} is {one.verdict.value}" for one in declared)
        said.append(f"Of what {made.scene.name} declares: {told}.")
    else:
        said.append(f"{made.scene.name} declares no effect, and none is simulated.")
    missing = [one for one in _first_known(effects) if one.verdict is EffectStatus.MISSING]
    if missing:
        worst = "; ".join(f"{one.name} (by {one.mover}: {_lower(one.why)})" for one in missing)
        said.append(
            f"Not declared, though at the strength assumed they change the outcome: {worst}."
        )
    else:
        said.append("Nothing that is left out would change the outcome.")
    nobody = [name for name in KINDS if name not in {one.name for one in _first_known(effects)}]
    if nobody:
        said.append(f"None of these engines can tell what these would do: {', '.join(nobody)}.")
    for mover in made.engines:
        own = [
            one.name
            for one in effects
            if one.mover == mover and one.verdict is EffectStatus.IMPOSED
        ]
        if own:
            said.append(
                f"{mover} adds of its own accord, and it cannot be removed: {', '.join(own)}."
            )
    return tuple(said)


def _first_known(effects: tuple[Effect, ...]) -> list[Effect]:
    """Return of each effect what the first engine says that can tell."""
    found: dict[str, Effect] = {}
    for one in effects:
        if one.verdict in _KNOWN:
            found.setdefault(one.name, one)
    return list(found.values())


def _lower(sentence: str) -> str:
    """Return a sentence as a part of another."""
    return sentence[0].lower() + sentence[1:].rstrip(".")


_LEAST = 1e-6
"""Change over what counts below which a bar would be longer than the axis is worth."""


def bars(
    made: EffectsPlan, found: Mapping[Case, Evaluation], effects: tuple[Effect, ...]
) -> Figure:
    """Return the largest change of each effect, in units of the change that counts."""
    names = tuple(KINDS)
    series = []
    for place, mover in enumerate(made.engines):
        own = {one.name: one for one in effects if one.mover == mover}
        heights = [_height(made, found, own[name]) for name in names]
        shift = 0.8 * ((place + 0.5) / len(made.engines) - 0.5)
        series.append(
            Series(
                label=mover,
                kind=mover,
                x=np.arange(len(names), dtype=np.float64) + shift,
                y=np.array(heights),
                mark="points",
                hover=tuple(
                    f"{name}: {own[name].verdict.value}. {own[name].why}" for name in names
                ),
            )
        )
    series.append(
        Series(
            label="what counts",
            kind="truth",
            x=np.array((-0.5, len(names) - 0.5)),
            y=np.ones(2),
            dashed=True,
        )
    )
    return Figure(
        name=f"{made.scene.name}-effect-changes",
        title="What each effect changes",
        seen=_seen(made, effects),
        panels=(
            Panel(
                title="Largest change of any quantity, over the change that counts",
                x_label="effect",
                y_label="change over what counts []",
                x_names=tuple(
                    f"{name} (declared)" if name in made.declared else name for name in names
                ),
                series=tuple(series),
                log_y=True,
            ),
        ),
        columns=1,
        scene=made.scene.name,
    )


def _height(made: EffectsPlan, found: Mapping[Case, Evaluation], one: Effect) -> float:
    """Return the largest change of an effect over what counts; NaN where none is known."""
    shares = [
        abs(value) / threshold(made, found, one.mover, quantity.key)
        for quantity in CHANGED
        if (value := one.changes.get(quantity.key)) is not None
    ]
    return max(*shares, _LEAST) if shares else math.nan


def _seen(made: EffectsPlan, effects: tuple[Effect, ...]) -> str:
    """Return in two sentences which effects count and which do not."""
    own = [one for one in effects if one.mover == made.engines[0]]
    counts = [one.name for one in own if one.verdict.value in {"needed", "missing"}]
    nothing = [one.name for one in own if one.verdict.value == "harmless"]
    return (
        f"By {made.engines[0]}, above the dashed line lie {', '.join(counts) or 'no effects'}: at "
        "the strength declared or assumed they change the outcome. Below it lie "
        f"{', '.join(nothing) or 'none'}, which cost time and change nothing that counts."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EffectsResults:
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

    plan: EffectsPlan
    evaluations: Mapping[Case, Evaluation]
    effects: tuple[Effect, ...]
    prices: Mapping[tuple[str, str], EffectCost]
    sentences: tuple[str, ...]


def effects_results(
    made: EffectsPlan, evaluations: Sequence[Evaluation], times: Times
) -> EffectsResults:
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
    return EffectsResults(
        plan=made,
        evaluations=found,
        effects=effects,
        prices=prices,
        sentences=sentences(made, effects),
    )


def effects_report(found: EffectsResults) -> tuple[Artefact, ...]:
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
