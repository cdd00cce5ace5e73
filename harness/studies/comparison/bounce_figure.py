"""What the project is about: the first bounce, its angles and the friction in it."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from harness.core.bounce import Bounce
from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion
from harness.studies.comparison.selection import MS, digests, label, longest

ANGLES = {"phi": "Nutation phi", "psi": "Precession psi", "theta": "Rotation theta"}


def degrees(name: str) -> Callable[[Motion], Floats]:
    """Return what reads an angle of a motion, deg."""
    return lambda motion: np.degrees(getattr(motion.angles, name))


_WINDOW = 12.0
"""Half-width of the zoom in 1/(peak precession rate): the turn is then 94 % done."""

_FEW = 40
"""Samples in the zoom up to which each is marked by a point."""

_ENDS = 2
"""Points of a curve in the zoom that are no samples: where it enters and where it leaves."""


def bounce_figure(scene: str, drawn: Sequence[Evaluation]) -> Figure | None:
    """Return the angles in the first bounce, each run against its own time of bounce."""
    true = first_bounce(drawn)
    if true is None:
        return None
    panels = [
        Panel(
            title=title,
            x_label="time from the bounce [ms]",
            y_label=f"{name} [deg]",
            series=in_bounce(drawn, true, degrees(name)),
            log_y=name == "phi",
        )
        for name, title in ANGLES.items()
    ]
    turn, width = math.degrees(true.angle_of_turn), 2.0 / abs(true.peak_psi_dot)
    return Figure(
        name=f"{scene}-bounce",
        title="The first bounce",
        seen=(
            f"In {_duration(width)} about the bounce the can turns by {_within(drawn, true):.0f} "
            f"of its {turn:.2f} degrees, while phi turns back at {true.phi_min:.2g} rad. "
            f"{_turns(drawn, turn)}"
        ),
        panels=tuple(panels),
        columns=3,
        scene=scene,
        cases=digests(drawn),
    )


def first_bounce(drawn: Sequence[Evaluation]) -> Bounce | None:
    """Return the first exact bounce, or None where there is none to look into."""
    true = next((e.true_bounces[0] for e in drawn if e.true_bounces), None)
    return None if true is None or true.peak_psi_dot == 0.0 else true


def in_bounce(
    drawn: Sequence[Evaluation], true: Bounce, values: Callable[[Motion], Floats]
) -> tuple[Series, ...]:
    """Return a quantity of all runs in the first bounce, each by its own clock."""
    half = _WINDOW / abs(true.peak_psi_dot)
    series: list[Series] = []
    exact = longest(drawn).truth
    if exact is not None:
        x, y = _near(exact.time - true.time, values(exact), half)
        series.append(Series(label="exact", kind="reference", x=x, y=y))
    for e in drawn:
        if e.motion is None or not e.bounces:
            continue
        x, y = _near(e.motion.time - e.bounces[0].time, values(e.motion), half)
        series.append(
            Series(
                label=label(e),
                kind=e.simulation.case.engine,
                x=x,
                y=y,
                dashed=e.simulation.case.profile == "default",
                mark="both" if _ENDS < len(x) < _FEW else "line",
            )
        )
    return tuple(series)


def _within(drawn: Sequence[Evaluation], true: Bounce) -> float:
    """Return how far the exact can turns within 1/(peak precession rate) of the bounce, deg."""
    exact = longest(drawn).truth
    if exact is None:
        return math.nan
    ends = true.time + np.array((-1.0, 1.0)) / abs(true.peak_psi_dot)
    first, last = np.interp(ends, exact.time, exact.angles.psi)
    return math.degrees(float(last - first))


def _near(time: Floats, values: Floats, half: float) -> tuple[Floats, Floats]:
    """Return a curve within a window about time zero, ms, cut where it enters and leaves.

    A run that steps over the window altogether is seen to do so.
    """
    inside = np.abs(time) < half
    edges = np.clip((-half, half), time[0], time[-1])
    x = np.concatenate((edges[:1], time[inside], edges[1:]))
    return x * MS, np.interp(x, time, values)


def _duration(seconds: float) -> str:
    """Return a short time in the unit that suits it."""
    for unit, size in (("ms", 1e-3), ("microseconds", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds * 1e9:.2g} nanoseconds"


def _turns(drawn: Sequence[Evaluation], turn: float) -> str:
    """Return a sentence on who turned most nearly as far, and who least."""
    turned = sorted(
        (
            (math.degrees(e.bounces[0].angle_of_turn) - turn, e.bounces[0].resolved, label(e))
            for e in drawn
            if e.bounces
        ),
        key=lambda found: (not found[1], abs(found[0])),
    )
    if not turned:
        return "No run completes the bounce."
    nearest = f"Nearest is {_off(*turned[0])}"
    lost = len(drawn) - len(turned)
    told = f"; {lost} of {len(drawn)} runs do not complete the bounce" if lost else ""
    if len(turned) == 1:
        return f"{nearest}{told}."
    return f"{nearest}, farthest {_off(*turned[-1])}{told}."


def _off(error: float, resolved: bool, name: str) -> str:  # noqa: FBT001 - a field of a bounce
    doubt = "" if resolved else ", too coarse to count its turns"
    return f"{name}, off by {error:+.2g} degrees{doubt}"
