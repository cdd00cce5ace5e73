"""The comparison in figures: the angles, the locus, the friction and the errors of a scene.

The figure of convergence: errors against the timestep.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.convergence import observed_order
from harness.metrics.motion import Motion
from harness.metrics.quantities import QUANTITIES
from harness.studies.comparison.bounce_figure import (
    ANGLES,
    bounce_figure,
    degrees,
    first_bounce,
    in_bounce,
)
from harness.studies.comparison.selection import (
    MM,
    MS,
    digests,
    drawn_runs,
    followed_best,
    label,
    longest,
    overlaid,
)


def convergence_figure(scene: str, evaluations: Sequence[Evaluation]) -> Figure | None:
    """Return errors against the timestep, with every run as a point."""
    ladders: dict[tuple[str, str], list[Evaluation]] = {}
    for e in evaluations:
        if e.errors is not None and e.simulation.timestep is not None:
            ladders.setdefault((e.simulation.case.engine, e.simulation.case.profile), []).append(e)
    if all(len({e.simulation.timestep for e in own}) == 1 for own in ladders.values()):
        return None
    panels = []
    for title, y_label, key in _QUANTITIES:
        series = []
        for (engine, profile), ladder in ladders.items():
            points = sorted((e.simulation.timestep, abs(_error(e, key))) for e in ladder)
            x, y = np.array(points).T
            series.append(
                Series(
                    label=f"{engine}, {profile}",
                    kind=engine,
                    x=x,
                    y=np.where(y > 0.0, y, np.nan),
                    mark="both",
                    dashed=profile == "default",
                )
            )
        if any(np.isfinite(s.y).any() for s in series):
            panels.append(
                Panel(
                    title=title,
                    x_label="timestep [s]",
                    y_label=y_label,
                    series=tuple(series),
                    log_x=True,
                    log_y=True,
                )
            )
    return Figure(
        name=f"{scene}-convergence",
        title="Errors against the timestep",
        seen=_seen(ladders),
        panels=tuple(panels),
        scene=scene,
        cases=digests(evaluations),
    )


def _seen(ladders: Mapping[tuple[str, str], Sequence[Evaluation]]) -> str:
    """Return two sentences: whose error is smallest and largest, and how errors fall."""
    every = [
        (_phi_error(e), f"{engine}, {profile}")
        for (engine, profile), own in ladders.items()
        for e in own
    ]
    (least, best), (most, worst) = min(every), max(every)
    falls = [
        f"{_order(own):.2g} in {engine}, {profile}"
        for (engine, profile), own in ladders.items()
        if len({e.simulation.timestep for e in own}) > 1
    ]
    return (
        f"The error of phi is smallest in {best}, {least:.2g} rad, and largest in {worst}, "
        f"{most:.2g} rad. It goes with the timestep to the power of {' and '.join(falls)}."
    )


def _order(ladder: Sequence[Evaluation]) -> float:
    steps = [e.simulation.timestep or math.nan for e in ladder]
    return observed_order(steps, [_phi_error(e) for e in ladder]).order


def _phi_error(e: Evaluation) -> float:
    """Return the root mean square error of phi, rad."""
    return _error(e, "phi_rms_rad")


def _error(e: Evaluation, key: str) -> float:
    """Return an error of a run; NaN where it has none."""
    error = QUANTITIES[key].of_run(e)
    return math.nan if error is None else error


_QUANTITIES = (
    ("Nutation", "phi, rms [rad]", "phi_rms_rad"),
    ("Angle of turn", "error of the turn [deg]", "angle_of_turn_error_deg"),
)


def scene_figures(scene: str, evaluations: Sequence[Evaluation]) -> tuple[Figure, ...]:
    """Return the figures of one scene.

    Parameters
    ----------
    scene : str
    evaluations : sequence of Evaluation
        All of this scene, of every engine; those without a motion are left out.
    """
    drawn = tuple(drawn_runs(evaluations))
    if not drawn:
        return ()
    return tuple(
        figure
        for figure in (
            bounce_figure(scene, drawn),
            _angles(scene, drawn),
            _locus(scene, drawn),
            _friction(scene, drawn),
            _residuals(scene, drawn),
            convergence_figure(scene, evaluations),
        )
        if figure is not None
    )


def _over_time(read: Callable[[Motion], Floats]) -> Callable[[Motion], tuple[Floats, Floats]]:
    """Return what reads a curve over time, ms."""
    return lambda motion: (motion.time * MS, read(motion))


def _angles(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the three angles over the whole run."""
    panels = tuple(
        Panel(
            title=title,
            x_label="time [ms]",
            y_label=f"{name} [deg]",
            series=overlaid(drawn, _over_time(degrees(name))),
        )
        for name, title in ANGLES.items()
    )
    return Figure(
        name=f"{scene}-angles",
        title="The angles over the whole run",
        seen=followed_best(drawn) or _closest(drawn),
        panels=panels,
        columns=3,
        scene=scene,
        cases=digests(drawn),
    )


def _extremes(drawn: Sequence[Evaluation]) -> tuple[Evaluation, Evaluation]:
    """Return the runs with the smallest and the largest error of phi."""
    best = min(drawn, key=lambda e: e.errors.phi_rms if e.errors else math.inf)
    return best, max(drawn, key=lambda e: e.errors.phi_rms if e.errors else 0.0)


def _closest(drawn: Sequence[Evaluation]) -> str:
    best, worst = _extremes(drawn)
    return (
        f"Closest to the exact motion is {label(best)}, with {_phi(best)} rad rms in phi. "
        f"Farthest is {label(worst)}, with {_phi(worst)} rad."
    )


def _phi(e: Evaluation) -> str:
    return f"{e.errors.phi_rms:.2g}" if e.errors else "no"


def _locus(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the contact locus from above."""
    series = overlaid(drawn, lambda m: (m.locus[:, 0] * MM, m.locus[:, 1] * MM))
    return Figure(
        name=f"{scene}-locus",
        title="The contact locus from above",
        seen=(
            "Each engine's locus is the centre of its contact points, weighted with their forces. "
            f"{_apart(drawn)}"
        ),
        panels=(
            Panel(
                title="Contact locus", x_label="x [mm]", y_label="y [mm]", series=series, equal=True
            ),
        ),
        columns=1,
        scene=scene,
        cases=digests(drawn),
    )


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


def _friction(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the friction ratio over time."""
    series = overlaid(drawn, _over_time(lambda m: m.friction_ratio))
    exact = longest(drawn).truth
    peak = np.nanmax(exact.friction_ratio) if exact is not None else math.nan
    slip = drawn[0].simulation.case.scene.effects.slip
    if drawn[0].truth_pulls:
        second = "In places the exact motion asks the plane to pull; a can only pushed lifts off."
    elif slip is not None:
        second = (
            f"The plane gives {slip.mu:g} at most; the exact can slips where it would need more."
        )
    else:
        second = f"Rolling without slipping asks for a friction coefficient of {peak:.3f} here."
    panels = [Panel(title="The whole run", x_label="time [ms]", y_label="|F|/N [1]", series=series)]
    true = first_bounce(drawn)
    if true is not None:
        panels.append(
            Panel(
                title="The first bounce (inner region)",
                x_label="time from the bounce [ms]",
                y_label="|F|/N [1]",
                series=in_bounce(drawn, true, lambda m: m.friction_ratio),
            )
        )
        panels[0] = replace(panels[0], title="The whole run (outer region)")
    return Figure(
        name=f"{scene}-friction",
        title="The friction ratio",
        seen=f"|F|/N from each engine's own contact forces against the exact ratio. {second}",
        panels=tuple(panels),
        columns=len(panels),
        scene=scene,
        cases=digests(drawn),
    )


def _residuals(scene: str, drawn: Sequence[Evaluation]) -> Figure:
    """Return the error of phi and the distance of the contact points over time."""
    tilt: list[Series] = []
    locus: list[Series] = []
    for e in drawn:
        if e.motion is None or e.truth is None:
            continue
        n = len(e.truth.time)
        x, shipped = e.truth.time * MS, e.simulation.case.profile == "default"
        phi = np.abs(e.motion.angles.phi[:n] - e.truth.angles.phi)
        distance = np.linalg.norm(e.motion.locus[:n] - e.truth.locus, axis=1) * MM
        for series, y in ((tilt, phi), (locus, distance)):
            series.append(
                Series(
                    label=label(e),
                    kind=e.simulation.case.engine,
                    x=x,
                    y=np.where(y > 0.0, y, np.nan),
                    dashed=shipped,
                )
            )
    return Figure(
        name=f"{scene}-residuals",
        title="Errors over time",
        seen=_told(drawn),
        panels=(
            Panel(
                title="Nutation",
                x_label="time [ms]",
                y_label="error of phi [rad]",
                series=tuple(tilt),
                log_y=True,
            ),
            Panel(
                title="Contact point",
                x_label="time [ms]",
                y_label="distance [mm]",
                series=tuple(locus),
                log_y=True,
            ),
        ),
        scene=scene,
        cases=digests(drawn),
    )


def _told(drawn: Sequence[Evaluation]) -> str:
    """Return where the errors of the farthest run are made, and how small they can be."""
    known = [e for e in drawn if e.errors is not None]
    if not known:
        return followed_best(drawn)
    best, worst = _extremes(known)
    first = (
        f"The distance from the exact motion at the same instant: {label(best)} stays within "
        f"{_most(best)} rad in phi, {label(worst)} within {_most(worst)} rad."
    )
    if worst.errors is None or not math.isfinite(worst.errors.phi_rms_after):
        return f"{first} There is no bounce at which an error could be made."
    before, after = worst.errors.phi_rms_before, worst.errors.phi_rms_after
    return (
        f"{first} Of the latter, {before:.2g} rad rms are made before the first bounce, "
        f"{after:.2g} rad after it."
    )


def _most(e: Evaluation) -> str:
    return f"{e.errors.phi_max:.2g}" if e.errors else "no"
