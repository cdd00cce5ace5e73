"""The figure of convergence: errors against the timestep."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from harness.artefact import Figure, Panel, Series
from harness.metrics.order import observed_order
from harness.runner import Evaluation
from harness.studies.comparison.curves import digests


def convergence_figure(scene: str, evaluations: Sequence[Evaluation]) -> Figure | None:
    """Return errors against the timestep, with every run as a point."""
    ladders: dict[tuple[str, str], list[Evaluation]] = {}
    for e in evaluations:
        if e.errors is not None and e.simulation.timestep is not None:
            ladders.setdefault((e.simulation.case.engine, e.simulation.case.profile), []).append(e)
    if all(len({e.simulation.timestep for e in own}) == 1 for own in ladders.values()):
        return None
    panels = []
    for title, label, read in _QUANTITIES:
        series = []
        for (engine, profile), ladder in ladders.items():
            points = sorted((e.simulation.timestep, abs(read(e))) for e in ladder)
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
                    y_label=label,
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
        (_phi(e), f"{engine}, {profile}") for (engine, profile), own in ladders.items() for e in own
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
    return observed_order(steps, [_phi(e) for e in ladder]).order


def _turn(e: Evaluation) -> float:
    """Return the error of the first angle of turn, deg."""
    if e.errors is None or not e.errors.angle_of_turn:
        return math.nan
    return math.degrees(e.errors.angle_of_turn[0])


def _phi(e: Evaluation) -> float:
    """Return the root mean square error of phi, rad."""
    return math.nan if e.errors is None else e.errors.phi_rms


_QUANTITIES: tuple[tuple[str, str, Callable[[Evaluation], float]], ...] = (
    ("Nutation", "phi, rms [rad]", _phi),
    ("Angle of turn", "error of the turn [deg]", _turn),
)
