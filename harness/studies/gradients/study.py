"""The study of gradients: what an engine says a small change does, against the exact derivative."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Prose
from harness.engines.ladder import rung_of, spelled
from harness.evaluation.evaluation import Record
from harness.metrics.convergence import observed_order
from harness.studies.gradients.derivatives import CHANGING, EXACT, OWN, PROGRAM, Numbers
from harness.studies.gradients.design import (
    SETTING_STEPS,
    GradientPlan,
    instants,
    quantities_of,
    unit_of,
    with_setting,
)
from harness.studies.gradients.figures import (
    at_finest,
    case_name,
    instant_figures,
    instants_of,
    own_figures,
    steady,
    step_figures,
)
from harness.studies.gradients.findings import (
    RIGHT,
    Differences,
    OwnDerivative,
    over_step,
    percent,
    with_causes,
)
from harness.studies.gradients.settings import SETTINGS_COLUMNS, setting_changes
from harness.studies.shared.run_columns import scene_table
from harness.studies.study import Job, Results


@dataclass(frozen=True, slots=True, kw_only=True)
class GradientsStudy:
    """Differentiate a bounce by its release and its can, in every engine.

    Parameters
    ----------
    plan : GradientPlan
        From `harness.studies.gradients.design.plan_gradients`.
    """

    plan: GradientPlan

    name = "gradients"

    @property
    def _truth(self) -> Case:
        return Case(scene=self.plan.scene, engine="reference")

    @property
    def _stepping(self) -> list[Case]:
        """The bases whose engines may differentiate themselves: those of one timestep."""
        return [base for base in self.plan.bases if base.engine != "reference" and steady(base)]

    def next_jobs(self, done: Results) -> list[Job[Case, Record]]:
        """Return every changed case, the exact derivatives, and those of engines.

        Which settings are in force is known of runs: those with changed settings come second.
        """
        plan, runs = self.plan, done.of(CHANGING)
        return [
            Job(EXACT, self._truth),
            Job(CHANGING, self._truth),
            *(Job(CHANGING, base) for base in plan.settled_bases),
            *(Job(CHANGING, case) for case in plan.cases()),
            *(Job(OWN, base) for base in self._stepping),
            *(
                Job(CHANGING, with_setting(base, settings, name, 1.0 + sign * step))
                for base in plan.settled_bases
                if base in runs
                for settings in (runs[base]["settings"],)
                for name in plan.settings_of(base, settings)
                for step in SETTING_STEPS
                for sign in (1.0, -1.0)
            ),
        ]

    def differences(self, done: Results) -> list[Differences]:
        """Return the differences of each quantity by each key at each timestep."""
        plan, runs = self.plan, done.of(CHANGING)
        exact, size = done.of(EXACT)[self._truth], self._exact_numbers(done)
        times = instants(plan.scene)
        found = []
        for base in plan.bases:
            for key in plan.keys:
                ends = {
                    step: [
                        runs[plan.changed(base, key, sign * step)]["numbers"]
                        for sign in (1.0, -1.0)
                    ]
                    for step in plan.steps_of(key)
                }
                for quantity in quantities_of(plan.scene):
                    value, unit = size[quantity], unit_of(plan.scene, key)
                    values = {
                        step: over_step(up[quantity], down[quantity], 2.0 * step * unit)
                        for step, (up, down) in ends.items()
                    }
                    found.append(
                        Differences(
                            base=base,
                            key=key,
                            quantity=quantity,
                            exact=exact["slopes"].get(quantity, {}).get(key),
                            size=math.nan if value is None else abs(value),
                            values=values,
                            chaotic=plan.chaotic and quantity in times,
                            why=exact["why"].get(quantity, f"no derivative by {key}"),
                        )
                    )
        return found

    def _exact_numbers(self, done: Results) -> Numbers:
        """Return the exact quantities; None each if their task was lost."""
        numbers: Numbers = done.of(CHANGING)[self._truth]["numbers"]
        return numbers

    def own(self, done: Results, differences: Sequence[Differences]) -> list[OwnDerivative]:
        """Return the derivatives that engines have of their own.

        Parameters
        ----------
        done : Results
        differences : sequence of Differences
            Of the same results: they have the exact derivatives.
        """
        known = {(d.base, d.key, d.quantity): d for d in differences}
        found = []
        for base, record in done.of(OWN).items():
            for entry in record["own"]:
                for quantity in quantities_of(self.plan.scene):
                    for key in (key for key in self.plan.keys if key.startswith("release.")):
                        value = entry["values"].get(quantity, {}).get(key)
                        same = known[base, key, quantity]
                        unknown = entry["why"] or "the engine's own motion does not tell it"
                        found.append(
                            OwnDerivative(
                                base=base,
                                settings=entry["settings"],
                                key=key,
                                quantity=quantity,
                                step=entry["step"],
                                value=value,
                                exact=same.exact,
                                scale=same.scale,
                                why=same.why if same.exact is None else unknown,
                            )
                        )
        return list(with_causes(found))

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables."""
        scene = self.plan.scene.name
        differences = self.differences(done)
        own = self.own(done, differences)
        ladders = tuple(_ladders(differences))
        times = instants_of(differences)
        along = [each for each in differences if each.quantity in times]
        exact = self._exact_numbers(done)
        settings = tuple(setting_changes(self.plan, done.of(CHANGING), exact))
        return (
            _summary(scene, differences, own),
            *step_figures(scene, differences),
            *instant_figures(scene, differences),
            *own_figures(scene, own),
            scene_table(scene, "gradients", "Derivatives by differences", _GRADIENTS, differences),
            scene_table(scene, "own", "Derivatives of the engines' own", _OWN, own),
            *(
                [scene_table(scene, "phi", "Phi along the motion", _INSTANTS, along)]
                if along
                else []
            ),
            scene_table(scene, "settings", "Settings of engines", SETTINGS_COLUMNS, settings),
            scene_table(scene, "timesteps", "As the timestep is shortened", _LADDERS, ladders),
            scene_table(scene, "differences", "Each difference", _EACH, _each(differences)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class GradientLadder:
    """The errors of a derivative over the timesteps of an engine, coarse first.

    Each is of the difference that has settled: nearest to that of the next shorter step.
    """

    rungs: tuple[Differences, ...]

    @property
    def pairs(self) -> list[tuple[float, float]]:
        """Timestep and error of each rung that has both."""
        return [
            (step, each.settled[1])
            for each in self.rungs
            if each.settled is not None and (step := rung_of(each.base)) is not None
        ]

    @property
    def order(self) -> float | None:
        """Order with which the error falls."""
        pairs = self.pairs
        found = observed_order([step for step, _ in pairs], [error for _, error in pairs])
        return found.order if math.isfinite(found.order) else None

    @property
    def words(self) -> str:
        """Each timestep with its error."""
        return ", ".join(
            f"{spelled(self.rungs[0].base.engine, step)}: {percent(error)}"
            for step, error in self.pairs
        )


def _ladders(differences: Sequence[Differences]) -> Iterator[GradientLadder]:
    groups: dict[tuple[str, str, str], list[Differences]] = {}
    for each in differences:
        if each.base.engine != "reference" and steady(each.base):
            groups.setdefault((each.base.engine, each.key, each.quantity), []).append(each)
    for rungs in groups.values():
        yield GradientLadder(rungs=tuple(rungs))


def _summary(scene: str, differences: Sequence[Differences], own: Sequence[OwnDerivative]) -> Prose:
    """Return a paragraph on each engine."""
    paragraphs = []
    for base in dict.fromkeys(each.base for each in at_finest(differences)):
        mine = [each for each in differences if each.base == base]
        paragraphs.append(_sentences(base, mine))
        of_engine = [each for each in own if each.base == base]
        paragraphs += _of_its_own(of_engine)
    text = "\n\n".join(paragraphs)
    title = "Are gradients through a contact engine right?"
    return Prose(name=f"{scene}-summary", title=title, text=text, scene=scene)


def _of_its_own(own: Sequence[OwnDerivative]) -> Iterator[str]:
    """Yield a sentence on the derivatives of an engine's own, by how it came to them."""
    for settings, step in dict.fromkeys((each.settings, each.step) for each in own):
        mine = [each for each in own if (each.settings, each.step) == (settings, step)]
        way = "of its program" if step == PROGRAM else f"with differences of {step} in a step"
        way += f", under {settings}" if settings else ""
        errors = sorted((e.error, e.quantity, e.key) for e in mine if e.error is not None)
        if not errors:
            yield f"Its own derivatives, {way}, are not judged: {mine[0].why}."
            continue
        right = sum(error <= RIGHT for error, *_ in errors)
        error, quantity, key = errors[-1]
        yield (
            f"Its own derivatives, {way}, are right in {right} of {len(errors)}; the worst is off "
            f"by {percent(error)} ({quantity} by {key})."
        )


def _sentences(base: Case, mine: Sequence[Differences]) -> str:
    """Return how many derivatives of an engine are right, and with which steps."""
    known = [each for each in mine if each.best is not None]
    right = [each for each in known if each.usable is not None]
    words = [f"{case_name(base)}: of {len(mine)} derivatives {len(right)} can be had to 1 %."]
    if right:
        low = max(each.usable[0] for each in right if each.usable)
        high = min(each.usable[1] for each in right if each.usable)
        words.append(
            f"One step for all of them lies between {low:.0e} and {high:.0e}, relative."
            if low <= high
            else f"No step serves all: one needs {low:.0e} or longer, another {high:.0e} or "
            "shorter, relative."
        )
    worst = max(known, key=lambda each: each.best[1] if each.best else 0.0, default=None)
    if worst is not None and worst.best is not None:
        words.append(
            f"The worst, {worst.quantity} by {worst.key}, is off by {percent(worst.best[1])} at "
            f"its best step of {worst.best[0]:.0e}."
        )
    return " ".join(words)


def _each(differences: Sequence[Differences]) -> Iterator[dict[str, object]]:
    for each in differences:
        for step, value in each.values.items():
            yield {
                "engine": each.base.engine,
                "profile": each.base.profile,
                "timestep_s": rung_of(each.base),
                "key": each.key,
                "quantity": each.quantity,
                "step": step,
                "value": value,
                "exact": each.exact,
                "relative_error": each.errors[step],
            }


_HEAD = (
    Column("engine", "Name of the engine; reference is the exact motion itself.", "base.engine"),
    Column("profile", "matched, at a fixed timestep, or adaptive.", "base.profile"),
    Column("timestep_s", "Timestep, or accuracy in its place.", lambda each: rung_of(each.base)),
    Column("key", "Number of the scene that is changed."),
    Column("quantity", "Quantity of the first bounce; the unit is its suffix."),
)
_EXACT = Column("exact", "The exact derivative, in the units of both.")
_ERROR = "Error of the derivative over the exact one, or over a thousandth of quantity over key."

_GRADIENTS = (
    *_HEAD,
    _EXACT,
    Column("best_step", "Relative step with the least error.", lambda d: d.best and d.best[0]),
    Column("best_value", "The difference there.", lambda d: d.best and d.values[d.best[0]]),
    Column("relative_error", _ERROR, lambda d: d.best and d.best[1]),
    Column(
        "settled_step",
        "Step whose difference is nearest to the next.",
        lambda d: d.settled and d.settled[0],
    ),
    Column("settled_error", "Relative error of that one.", lambda d: d.settled and d.settled[1]),
    Column("right_from", "Shortest step that is right to 1 %.", lambda d: d.usable and d.usable[0]),
    Column("right_to", "Longest step that is right to 1 %.", lambda d: d.usable and d.usable[1]),
    Column("floor", "Error that no step changes, by the fit.", "parts.floor"),
    Column("noise_below", "Step below which noise is the largest part."),
    Column("truncation_above", "Step above which truncation is."),
    Column("noise", "Noise of the quantity that the differences see, relative."),
    Column(
        "short_cause",
        "What goes wrong at short steps.",
        lambda d: d.short and d.short.takeover.word,
    ),
    Column("short_from", "Longest step of those.", lambda d: d.short and d.short.step),
    Column(
        "long_cause", "What goes wrong at long steps.", lambda d: d.long and d.long.takeover.word
    ),
    Column("long_from", "Shortest step of those.", lambda d: d.long and d.long.step),
    Column(
        "relative_to",
        "What errors are relative to: quantity over key where the derivative is next to nothing.",
        lambda d: "quantity over key / 1000" if d.insensitive else "exact derivative",
    ),
    Column("fit_residual", "Root mean square of the log of error over fit.", "parts.residual"),
    Column("verdict", "Right, near, wrong, or of the wrong sign, and with which steps."),
)

_OWN = (
    *_HEAD,
    Column("settings", "That the engine needs for its derivative, on top of the profile."),
    Column("engine_step", "Of its own differences, in its units; or its program, exactly.", "step"),
    Column("value", "The derivative that the engine gives."),
    _EXACT,
    Column("relative_error", _ERROR, "error"),
    Column(
        "cause",
        "What is wrong at this step, where it is not right.",
        lambda own: own.cause and own.cause.word,
    ),
    Column("verdict", "Right, near, wrong, or of the wrong sign."),
)

_LADDERS = (
    _HEAD[0].of(lambda each: each.rungs[0].base.engine),
    _HEAD[3].of(lambda each: each.rungs[0].key),
    _HEAD[4].of(lambda each: each.rungs[0].quantity),
    Column("errors", "Each timestep, with the error of the difference that settles.", "words"),
    Column("order", "Order with which that error falls with the timestep."),
)

_INSTANTS = (
    *_HEAD[:4],
    Column(
        "time_s",
        "At which phi is differentiated.",
        lambda each: instants_of([each])[each.quantity],
    ),
    Column("growth", "Exact derivative of phi by a relative change of the key, rad."),
    Column("best_step", "Relative step with the least error.", lambda d: d.best and d.best[0]),
    Column("relative_error", _ERROR, lambda d: d.best and d.best[1]),
    Column(
        "settled_error", "Of the difference that settles.", lambda d: d.settled and d.settled[1]
    ),
    Column("right_to", "Longest step that is right to 1 %.", lambda d: d.usable and d.usable[1]),
    Column("verdict", "Right, near, wrong, or of the wrong sign, and with which steps."),
)

_EACH = (
    _HEAD[0].of("engine"),
    _HEAD[1].of("profile"),
    _HEAD[2].of("timestep_s"),
    _HEAD[3],
    _HEAD[4],
    Column("step", "Relative step of the difference."),
    Column("value", "The central difference over its step."),
    _EXACT,
    Column("relative_error", _ERROR),
)
