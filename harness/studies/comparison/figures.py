"""The comparison in figures: bounce, angles, locus, friction and errors of a scene.

The first bounce is what the project is about: its angles, and the friction in it. The figure of
convergence draws errors against the timestep or the accuracy.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from harness.core.bounce import Bounce
from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion
from harness.studies.comparison.convergence import convergence
from harness.studies.comparison.selection import (
    MM,
    MS,
    contacts,
    curve,
    digests,
    drawn_runs,
    exact_curve,
    followed_best,
    label,
    left_undrawn,
    longest,
)

_ANGLES = {"phi": "Nutation phi", "psi": "Precession psi", "theta": "Rotation theta"}

_WINDOW = 12.0
"""Half-width of the zoom in 1/(peak precession rate): the turn is then 94 % done."""

_FEW = 40
"""Samples in the zoom up to which each is marked by a point."""

_ENDS = 2
"""Points of a curve in the zoom that are no samples: where it enters and where it leaves."""


def scene_figures(
    scene: str, evaluations: Sequence[Evaluation], runs: Sequence[Evaluation] | None = None
) -> tuple[Figure, ...]:
    """Return the figures of one scene.

    Parameters
    ----------
    scene : str
    evaluations : sequence of Evaluation
        All of this scene, of every engine; those without a motion are left out.
    runs : sequence of Evaluation, optional
        Those of which curves are drawn, each with a motion; `drawn_runs` if left out.
    """
    drawn = drawn_runs(evaluations) if runs is None else runs
    if not drawn:
        return ()
    # an exact can that falls in a plane does not turn, and has no inner region to look into
    true = next((e.true_bounces[0] for e in drawn if e.true_bounces), None)
    true = None if true is None or true.peak_psi_dot == 0.0 else true
    of_drawn = (
        *(() if true is None else (_bounce(scene, drawn, true),)),
        _angles(scene, drawn),
        _locus(scene, drawn),
        _friction(scene, drawn, true),
        _residuals(scene, drawn),
    )
    if left := left_undrawn(evaluations, drawn):
        of_drawn = tuple(replace(figure, seen=f"{figure.seen} {left}") for figure in of_drawn)
    errors = convergence(scene, evaluations)
    return of_drawn if errors is None else (*of_drawn, errors)


def _figure(
    scene: str,
    name: str,
    title: str,
    drawn: Sequence[Evaluation],
    panels: Sequence[Panel],
    *,
    seen: str,
    columns: int = 2,
) -> Figure:
    """Return a figure of runs of a scene."""
    return Figure(
        name=f"{scene}-{name}",
        title=title,
        seen=seen,
        panels=tuple(panels),
        columns=columns,
        scene=scene,
        cases=digests(drawn),
    )


def _angle(name: str) -> Callable[[Motion], Floats]:
    """Return a function that reads an angle of a motion, deg."""
    return lambda motion: np.degrees(getattr(motion.angles, name))


def _bounce(scene: str, drawn: Sequence[Evaluation], true: Bounce) -> Figure:
    """Return the angles in the first bounce, each run against its own time of bounce."""
    panels = [
        Panel(
            title=title,
            x_label="time from the bounce [ms]",
            y_label=f"{name} [deg]",
            series=_in_bounce(drawn, true, _angle(name)),
            log_y=name == "phi",
        )
        for name, title in _ANGLES.items()
    ]
    turn, width = math.degrees(true.angle_of_turn), 2.0 / abs(true.peak_psi_dot)
    seen = (
        f"In {_duration(width)} about the bounce the can turns by {_within(drawn, true):.0f} "
        f"of its {turn:.2f} degrees, while phi turns back at {true.phi_min:.2g} rad. "
        f"{_turns(contacts(drawn), turn)}"
    )
    return _figure(scene, "bounce", "The first bounce", drawn, panels, seen=seen, columns=3)


def _in_bounce(
    drawn: Sequence[Evaluation], true: Bounce, values: Callable[[Motion], Floats]
) -> tuple[Series, ...]:
    """Return a quantity of all runs in the first bounce, each by its own clock."""
    half = _WINDOW / abs(true.peak_psi_dot)
    series: list[Series] = []
    exact = longest(drawn).truth
    if exact is not None:
        series.append(exact_curve(*_near(exact.time - true.time, values(exact), half)))
    for e in drawn:
        if e.motion is not None and e.bounces:
            x, y = _near(e.motion.time - e.bounces[0].time, values(e.motion), half)
            series.append(curve(e, x, y, "both" if _ENDS < len(x) < _FEW else "line"))
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
        key=lambda run: (not run[1], abs(run[0])),
    )
    if not turned:
        return "No run completes the bounce."
    nearest = f"Nearest is {_off(*turned[0])}"
    lost = len(drawn) - len(turned)
    rest = f"; {lost} of {len(drawn)} runs do not complete the bounce" if lost else ""
    if len(turned) == 1:
        return f"{nearest}{rest}."
    return f"{nearest}, farthest {_off(*turned[-1])}{rest}."


def _off(error: float, resolved: bool, name: str) -> str:  # noqa: FBT001 - a field of a bounce
    doubt = "" if resolved else ", too coarse to count its turns"
    return f"{name}, off by {error:+.2g} degrees{doubt}"


def _overlaid(
    drawn: Sequence[Evaluation], read: Callable[[Motion], Floats], x: Callable[[Motion], Floats]
) -> tuple[Series, ...]:
    """Return the truth's curve and then every run's."""
    exact = longest(drawn).truth
    series = [] if exact is None else [exact_curve(x(exact), read(exact))]
    series += [curve(e, x(e.motion), read(e.motion)) for e in drawn if e.motion is not None]
    return tuple(series)


def _ms(motion: Motion) -> Floats:
    return motion.time * MS


def _angles(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the three angles over the whole run."""
    panels = [
        Panel(
            title=title,
            x_label="time [ms]",
            y_label=f"{name} [deg]",
            series=_overlaid(drawn, _angle(name), _ms),
        )
        for name, title in _ANGLES.items()
    ]
    title = "The angles over the whole run"
    seen = followed_best(drawn) or _closest(contacts(drawn))
    return _figure(scene, "angles", title, drawn, panels, seen=seen, columns=3)


def _extremes(drawn: Sequence[Evaluation]) -> tuple[Evaluation, Evaluation]:
    """Return the runs with the smallest and the largest error of phi."""
    best = min(drawn, key=lambda e: e.errors.phi_rms if e.errors else math.inf)
    return best, max(drawn, key=lambda e: e.errors.phi_rms if e.errors else 0.0)


def _size(e: Evaluation, name: str) -> str:
    """Return an error of a run in words."""
    return f"{getattr(e.errors, name):.2g}" if e.errors else "no"


def _closest(drawn: Sequence[Evaluation]) -> str:
    best, worst = _extremes(drawn)
    return (
        f"Closest to the exact motion is {label(best)}, with {_size(best, 'phi_rms')} rad rms in "
        f"phi. Farthest is {label(worst)}, with {_size(worst, 'phi_rms')} rad."
    )


def _locus(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the contact locus from above."""
    series = _overlaid(drawn, lambda m: m.locus[:, 1] * MM, lambda m: m.locus[:, 0] * MM)
    panel = Panel(
        title="Contact locus", x_label="x [mm]", y_label="y [mm]", series=series, equal=True
    )
    seen = (
        "Each engine's locus is the centre of its contact points, weighted with their forces. "
        f"{_apart(contacts(drawn))}"
    )
    title = "The contact locus from above"
    return _figure(scene, "locus", title, drawn, [panel], seen=seen, columns=1)


def _apart(drawn: Sequence[Evaluation]) -> str:
    """Return a sentence on the nearest and the farthest locus."""
    apart = sorted(
        (e.errors.contact_locus_hausdorff * MM, label(e)) for e in drawn if e.errors is not None
    )
    if not apart:
        return "The scene is chaotic, and no locus follows the exact one to its end."
    (nearest, best), (farthest, worst) = apart[0], apart[-1]
    return (
        f"That of {best} is within {nearest:.2g} mm of the exact curve, that of {worst} "
        f"as much as {farthest:.2g} mm away."
    )


def _friction(scene: str, drawn: Sequence[Evaluation], true: Bounce | None) -> Figure:
    """Return the friction ratio over time."""
    exact = longest(drawn).truth
    # no number of a can that has not landed yet
    peak = np.fmax.reduce(exact.friction_ratio) if exact is not None else math.nan
    slip = drawn[0].simulation.case.scene.effects.slip
    if any(e.truth_pulls for e in drawn):
        second = "In places the exact motion asks the plane to pull; a can only pushed lifts off."
    elif slip is not None:
        second = (
            f"The plane gives {slip.mu:g} at most; the exact can slips where it would need more."
        )
    elif not math.isfinite(peak):
        second = "The exact can does not press on the plane here."
    else:
        second = f"Rolling without slipping asks for a friction coefficient of {peak:.3f} here."
    panels = [
        Panel(
            title="The whole run" if true is None else "The whole run (outer region)",
            x_label="time [ms]",
            y_label="|F|/N [1]",
            series=_overlaid(drawn, lambda m: m.friction_ratio, _ms),
        )
    ]
    if true is not None:
        panels.append(
            Panel(
                title="The first bounce (inner region)",
                x_label="time from the bounce [ms]",
                y_label="|F|/N [1]",
                series=_in_bounce(drawn, true, lambda m: m.friction_ratio),
            )
        )
    seen = f"|F|/N from each engine's own contact forces against the exact ratio. {second}"
    title = "The friction ratio"
    return _figure(scene, "friction", title, drawn, panels, seen=seen, columns=len(panels))


def _residuals(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the error of phi and the distance of the contact points over time."""
    tilt: list[Series] = []
    locus: list[Series] = []
    for e in drawn:
        if e.motion is not None and e.truth is not None:
            n = len(e.truth.time)
            phi = np.abs(e.motion.angles.phi[:n] - e.truth.angles.phi)
            distance = np.linalg.norm(e.motion.locus[:n] - e.truth.locus, axis=1) * MM
            for series, y in ((tilt, phi), (locus, distance)):
                series.append(curve(e, _ms(e.truth), np.where(y > 0.0, y, np.nan)))
    panels = [
        Panel(title=title, x_label="time [ms]", y_label=y_label, series=tuple(series), log_y=True)
        for title, y_label, series in (
            ("Nutation", "error of phi [rad]", tilt),
            ("Contact point", "distance [mm]", locus),
        )
    ]
    return _figure(
        scene, "residuals", "Errors over time", drawn, panels, seen=_residual_sizes(contacts(drawn))
    )


def _residual_sizes(drawn: Sequence[Evaluation]) -> str:
    """Return a sentence on the largest and the smallest errors over time."""
    known = [e for e in drawn if e.errors is not None]
    if not known:
        return followed_best(drawn)
    best, worst = _extremes(known)
    first = (
        f"The distance from the exact motion at the same instant: {label(best)} stays within "
        f"{_size(best, 'phi_max')} rad in phi, {label(worst)} within {_size(worst, 'phi_max')} rad."
    )
    if worst.errors is None or not math.isfinite(worst.errors.phi_rms_after):
        return f"{first} There is no bounce at which an error could be made."
    before, after = worst.errors.phi_rms_before, worst.errors.phi_rms_after
    return (
        f"{first} Of the latter, {before:.2g} rad rms are made before the first bounce, "
        f"{after:.2g} rad after it."
    )
