"""Curves that the figures of the comparison share: which runs are drawn, how they are called.

Runs that cannot be held against the truth to their end: failed ones, and chaotic ones.

A run of a chaotic scene is followed for as long as it stays near the exact motion.
"""

import math
from collections.abc import Callable, Iterator, Sequence

from harness.core.report_model import Series
from harness.core.simulation import Outcome
from harness.core.trajectory import Floats
from harness.core.verdict import Status, Verdict
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion

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


_MOVED = frozenset({Outcome.FINISHED, Outcome.FLAT, Outcome.OVERTURNED, Outcome.TIMED_OUT})
"""Endings of a can's motion: once it has parted from the exact one, none of them is a failure."""

_OWN_ERROR = 1e-5
"""rad: what the best engine's run of a bounce is off by."""


def chaotic(e: Evaluation) -> bool:
    """Whether what differs in the end of a run is no error."""
    return e.divergence is not None and e.divergence.chaotic and e.simulation.outcome in _MOVED


def ended(e: Evaluation) -> Verdict | None:
    """Return the verdict on a run that cannot be held against the truth to its end."""
    if chaotic(e):
        return _followed(e)
    outcome = e.simulation.outcome
    if outcome is Outcome.FINISHED:
        return None
    return Verdict(Status.FAILED, f"failed: {outcome.name.lower().replace('_', ' ')}")


def _followed(e: Evaluation) -> Verdict:
    """Return how long a run of a chaotic scene stays near the exact motion."""
    how_long = (
        "and never 0.1 rad from the exact motion"
        if e.parts_at is None
        else f"parts after {e.parts_at:.3g} s"
    )
    return Verdict(Status.UNDECIDABLE, f"not decidable: chaotic, {how_long}")


def followed_best(evaluations: Sequence[Evaluation]) -> str:
    """Return two sentences on the runs of a chaotic scene; nothing of any other."""
    found = [e for e in finest(evaluations) if chaotic(e)]
    if not found or found[0].divergence is None:
        return ""
    chaos = found[0].divergence
    first = (
        f"The scene is chaotic: a disturbance grows by e in {chaos.lyapunov_time:.2g} s, and one "
        f"of {_OWN_ERROR:g} is as large as the motion after "
        f"{chaos.decidable_until(_OWN_ERROR):.2g} s."
    )
    parted = [(e.parts_at, label(e)) for e in found if e.parts_at is not None]
    if not parted:
        return f"{first} No run parts from the exact motion."
    (soon, one), (late, other) = min(parted), max(parted)
    return (
        f"{first} {other} stays within 0.1 rad of the exact motion for {late:.2g} s, {one} for "
        f"{soon:.2g} s."
    )
