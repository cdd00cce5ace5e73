"""What an effect is to a scene, in one word, from how much it changes."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.engines.registry import engine
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES
from harness.studies.effects.changes import CHANGED, COUNTS
from harness.studies.effects.plan import EffectsPlan, Subset, case


class EffectStatus(Enum):
    """The value is what tables say."""

    NEEDED = "needed"
    HARMLESS = "harmless"
    MISSING = "missing"
    IMPOSED = "imposed by the engine"
    UNSUPPORTED = "unsupported"
    CONTRADICTED = "contradicts another effect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """What one effect does in one engine.

    Parameters
    ----------
    mover, name : str
    declared : bool
    verdict : Verdict
    why : str
        A sentence with the number behind the verdict.
    changes : mapping of str to float or None
        By quantity: with the effect less without it, all others as the scene declares them.
    alone : mapping of str to float or None
        The same with no other effect; empty for one that is not declared.
    mean : mapping of str to float or None
        The same over every subset of the other declared effects; empty where they are not all run.
    """

    mover: str
    name: str
    declared: bool
    verdict: EffectStatus
    why: str
    changes: Mapping[str, float | None]
    alone: Mapping[str, float | None]
    mean: Mapping[str, float | None]


Evaluations = Mapping[Case, Evaluation]


def effect(made: EffectsPlan, found: Evaluations, mover: str, name: str) -> Effect:
    """Return what an effect does in an engine."""
    own = made.declared
    declared = name in own
    with_it, without = (own, own - {name}) if declared else (own | {name}, own)
    changes = change(made, found, mover, with_it, without)
    alone: Mapping[str, float | None] = {}
    mean: Mapping[str, float | None] = {}
    if declared:
        alone = change(made, found, mover, frozenset((name,)), frozenset())
        mean = _mean(made, found, mover, name) if made.factorial else {}
    verdict, why = _judged(made, found, mover, name, changes)
    return Effect(
        mover=mover,
        name=name,
        declared=declared,
        verdict=verdict,
        why=why,
        changes=changes,
        alone=alone,
        mean=mean,
    )


def evaluation(
    made: EffectsPlan, found: Evaluations, mover: str, subset: Subset
) -> Evaluation | None:
    """Return the run of an engine under a set of effects, if there is one."""
    chosen = case(made, mover, subset)
    return None if chosen is None else found[chosen]


def change(
    made: EffectsPlan, found: Evaluations, mover: str, with_it: Subset, without: Subset
) -> dict[str, float | None]:
    """Return by how much each quantity differs between two sets of effects."""
    one, other = (evaluation(made, found, mover, subset) for subset in (with_it, without))
    if one is None or other is None:
        return {}
    pairs = ((q.key, q.of_run(one), q.of_run(other)) for q in CHANGED)
    return {key: None if a is None or b is None else a - b for key, a, b in pairs}


def _mean(made: EffectsPlan, found: Evaluations, mover: str, name: str) -> dict[str, float | None]:
    """Return the main effect of a factor: its change, averaged over all sets of the others."""
    others = sorted(made.declared - {name})
    rests = [
        frozenset(other for bit, other in enumerate(others) if number >> bit & 1)
        for number in range(2 ** len(others))
    ]
    each = [change(made, found, mover, rest | {name}, rest) for rest in rests]
    means: dict[str, float | None] = {}
    for quantity in CHANGED:
        known = [value for one in each if (value := one.get(quantity.key)) is not None]
        means[quantity.key] = sum(known) / len(known) if len(known) == len(each) else None
    return means


def _judged(
    made: EffectsPlan,
    found: Evaluations,
    mover: str,
    name: str,
    changes: Mapping[str, float | None],
) -> tuple[EffectStatus, str]:
    """Return the verdict and the number behind it."""
    own, able = made.declared, engine(mover).capabilities
    if name not in own and name in able.imposes:
        return EffectStatus.IMPOSED, f"It cannot be removed: {able.imposes[name]}."
    if name not in able.honours:
        return EffectStatus.UNSUPPORTED, f"{mover} cannot represent it."
    if evaluation(made, found, mover, own) is None:
        return EffectStatus.UNSUPPORTED, f"{mover} cannot represent what the scene declares."
    if not changes:
        return (
            EffectStatus.CONTRADICTED,
            "It cannot be there together with what the scene declares.",
        )
    return _weighed(made, found, mover, name, changes)


def _weighed(
    made: EffectsPlan,
    found: Evaluations,
    mover: str,
    name: str,
    changes: Mapping[str, float | None],
) -> tuple[EffectStatus, str]:
    """Return the verdict on an effect that is run both ways: by how it ends, then by how much."""
    own = made.declared
    matters = EffectStatus.NEEDED if name in own else EffectStatus.MISSING
    ends = [
        e.simulation.outcome
        for subset in (own | {name}, own - {name})
        if (e := evaluation(made, found, mover, subset)) is not None
    ]
    if Outcome.MISMATCH in ends:
        return EffectStatus.UNSUPPORTED, f"What {mover} compiles of it is not what is declared."
    if ends[0] is not ends[-1]:
        return matters, f"With it the run is {_short(ends[0])}, without it {_short(ends[-1])}."
    over, worst = 0.0, "It changes nothing that is known."
    for quantity in CHANGED:
        value = changes[quantity.key]
        if value is None:
            continue
        least = threshold(made, found, mover, quantity.key)
        if abs(value) / least > over:
            over = abs(value) / least
            worst = (
                f"It changes the {quantity.label} by {value:.3g} ({quantity.key}); "
                f"what counts is {least:.2g}."
            )
    return (matters if over > 1.0 else EffectStatus.HARMLESS), worst


def threshold(made: EffectsPlan, found: Evaluations, mover: str, key: str) -> float:
    """Return the change of a quantity that counts: no less than the engine's own error."""
    quantity = QUANTITIES[key]
    least = COUNTS[key] * made.tolerance
    mine, exact = (
        (evaluation(made, found, one, made.declared) for one in (mover, "reference"))
        if "reference" in made.engines
        else (None, None)
    )
    if mine is None or exact is None:
        return least
    a, b = quantity.of_run(mine), quantity.of_run(exact)
    return least if a is None or b is None else max(least, abs(a - b))


def _short(outcome: Outcome) -> str:
    """Return an outcome's first words."""
    return outcome.value.partition(":")[0]
