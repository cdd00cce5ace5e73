"""Changes and costs of effects in the runs of a plan, and the verdict on each effect."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.engines.registry import engine, is_constraint
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, Number, less
from harness.studies.effects.plan import (
    FACTORS,
    HEIGHT,
    EffectsPlan,
    Subset,
    with_factor,
    without_factor,
)
from models.effects import KINDS, constants_of
from models.errors import ModelError

COUNTS = {
    "turn_deg": 1.0,
    "bounce_time_s": 1e-3,
    "peak_friction_ratio": 0.1,
    "phi_end_rad": 0.01,
    "x_end_m": 1e-3,
    "y_end_m": 1e-3,
}
"""Change of each quantity that counts, for each degree of turn that counts.

In the order in which words and figures take them.
"""

CHANGED = tuple(QUANTITIES[key] for key in COUNTS)
"""What an effect may change."""

Times = Mapping[Case, Mapping[str, Any]]
"""Records of `harness.evaluation.timing.time_alone` by case."""


class EffectStatus(Enum):
    """Verdict on an effect in a scene; tables show the value."""

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
    scene, engine, name : str
    declared : bool
    strength : str
        Constants of its law as `--assume` and a scene file know them.
    run : Simulation or None
        Of the scene with it; None if the engine cannot represent that.
    verdict : EffectStatus
    why : str
        A sentence with the number behind the verdict.
    changes : mapping of str to float or None
        By quantity: with the effect less without it, all others as the scene declares them.
    alone : mapping of str to float or None
        The same with no other effect; empty for one that is not declared.
    mean : mapping of str to float or None
        The same over every subset of the other declared effects; empty where they are not all run.
    cost : mapping of str to float or None
        `steps_ratio`, `constraint_rows_ratio`, `cpu_ratio`: with the effect over without it, each
        per simulated second, since an effect may end a run early; `cpu_spread`: largest over
        smallest processor time of the repeats, of the noisier of the two runs.
    """

    scene: str
    engine: str
    name: str
    declared: bool
    strength: str
    run: Simulation | None
    verdict: EffectStatus
    why: str
    changes: Mapping[str, Number]
    alone: Mapping[str, Number]
    mean: Mapping[str, Number]
    cost: Mapping[str, Number]


@dataclass(frozen=True, kw_only=True, eq=False)
class EffectsResults:
    """A plan with its runs, and each effect in each engine.

    Parameters
    ----------
    plan : EffectsPlan
    evaluations : mapping of Case to Evaluation
    times : mapping of Case to what was measured alone
        May lack cases: their ratio of processor times is then not known.
    """

    plan: EffectsPlan
    evaluations: Mapping[Case, Evaluation]
    times: Times

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Each effect in each engine."""
        return tuple(self._effect(name, kind) for name in self.plan.engines for kind in FACTORS)

    def of_engine(self, engine_name: str) -> tuple[Effect, ...]:
        """Return each effect in one engine."""
        return tuple(effect for effect in self.effects if effect.engine == engine_name)

    def evaluation(self, engine_name: str, subset: Subset) -> Evaluation | None:
        """Return the run of an engine under a set of effects, if there is one."""
        case = self.plan.case(engine_name, subset)
        return None if case is None else self.evaluations[case]

    def threshold(self, engine_name: str, key: str) -> float:
        """Return the change of a quantity that counts: no less than the engine's own error."""
        least = COUNTS[key] * self.plan.tolerance
        if "reference" not in self.plan.engines:
            return least
        declared = self.plan.declared
        own, exact = (self.evaluation(name, declared) for name in (engine_name, "reference"))
        if own is None or exact is None:
            return least
        error = less(QUANTITIES[key].of_run(own), QUANTITIES[key].of_run(exact))
        return least if error is None else max(least, abs(error))

    def _effect(self, engine_name: str, name: str) -> Effect:
        """Return changes, costs and verdict of an effect in an engine."""
        declared = self.plan.declared
        with_it = with_factor(declared, name)
        without = without_factor(with_it, name)
        changes = self._changes(engine_name, with_it, without)
        alone: Mapping[str, Number] = {}
        mean: Mapping[str, Number] = {}
        if name in declared:
            only = with_factor(frozenset(), name)
            alone = self._changes(engine_name, only, without_factor(only, name))
            mean = self._mean(engine_name, name) if self.plan.factorial else {}
        verdict, why = self._verdict(engine_name, name, changes)
        run = self.evaluation(engine_name, with_it)
        return Effect(
            scene=self.plan.scene.name,
            engine=engine_name,
            name=name,
            declared=name in declared,
            strength=self._strength(name),
            run=None if run is None else run.simulation,
            verdict=verdict,
            why=why,
            changes=changes,
            alone=alone,
            mean=mean,
            cost=self._cost(engine_name, with_it, without),
        )

    def _changes(self, engine_name: str, with_it: Subset, without: Subset) -> dict[str, Number]:
        """Return by how much each quantity differs; nothing if one of the two cannot be run."""
        one, other = (self.evaluation(engine_name, subset) for subset in (with_it, without))
        if one is None or other is None:
            return {}
        return {q.key: less(q.of_run(one), q.of_run(other)) for q in CHANGED}

    def _mean(self, engine_name: str, name: str) -> dict[str, Number]:
        """Return the main effect of a factor: its change, averaged over all sets of the others."""
        rests = self.plan.others(name)
        each = [self._changes(engine_name, rest | {name}, rest) for rest in rests]
        means: dict[str, Number] = {}
        for key in COUNTS:
            known = [value for changes in each if (value := changes.get(key)) is not None]
            means[key] = sum(known) / len(known) if len(known) == len(each) else None
        return means

    def _cost(self, engine_name: str, with_it: Subset, without: Subset) -> dict[str, Number]:
        """Return the costs of a run with the effect over those of the run without it."""
        cases = [self.plan.case(engine_name, subset) for subset in (with_it, without)]
        known = [case for case in cases if case is not None]
        if len(known) != len(cases):
            return {}
        runs = [self.evaluations[case] for case in known]
        repeats = [
            [s for s in self.times.get(case, {}).get("cpu_s", ()) if s > 0.0] for case in known
        ]
        least = [min(seconds, default=None) for seconds in repeats]
        return {
            "steps_ratio": _ratio(runs, [e.simulation.steps for e in runs]),
            "constraint_rows_ratio": _ratio(runs, [e.simulation.constraint_rows for e in runs]),
            "cpu_ratio": _ratio(runs, least),
            "cpu_spread": max((max(s) / min(s) for s in repeats if s), default=None),
        }

    def _verdict(
        self, engine_name: str, name: str, changes: Mapping[str, Number]
    ) -> tuple[EffectStatus, str]:
        """Return the verdict on an effect, and the number behind it."""
        declared, able = self.plan.declared, engine(engine_name).capabilities
        if name not in declared and name in able.imposes:
            return EffectStatus.IMPOSED, f"It cannot be removed: {able.imposes[name]}."
        able_to = not is_constraint(engine_name) if name == HEIGHT else name in able.honours
        if not able_to:
            return EffectStatus.UNSUPPORTED, f"{engine_name} cannot represent {name}."
        if self.evaluation(engine_name, declared) is None:
            why = f"{engine_name} cannot represent what the scene declares."
            return EffectStatus.UNSUPPORTED, why
        if not changes:
            return EffectStatus.CONTRADICTED, self._contradiction(name)
        return self._weighed(engine_name, name, changes)

    def _weighed(
        self, engine_name: str, name: str, changes: Mapping[str, Number]
    ) -> tuple[EffectStatus, str]:
        """Return the verdict on an effect that is run both ways: how it ends, then how much."""
        declared = self.plan.declared
        matters = EffectStatus.NEEDED if name in declared else EffectStatus.MISSING
        with_it = with_factor(declared, name)
        pair = (with_it, without_factor(with_it, name))
        runs = (self.evaluation(engine_name, subset) for subset in pair)
        ends = [e.simulation.outcome for e in runs if e is not None]
        if Outcome.MISMATCH in ends:
            why = f"What {engine_name} compiles of it is not what is declared."
            return EffectStatus.UNSUPPORTED, why
        if ends[0] is not ends[-1]:
            words = [outcome.value.partition(":")[0] for outcome in ends]
            return matters, f"With it the run is {words[0]}, without it {words[-1]}."
        over, worst = 0.0, "It changes nothing that is known."
        for quantity in CHANGED:
            value, least = changes[quantity.key], self.threshold(engine_name, quantity.key)
            if value is not None and abs(value) / least > over:
                over = abs(value) / least
                worst = (
                    f"It changes the {quantity.label} by {value:.3g} ({quantity.key}); "
                    f"what counts is {least:.2g}."
                )
        return (matters if over > 1.0 else EffectStatus.HARMLESS), worst

    def _contradiction(self, name: str) -> str:
        """Return why a factor cannot be there together with what the scene declares."""
        try:
            self.plan.scene_with(with_factor(self.plan.declared, name))
        except ModelError as error:
            return f"It cannot be there: {error}."
        return "Without it what the scene declares cannot be there."

    def _strength(self, name: str) -> str:
        """Return the constants of the law of a factor that are not zero."""
        if name not in KINDS and "." not in name:
            return f"{name} = {self.plan.strengths[name]:g}"
        effect = name.partition(".")[0]
        among = with_factor(frozenset() if effect != name else self.plan.declared, name)
        try:
            constants = constants_of(self.plan.law(effect, among))
        except ModelError:  # which the verdict tells
            constants = {name.partition(".")[2]: self.plan.strengths[name]}
        return ", ".join(
            f"{key} = {value if isinstance(value, str) else format(value, 'g')}"
            for key, value in constants.items()
            if value
        )


def _ratio(runs: Sequence[Evaluation], amounts: Sequence[Number]) -> Number:
    """Return an amount of work per simulated second of a first run over that of a second."""
    above, below = (
        None
        if e.motion is None or amount is None or e.motion.time[-1] == 0.0
        else amount / float(e.motion.time[-1])
        for e, amount in zip(runs, amounts, strict=True)
    )
    return above / below if above is not None and below else None
