"""The study of requested against delivered: whether the accuracy knob tells the truth."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Prose, table_of
from harness.evaluation.evaluation import Record
from harness.studies.shared import run_columns
from harness.studies.study import Job, Results
from harness.studies.tolerance.delivered import DELIVERING, compared_by, round_off
from harness.studies.tolerance.design import (
    PlannedLadder,
    ToleranceSuite,
    knobs,
    planned_ladder,
    usable_scenes,
)
from harness.studies.tolerance.figures import factor_figure, ladder_figures
from harness.studies.tolerance.ladder import (
    Honesty,
    SettingSummary,
    ToleranceLadder,
    by_setting,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceStudy:
    """Ask for accuracies over ten decades, and measure what is delivered.

    Parameters
    ----------
    suite : ToleranceSuite
        One of `harness.studies.tolerance.design.SUITES`.
    engines : tuple of str
    """

    suite: ToleranceSuite
    engines: tuple[str, ...]

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"requested against delivered, {self.suite.name} suite"

    def next_jobs(self, done: Results) -> list[Job[Case, Record]]:
        """Return a case for each value that can be paid for, as far as coarser runs tell."""
        return [
            Job(DELIVERING, case) for plan in self._planned(done) for case in plan.cases.values()
        ]

    def _planned(self, done: Results) -> Iterator[PlannedLadder]:
        records, scenes = done.of(DELIVERING), usable_scenes(self.suite)[0]
        settings = knobs(self.engines, self.suite)
        for scene, knob in product(scenes, settings):  # a scene's exact motion is solved once
            yield planned_ladder(knob, scene, self.suite, records)

    def ladders(self, done: Results) -> list[ToleranceLadder]:
        """Return what each setting delivers in each scene, also where it cannot be run."""
        records, scenes = done.of(DELIVERING), usable_scenes(self.suite)[0]
        exact = {scene: (compared_by(scene), round_off(scene)) for scene in scenes}
        return [
            ToleranceLadder(
                knob=plan.knob,
                scene=plan.scene,
                measure=exact[plan.scene][0],
                floor=exact[plan.scene][1],
                records={asked: records[case] for asked, case in plan.cases.items()},
                unpaid=plan.unpaid,
                because=plan.because,
                excluded=plan.excluded,
            )
            for plan in self._planned(done)
        ]

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables."""
        ladders = self.ladders(done)
        settings = by_setting(ladders)
        return (
            _summary(settings, usable_scenes(self.suite)[1]),
            *ladder_figures(settings),
            factor_figure(settings),
            table_of("settings", "Each setting over all hard cases", _SETTINGS, settings),
            table_of("ladders", "Each setting in each hard case", _LADDERS, ladders),
            table_of("delivered", "Each run", _RUNS, _rows(ladders)),
        )


def _summary(settings: Sequence[SettingSummary], left_out: dict[str, str]) -> Prose:
    """Return what is compared with what, and a sentence on each setting."""
    paragraphs = [
        (
            "What is asked for is a relative tolerance of the steps, an accuracy of a step, or "
            "the share eta of its way that the tilt may move in a step. What is delivered is the "
            "absolute error of the first angle of turn, in rad, or, of a can that does not "
            "bounce, the largest error of phi. Nobody promises that the two are equal: a "
            "tolerance bounds a step, and errors of steps add up. A setting is called honest if "
            "its error follows what is asked for, and lies at most ten times above it. The error "
            "of an engine has all in it, the softness of its contact too: the level at which it "
            "stays is what no step of that engine takes away."
        ),
        *(_sentence(each) for each in settings),
    ]
    if left_out:
        names = ", ".join(f"{name} ({why})" for name, why in left_out.items())
        paragraphs.append(f"Left out: {names}.")
    text = "\n\n".join(paragraphs)
    return Prose(name="summary", title="Does the accuracy knob tell the truth?", text=text)


def _sentence(setting: SettingSummary) -> str:
    if setting.asked is None:
        return f"{setting.knob.name}: {setting.verdict.text}."
    coarse, fine = setting.asked
    words = [f"{setting.knob.name}, asked for {coarse:.0e} to {fine:.0e}: {setting.verdict.text}."]
    if setting.slope is not None:
        words.append(f"The median slope is {setting.slope:.2f}.")
    if setting.worst is not None:
        factor, asked, scene = setting.worst
        words.append(f"At worst the error is {factor:.2g} times the {asked:.0e} asked ({scene}).")
    if setting.level is not None:
        level, scene = setting.level
        words.append(f"The highest level that it does not leave is {level:.1e} rad ({scene}).")
    return " ".join(words)


def _rows(ladders: Sequence[ToleranceLadder]) -> Iterator[dict[str, object]]:
    for each in ladders:
        for asked, record in each.records.items():
            case = each.knob.case(each.scene, asked)
            yield {
                "setting": each.knob.name,
                "engine": each.knob.engine,
                "scene": each.scene.name,
                "asked": asked,
                "delivered_rad": record["error"],
                "factor": None if record["error"] is None else record["error"] / asked,
                "steps": record["steps"],
                "reason": record["reason"],
                "case": case.digest(record["version"]),
            }
        for asked in each.unpaid:
            yield {
                "setting": each.knob.name,
                "engine": each.knob.engine,
                "scene": each.scene.name,
                "asked": asked,
                "reason": f"not paid for: {each.because}",
            }


_SETTING = Column("setting", "The setting that asks for an accuracy.", "knob.name")
_ENGINE = Column("engine", "Name of the engine.", "knob.engine")
_SCENE = Column("scene", "Name of the hard case.", "scene.name")
_SLOPE = "Slope of log delivered over log asked, where the error responds; 1 is in proportion."
_WORST = "Largest delivered error, rad, over what was asked, of the errors above round-off."


def _count(kind: Honesty) -> Column:
    name = kind.value.replace(" ", "_")
    return Column(name, f"Hard cases with the verdict: {kind.value}.", lambda s: s.counts[kind])


_SETTINGS = (
    _SETTING,
    _ENGINE,
    Column("coarsest", "Coarsest value asked for.", lambda s: s.asked and s.asked[0]),
    Column("finest", "Finest value that could be paid for.", lambda s: s.asked and s.asked[1]),
    Column("median_slope", _SLOPE, "slope"),
    Column("worst_factor", _WORST, lambda s: s.worst and s.worst[0]),
    Column("worst_asked", "What was asked for there.", lambda s: s.worst and s.worst[1]),
    Column("worst_scene", "The hard case in which that is.", lambda s: s.worst and s.worst[2]),
    Column(
        "level_rad", "Highest level at which the error stays.", lambda s: s.level and s.level[0]
    ),
    Column("level_scene", "The hard case of that level.", lambda s: s.level and s.level[1]),
    *(_count(kind) for kind in Honesty),
    Column("verdict", "The commonest verdict over the hard cases, and the others."),
)

_LADDERS = (
    _SETTING,
    _ENGINE,
    _SCENE,
    Column("measure", "Which error is compared: of the first turn, or the largest of phi."),
    Column("values", "How many values were asked for.", lambda each: len(each.records)),
    Column("unpaid", "How many finer ones were not paid for.", lambda each: len(each.unpaid)),
    Column("slope", _SLOPE),
    Column("worst_factor", _WORST, lambda each: each.worst and each.worst[0]),
    Column("worst_asked", "What was asked for there.", lambda each: each.worst and each.worst[1]),
    Column("finest_factor", "Delivered over asked at the finest value above round-off.", "finest"),
    Column(
        "saturates_at",
        "Value from which on the error falls no further.",
        lambda each: each.saturation and each.saturation[0],
    ),
    Column(
        "level_rad",
        "Error from there on, a geometric mean.",
        lambda each: each.saturation and each.saturation[1],
    ),
    Column("round_off_rad", "Up to which the exact motion is known.", "floor"),
    Column("verdict", "Honest, or what else, with the numbers behind it."),
)

_RUNS = (
    _SETTING.of("setting"),
    _ENGINE.of("engine"),
    _SCENE.of("scene"),
    Column("asked", "Value of the setting."),
    Column("delivered_rad", "Magnitude of the error; empty if the motion ended otherwise."),
    Column("factor", "Delivered over asked."),
    Column("steps", "Steps taken."),
    Column("reason", "Why there is no error."),
    run_columns.LINK.of("case"),
)
