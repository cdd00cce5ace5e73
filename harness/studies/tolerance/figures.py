"""Figures of requested against delivered: each setting in each hard case, and worst factors."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.report_model import Figure, Panel, Series
from harness.core.verdict import Status
from harness.studies.tolerance.ladder import Honesty, SettingSummary, ToleranceLadder

_LEAST_DRAWN = 1e-17
"""rad: smaller errors are of turns so small that round-off of an angle of one is far above."""

_ZERO_DRAWN = 2.0**-52
"""rad: where an error of exactly zero is drawn, the distance of doubles at one."""

_TOLD_APART = 7
"""Hard cases with a colour of their own, the same in each figure of a report; others are grey."""


def _notable(settings: Sequence[SettingSummary]) -> tuple[str, ...]:
    """Return the hard cases in which most settings do not keep what they promise, sorted."""
    broken: Counter[str] = Counter()
    worst: dict[str, float] = {}
    for one in (one for each in settings for one in each.ladders):
        name = one.scene.name
        broken[name] += one.honesty.status in {Status.FAILED, Status.DEVIATES}
        worst[name] = max(worst.get(name, 0.0), one.worst_responding or 0.0)
    ranked = sorted(worst, key=lambda name: (-broken[name], -worst[name], name))
    return tuple(sorted(name for name in ranked[:_TOLD_APART] if broken[name]))


def ladder_figures(settings: Sequence[SettingSummary]) -> Iterator[Figure]:
    """Yield the figure of each engine: a panel a setting, a line a scene, and the diagonal."""
    notable = _notable(settings)
    for engine in dict.fromkeys(each.knob.engine for each in settings):
        own = [each for each in settings if each.knob.engine == engine and each.asked is not None]
        known = [pair for each in own for one in each.ladders for pair in one.known]
        if not known:
            continue
        drawn = [max(number, _LEAST_DRAWN) for pair in known for number in pair if number > 0.0]
        if any(error == 0.0 for _, error in known):
            drawn.append(_ZERO_DRAWN)
        ends = min(drawn) / 2.0, max(drawn) * 2.0
        yield Figure(
            name=f"delivered-{engine}",
            title=f"Requested against delivered: {engine}",
            seen=(
                "A line is a hard case, and on the dashed diagonal the error is what was asked "
                "for; the cases in which most settings do not keep what they promise have a "
                "colour. A line that turns level has come to what the setting cannot change. "
                "Where a line has a gap the motion ended otherwise than the exact one, and it "
                "ends where finer values take more steps than are paid for."
            ),
            panels=tuple(_panel(each, ends, notable) for each in own),
            columns=min(len(own), 2),
        )


def _panel(setting: SettingSummary, ends: tuple[float, float], notable: Sequence[str]) -> Panel:
    ladders = sorted(setting.ladders, key=lambda one: one.scene.name in notable)  # grey below
    lines = [_line(one, notable) for one in ladders if one.known]
    zeros = np.array([asked for one in ladders for asked, error in one.known if error == 0.0])
    if zeros.size:
        level = np.full(zeros.size, _ZERO_DRAWN)
        lines.append(
            Series(label="exactly zero", kind="reference", x=zeros, y=level, mark="points")
        )
    asked = np.array(setting.asked)
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


def _line(one: ToleranceLadder, notable: Sequence[str]) -> Series:
    """Return the errors of a setting in a scene; a value that ended otherwise breaks the line."""
    name = one.scene.name
    errors = [record["error"] for record in one.records.values()]
    return Series(
        label=name if name in notable else "another hard case",
        kind=name if name in notable else "background",
        x=np.array(list(one.records)),
        y=np.array([math.nan if e is None else e or _ZERO_DRAWN for e in errors], dtype=np.float64),
        mark="both" if name in notable else "line",
        hover=tuple(f"{name}, {one.measure}" for _ in errors),
    )


def factor_figure(settings: Sequence[SettingSummary]) -> Figure:
    """Return the worst factor of each setting in each scene."""
    names, series = [], []
    for place, each in enumerate(settings):
        pairs = [(one.worst[0], one.scene.name) for one in each.ladders if one.worst is not None]
        exact = each.counts[Honesty.ROUND_OFF]
        names.append(f"{each.knob.name}: {exact} to round-off" if exact else each.knob.name)
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
            "for, over the values at which the error is above round-off of the exact motion. "
            "Above the dashed line the setting promises more than it delivers. A case in which "
            "every value gives round-off has no point: a setting tells how many those are."
        ),
        panels=(
            Panel(
                title="Worst factor in each hard case",
                x_label="setting",
                y_label="delivered over asked",
                series=tuple(series),
                log_y=True,
                x_names=tuple(names),
            ),
        ),
        columns=1,
    )
