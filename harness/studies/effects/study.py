"""The effects study: effects that a scene needs, their cost, and those that an engine imposes."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Figure, Panel, Prose, Series
from harness.evaluation.case_record import LOST
from harness.studies.effects.changes import CHANGED, Effect, EffectsResults, EffectStatus
from harness.studies.effects.friction import friction
from harness.studies.effects.plan import FACTORS, EffectsPlan
from harness.studies.shared import run_columns
from harness.studies.study import EVALUATION, TIMING, Job, Results, evaluation_jobs

_COUNTS = frozenset({EffectStatus.NEEDED, EffectStatus.MISSING})
_KNOWN = _COUNTS | {EffectStatus.HARMLESS}

_LEAST = 1e-6
"""Share of the threshold at which bars end: smaller changes would stretch the axis."""

_COSTS = {
    "steps_ratio": "Steps per simulated second with it over those without it.",
    "constraint_rows_ratio": "Constraint rows per simulated second, likewise.",
    "cpu_ratio": "Processor time per simulated second, likewise; least of repeats.",
    "cpu_spread": "Longest over shortest processor time of repeats of the noisier run.",
}

_EFFECT = Column("effect", "Key in a scene file: of an effect, a constant of one, or the height.")

_EFFECTS = (
    run_columns.SCENE.of("scene"),
    run_columns.ENGINE.of("engine"),
    _EFFECT.of("name"),
    Column("declared", "Whether the scene declares it."),
    Column(
        "simulated",
        "Whether the engine simulates it in this scene.",
        lambda effect: effect.declared and effect.run is not None,
    ),
    Column(
        "verdict",
        "Needed: declared, and it changes the outcome; harmless: it does not; missing: not "
        "declared, though at the assumed strength it would; imposed by the engine: it cannot be "
        "removed; unsupported: the engine cannot represent it.",
        "verdict.value",
    ),
    Column("why", "The number behind the verdict."),
    Column("strength", "Constants of its law, SI units: as declared, or as assumed."),
    *(Column(key, meaning, f"cost.{key}") for key, meaning in _COSTS.items()),
    *(
        Column(
            f"change_{q.key}",
            f"{q.meaning} With the effect less without, others as declared.",
            f"changes.{q.key}",
        )
        for q in CHANGED
    ),
    run_columns.CASE.of("run.digest"),
    run_columns.COMMAND.of("run.case.command"),
)

_FACTORS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    _EFFECT,
    Column("quantity", "What changes; the unit is its suffix."),
    Column("from_ideal", "Change when the effect is added to the ideal can."),
    Column("from_declared", "Change between all declared effects and all but this one."),
    Column("mean", "Change averaged over all sets of the other declared effects (main effect)."),
    Column("interaction", "From declared less from ideal: what it does only with the others."),
)

_RUNS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    run_columns.MODEL,
    Column("effects", "Effects in force."),
    *(Column(q.key, q.meaning) for q in CHANGED),
    Column("steps", "Steps of the run.", "simulation.steps"),
    Column(
        "constraint_rows",
        "Constraint rows, summed over the steps.",
        "simulation.constraint_rows",
    ),
    run_columns.OUTCOME,
    run_columns.NOTE,
    run_columns.CASE,
)


def _factor_rows(results: EffectsResults) -> list[dict[str, Any]]:
    """Return how the declared effects act together."""
    return [
        {
            "scene": results.plan.scene.name,
            "engine": effect.engine,
            "effect": effect.name,
            "quantity": q.key,
            "from_ideal": (alone := effect.alone.get(q.key)),
            "from_declared": (late := effect.changes.get(q.key)),
            "mean": effect.mean.get(q.key),
            "interaction": None if alone is None or late is None else late - alone,
        }
        for effect in results.effects
        if effect.declared
        for q in CHANGED
    ]


def _run_rows(results: EffectsResults) -> list[dict[str, Any]]:
    """Return every run of the plan."""
    return [
        {"simulation": e.simulation, "effects": ", ".join(sorted(subset)) or "none"}
        | {q.key: q.of_run(e) for q in CHANGED}
        for engine in results.plan.engines
        for subset in dict.fromkeys(results.plan.subsets())
        if (e := results.evaluation(engine, subset)) is not None
    ]


def sentences(results: EffectsResults) -> tuple[str, ...]:
    """Return sentences on declared effects, on missing ones, and on those that engines impose."""
    plan, said = results.plan, []
    declared = [effect for effect in results.of_engine(plan.engines[0]) if effect.declared]
    if declared:
        words = "; ".join(f"{effect.name} is {effect.verdict.value}" for effect in declared)
        said.append(f"Of what {plan.scene.name} declares: {words}.")
    else:
        said.append(f"{plan.scene.name} declares no effect, and none is simulated.")
    known: dict[str, Effect] = {}  # of each effect what the first engine says that can tell
    for effect in results.effects:
        if effect.verdict in _KNOWN:
            known.setdefault(effect.name, effect)
    missing = [
        f"{effect.name} (by {effect.engine}: {effect.why[0].lower()}{effect.why[1:].rstrip('.')})"
        for effect in known.values()
        if effect.verdict is EffectStatus.MISSING
    ]
    said.append(
        "Not declared, though at the strength assumed they change the outcome: "
        f"{'; '.join(missing)}."
        if missing
        else "Nothing that is left out would change the outcome."
    )
    nobody = [name for name in FACTORS if name not in known]
    if nobody:
        said.append(f"None of these engines can tell what these would do: {', '.join(nobody)}.")
    for engine in plan.engines:
        effects = results.of_engine(engine)
        own = [effect.name for effect in effects if effect.verdict is EffectStatus.IMPOSED]
        if own:
            names = ", ".join(own)
            said.append(f"{engine} adds of its own accord, and it cannot be removed: {names}.")
    return tuple(said)


def bars(results: EffectsResults) -> Figure:
    """Return the largest change of each effect, in units of the change that counts."""
    plan, names = results.plan, tuple(FACTORS)
    series = []
    for place, engine in enumerate(plan.engines):
        effects = results.of_engine(engine)
        shift = 0.8 * ((place + 0.5) / len(plan.engines) - 0.5)
        series.append(
            Series(
                label=engine,
                kind=engine,
                x=np.arange(len(names), dtype=np.float64) + shift,
                y=np.array([_height(results, effect) for effect in effects]),
                mark="points",
                hover=tuple(
                    f"{effect.name}: {effect.verdict.value}. {effect.why}" for effect in effects
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
    first = results.of_engine(plan.engines[0])
    counts = [effect.name for effect in first if effect.verdict in _COUNTS]
    nothing = [effect.name for effect in first if effect.verdict is EffectStatus.HARMLESS]
    return Figure(
        name=f"{plan.scene.name}-effect-changes",
        title="What each effect changes",
        seen=(
            f"By {plan.engines[0]}, above the dashed line lie {', '.join(counts) or 'no effects'}: "
            "at the strength declared or assumed they change the outcome. Below it lie "
            f"{', '.join(nothing) or 'none'}, which cost time and change nothing that counts."
        ),
        panels=(
            Panel(
                title="Largest change of any quantity, over the change that counts",
                x_label="effect",
                y_label="change over what counts []",
                x_names=tuple(f"{n} (declared)" if n in plan.declared else n for n in names),
                series=tuple(series),
                log_y=True,
            ),
        ),
        columns=1,
        scene=plan.scene.name,
    )


def _height(results: EffectsResults, effect: Effect) -> float:
    """Return the largest change of an effect over its threshold; NaN where none is known."""
    shares = [
        abs(value) / results.threshold(effect.engine, key)
        for key, value in effect.changes.items()
        if value is not None
    ]
    return max(*shares, _LEAST) if shares else math.nan


def effects_report(results: EffectsResults) -> tuple[Artefact, ...]:
    """Return words, figure, tables."""
    scene = results.plan.scene.name
    tables = (
        ("effects", "What each effect does", _EFFECTS, results.effects),
        ("factors", "How the declared effects act together", _FACTORS, _factor_rows(results)),
        ("runs", "Every run of the study", _RUNS, _run_rows(results)),
    )
    return (
        Prose(
            name=f"{scene}-effects-words",
            title="Which effects the scene calls for",
            text=" ".join(sentences(results)),
            scene=scene,
        ),
        bars(results),
        *(
            run_columns.scene_table(scene, name, title, columns, rows, "scene", "case", "command")
            for name, title, columns, rows in tables
            if rows  # a scene that declares nothing has no factors
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectsStudy:
    """Run a scene with each effect and without it, time both, and run a ladder of friction.

    Parameters
    ----------
    plan : EffectsPlan
        From `harness.studies.effects.plan.plan_effects`.
    """

    plan: EffectsPlan

    name = "effects"

    def next_jobs(self, done: Results) -> list[Job[Case, Any]]:
        """Return the runs; then the timing of those of the plan that came back."""
        runs, cases = done.of(EVALUATION), self.plan.cases()
        slippery = (case for rungs in self.plan.friction.values() for case in rungs.values())
        return evaluation_jobs((*cases, *slippery)) + [
            Job(TIMING, case)
            for case in cases
            if case in runs and runs[case].simulation.outcome.name not in LOST
        ]

    def foreseen(self, done: Results) -> list[Job[Case, Any]]:
        """Return the timings, before they are among the jobs."""
        return [] if done.of(EVALUATION) else [Job(TIMING, case) for case in self.plan.cases()]

    def findings(self, done: Results) -> EffectsResults:
        """Return changes, costs and verdict of each effect in each engine."""
        runs, times = done.of(EVALUATION), done.of(TIMING)
        return EffectsResults(plan=self.plan, evaluations=runs, times=times)

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables, and the turn against friction."""
        slippery = friction(self.plan.scene.name, self.plan.friction, done.of(EVALUATION))
        return (*effects_report(self.findings(done)), *slippery)

    def answer(self, done: Results) -> dict[str, Any]:
        """Return the effects as `--json` prints them."""
        results = self.findings(done)
        return {
            "scene": self.plan.scene.name,
            "declared": sorted(self.plan.declared),
            "tolerance_deg": self.plan.tolerance,
            "engines": {
                engine: {
                    effect.name: {
                        "declared": effect.declared,
                        "verdict": effect.verdict.value,
                        "why": effect.why,
                        "changes": dict(effect.changes),
                        **{key: effect.cost.get(key) for key in _COSTS if key != "cpu_spread"},
                    }
                    for effect in results.of_engine(engine)
                }
                for engine in self.plan.engines
            },
            "sentences": list(sentences(results)),
        }
