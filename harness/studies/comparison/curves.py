"""Curves that the figures of the comparison share: which runs are drawn, how they are called."""

import math
from collections.abc import Callable, Iterator, Sequence

from harness.artefact import Series
from harness.metrics.motion import Motion
from harness.runner import Evaluation
from harness.trajectory import Floats

MS = 1e3
"""Milliseconds in a second."""

MM = 1e3
"""Millimetres in a metre."""


def finest(evaluations: Sequence[Evaluation]) -> tuple[Evaluation, ...]:
    """Return of each scene and engine the run of each profile with the smallest timestep."""
    best: dict[tuple[str, str, str], Evaluation] = {}
    for e in evaluations:
        case, step = e.simulation.case, e.simulation.timestep or math.inf
        name = (case.scene.name, case.engine, case.profile)
        kept = best.get(name)
        if kept is None or step < (kept.simulation.timestep or math.inf):
            best[name] = e
    return tuple(best.values())


def drawn_runs(evaluations: Sequence[Evaluation]) -> Iterator[Evaluation]:
    """Yield of each engine the run of each profile with the smallest timestep, as shipped last."""
    known = finest([e for e in evaluations if _comparable(e)])
    yield from sorted(known, key=lambda e: e.simulation.case.profile == "default")


def _comparable(e: Evaluation) -> bool:
    return e.motion is not None and e.truth is not None and e.simulation.timestep is not None


def label(e: Evaluation) -> str:
    """Return what the legend calls a run."""
    case = e.simulation.case
    if case.profile == "adaptive":
        return f"{case.engine}, adaptive"
    return f"{case.engine}, {case.profile}, {e.simulation.timestep:.2g} s"


def digests(drawn: Sequence[Evaluation]) -> tuple[str, ...]:
    """Return the names of the cases that are drawn."""
    return tuple(e.simulation.case.digest(e.simulation.engine_version) for e in drawn)


def longest(drawn: Sequence[Evaluation]) -> Evaluation:
    """Return the run with the densest truth, to draw the truth from."""
    return max(drawn, key=lambda e: len(e.truth.time) if e.truth else 0)


def overlaid(
    drawn: Sequence[Evaluation], curve: Callable[[Motion], tuple[Floats, Floats]]
) -> tuple[Series, ...]:
    """Return the truth's curve and then every run's."""
    exact = longest(drawn).truth
    series = []
    if exact is not None:
        x, y = curve(exact)
        series.append(Series(label="exact", kind="reference", x=x, y=y))
    for e in drawn:
        if e.motion is not None:
            x, y = curve(e.motion)
            shipped = e.simulation.case.profile == "default"
            kind = e.simulation.case.engine
            series.append(Series(label=label(e), kind=kind, x=x, y=y, dashed=shipped))
    return tuple(series)
