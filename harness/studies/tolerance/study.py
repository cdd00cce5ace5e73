"""The study of requested against delivered: whether the accuracy knob tells the truth."""

import math
import statistics
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Figure, Panel, Prose, Series, table_of
from harness.core.verdict import Verdict
from harness.evaluation.evaluation import Record
from harness.studies.shared import run_columns
from harness.studies.study import Job, Results
from harness.studies.tolerance.delivered import DELIVERING, compared_by, round_off
from harness.studies.tolerance.design import (
    Knob,
    PlannedLadder,
    ToleranceSuite,
    knobs,
    planned_ladder,
    usable_scenes,
)
from harness.studies.tolerance.ladder import Honesty, ToleranceLadder


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
        for knob in knobs(self.engines, self.suite):
            for scene in scenes:
                yield planned_ladder(knob, scene, self.suite, records)

    def ladders(self, done: Results) -> list[ToleranceLadder]:
        """Return what each setting delivers in each scene, also where it cannot be run."""
        records = done.of(DELIVERING)
        return [
            ToleranceLadder(
                knob=plan.knob,
                scene=plan.scene,
                measure=compared_by(plan.scene),
                floor=round_off(plan.scene),
                records={asked: records[case] for asked, case in plan.cases.items()},
                unpaid=plan.unpaid,
                excluded=plan.excluded,
            )
            for plan in self._planned(done)
        ]

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables."""
        ladders = self.ladders(done)
        settings = tuple(_settings(ladders))
        return (
            _summary(settings, usable_scenes(self.suite)[1]),
            *_ladder_figures(settings),
            _factor_figure(settings),
            table_of("settings", "Each setting over all hard cases", _SETTINGS, settings),
            table_of("ladders", "Each setting in each hard case", _LADDERS, ladders),
            table_of("delivered", "Each run", _RUNS, _rows(ladders)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingSummary:
    """What one setting delivers over all scenes."""

    knob: Knob
    ladders: tuple[ToleranceLadder, ...]

    @property
    def asked(self) -> tuple[float, float] | None:
        """Coarsest and finest value that was asked for; None if nothing could be run."""
        values = [asked for each in self.ladders for asked in each.records]
        return (max(values), min(values)) if values else None

    @property
    def counts(self) -> Counter[Honesty]:
        """How many scenes have which kind of verdict."""
        return Counter(each.honesty for each in self.ladders)

    @property
    def slope(self) -> float | None:
        """Median of the slopes."""
        known = [each.slope for each in self.ladders if each.slope is not None]
        return statistics.median(known) if known else None

    @property
    def worst(self) -> tuple[float, float, str] | None:
        """Largest delivered over asked, what was asked, and in which scene."""
        known = [(*each.worst, each.scene.name) for each in self.ladders if each.worst is not None]
        return max(known, default=None)

    @property
    def level(self) -> tuple[float, str] | None:
        """The highest level at which the error stays above what is asked for, and the scene."""
        kinds = {Honesty.SATURATES, Honesty.IDLE}
        known = [
            (each.saturation[1], each.scene.name)
            for each in self.ladders
            if each.honesty in kinds and each.saturation is not None
        ]
        return max(known, default=None)

    @property
    def verdict(self) -> Verdict:
        """The commonest kind of verdict over the scenes that are judged, and how many have others.

        Its status is that of the commonest kind.
        """
        counts = Counter({k: n for k, n in self.counts.items() if k is not Honesty.UNJUDGED})
        if not counts:
            return Verdict(Honesty.UNJUDGED.status, "not judged in any scene")
        kind, often = counts.most_common(1)[0]
        total = counts.total()
        text = f"{kind.value} in {often} of {total}"
        others = ", ".join(f"{k.value} in {n}" for k, n in counts.most_common()[1:])
        return Verdict(kind.status, f"{text}; {others}" if others else text)


def _settings(ladders: Sequence[ToleranceLadder]) -> Iterator[SettingSummary]:
    for knob in dict.fromkeys(each.knob for each in ladders):
        yield SettingSummary(
            knob=knob, ladders=tuple(each for each in ladders if each.knob is knob)
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


_LEAST_DRAWN = 1e-17
"""rad: smaller errors are of turns so small that round-off of an angle of one is far above."""


def _ladder_figures(settings: Sequence[SettingSummary]) -> Iterator[Figure]:
    """Yield the figure of each engine: a panel a setting, a line a scene, and the diagonal."""
    for engine in dict.fromkeys(each.knob.engine for each in settings):
        own = [each for each in settings if each.knob.engine == engine]
        known = [pair for each in own for one in each.ladders for pair in one.known]
        if not known:
            continue
        errors = [max(number, _LEAST_DRAWN) for pair in known for number in pair]
        panels = tuple(_panel(each, (min(errors) / 2.0, max(errors) * 2.0)) for each in own)
        yield Figure(
            name=f"delivered-{engine}",
            title=f"Requested against delivered: {engine}",
            seen=(
                "A line is a hard case, and on the dashed diagonal the error is what was asked "
                "for. A line that turns level has come to what the setting cannot change, and one "
                "that stops ended otherwise than the exact motion."
            ),
            panels=panels,
            columns=min(len(panels), 2),
        )


def _panel(setting: SettingSummary, ends: tuple[float, float]) -> Panel:
    lines = []
    for one in setting.ladders:
        # a value that ended otherwise breaks the line
        y = [record["error"] or math.nan for record in one.records.values()]
        lines.append(
            Series(
                label=f"{setting.knob.engine}, a hard case",
                kind=setting.knob.engine,
                x=np.array(list(one.records)),
                y=np.array(y, dtype=np.float64),
                mark="both",
                hover=tuple(f"{one.scene.name}, {one.measure}" for _ in y),
            )
        )
    coarse, fine = setting.asked
    asked = np.array([coarse, fine])
    diagonal = Series(label="delivered as asked", kind="reference", x=asked, y=asked, dashed=True)
    return Panel(
        title=setting.knob.name,
        x_label=f"asked for: {setting.knob.variant.along}",
        y_label="delivered error [rad]",
        series=(*lines, diagonal),
        log_x=True,
        log_y=True,
        y_range=ends,
    )


def _factor_figure(settings: Sequence[SettingSummary]) -> Figure:
    """Return the worst factor of each setting in each scene."""
    names = tuple(each.knob.name for each in settings)
    series = []
    for place, each in enumerate(settings):
        pairs = [(one.worst[0], one.scene.name) for one in each.ladders if one.worst is not None]
        series.append(
            Series(
                label=each.knob.engine,
                kind=each.knob.engine,
                x=np.full(len(pairs), float(place)),
                y=np.array([factor for factor, _ in pairs]),
                mark="points",
                hover=tuple(scene for _, scene in pairs),
            )
        )
    ends = np.array([-0.5, len(names) - 0.5])
    series.append(
        Series(label="delivered as asked", kind="reference", x=ends, y=np.ones(2), dashed=True)
    )
    return Figure(
        name="worst-factors",
        title="Delivered over asked, at worst",
        seen=(
            "A point is a hard case: the largest ratio of the delivered error to what was asked "
            "for, over the values to which the error responds. Above the dashed line the setting "
            "promises more than it delivers."
        ),
        panels=(
            Panel(
                title="Worst factor in each hard case",
                x_label="setting",
                y_label="delivered over asked",
                series=tuple(series),
                log_y=True,
                x_names=names,
            ),
        ),
        columns=1,
    )


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
                "reason": "not paid for: too many steps are expected",
            }


_SETTING = Column("setting", "The setting that asks for an accuracy.", "knob.name")
_ENGINE = Column("engine", "Name of the engine.", "knob.engine")
_SCENE = Column("scene", "Name of the hard case.", "scene.name")
_SLOPE = "Slope of log delivered over log asked, where the error responds; 1 is in proportion."
_WORST = "Largest delivered error, rad, over what was asked, where the error responds."


def _count(kind: Honesty) -> Column:
    name = kind.value.replace(" ", "_")
    return Column(name, f"Hard cases with the verdict: {kind.value}.", lambda s: s.counts[kind])


_SETTINGS = (
    _SETTING,
    _ENGINE,
    Column("coarsest", "Coarsest value asked for.", lambda s: s.asked and s.asked[0]),
    Column(
        "finest", "Finest value that could be paid for.", lambda s: s.asked and s.asked[1]
    ),
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
