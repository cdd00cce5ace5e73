"""The figure of convergence: errors against the timestep."""

import math
from collections.abc import Callable, Sequence

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
    if all(len(ladder) < 2 for ladder in ladders.values()):  # noqa: PLR2004 - a line has two ends
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
        seen=" ".join(_told(*ladder) for ladder in ladders.items()),
        panels=tuple(panels),
        scene=scene,
        cases=digests(evaluations),
    )


def _told(name: tuple[str, str], ladder: Sequence[Evaluation]) -> str:
    """Return a sentence on how the error of phi falls."""
    engine, profile = name
    points = sorted((e.simulation.timestep or math.nan, _phi(e)) for e in ladder)
    (finest, least), (coarsest, most) = points[0], points[-1]
    if len(points) == 1:
        return f"{engine}, {profile}, has one timestep, with an error of phi of {least:.2g} rad."
    order = observed_order([step for step, _ in points], [error for _, error in points])
    return (
        f"From {coarsest:.2g} s to {finest:.2g} s the error of phi in {engine}, {profile}, goes "
        f"from {most:.2g} to {least:.2g} rad, an order of {order.order:.2g}."
    )


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
