"""Curves that the figures of the comparison share: which runs are drawn, how they are called.

Runs that cannot be held against the truth to their end: failed ones, and chaotic ones.

A run of a chaotic scene is followed for as long as it stays near the exact motion.
"""

import math
from collections.abc import Sequence
from typing import Literal

from harness.core.report_model import Series
from harness.core.simulation import Outcome
from harness.core.trajectory import Floats
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import fineness, finer_by, rung_words
from harness.engines.registry import is_constraint
from harness.evaluation.evaluation import Evaluation

MS = 1e3
"""Milliseconds in a second."""

MM = 1e3
"""Millimetres in a metre."""


EXACT = "exact"
"""Legend entry of the exact motion."""


def by_case(
    evaluations: Sequence[Evaluation], *names: str
) -> dict[tuple[str, ...], list[Evaluation]]:
    """Return runs in groups, by one or several of "scene", "engine" and "profile"."""
    groups: dict[tuple[str, ...], list[Evaluation]] = {}
    for e in evaluations:
        case = e.simulation.case
        key = {"scene": case.scene.name, "engine": case.engine, "profile": case.profile}
        groups.setdefault(tuple(key[name] for name in names), []).append(e)
    return groups


def finest(evaluations: Sequence[Evaluation]) -> tuple[Evaluation, ...]:
    """Return of each scene and engine the finest run of each profile."""
    return tuple(
        min(own, key=lambda e: fineness(e.simulation) or math.inf)
        for own in by_case(evaluations, "scene", "engine", "profile").values()
    )


def contacts(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Return the runs that are ranked: of engines with contacts, or of constraints alone."""
    found = [e for e in evaluations if not is_constraint(e.simulation.case.engine)]
    return found or list(evaluations)


MANY = 3
"""Engines beyond which a figure has no room for the runs of all profiles of all."""

_NEAREST, _FARTHEST = 4, 2
"""Of many engines, those that are drawn."""


def drawn_runs(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Return of each engine the finest run of each profile, as shipped last.

    Of many engines the best run of each, and of these the nearest and the farthest.
    """
    known = finest([e for e in evaluations if e.motion and e.truth and label(e) != EXACT])
    if len(by_case(known, "engine")) <= MANY:
        return sorted(known, key=lambda e: e.simulation.case.profile == "default")
    best = [min(own, key=_distance) for own in by_case(contacts(known), "engine").values()]
    best.sort(key=_distance)
    return best if len(best) <= _NEAREST + _FARTHEST else best[:_NEAREST] + best[-_FARTHEST:]


def left_undrawn(evaluations: Sequence[Evaluation], drawn: Sequence[Evaluation]) -> str:
    """Return a sentence on the engines of which a figure has no curve; nothing where it has all."""
    engines = set(by_case(evaluations, "engine")) - set(by_case(drawn, "engine"))
    if not engines:
        return ""
    names = ", ".join(sorted(name for (name,) in engines))
    return f"Drawn are the contacts nearest to the exact motion and farthest from it, not {names}."


def _distance(e: Evaluation) -> float:
    """Return how far a run is from the exact motion: rad rms of phi."""
    return e.errors.phi_rms if e.errors is not None else math.inf


def label(e: Evaluation) -> str:
    """Return the legend entry of a run."""
    case, setting = e.simulation.case, finer_by(e.simulation.case.engine)
    if case.engine == "reference":
        return EXACT
    settings = "".join(f", {name}={v}" for name, v in case.shown_options if name != setting)
    if case.profile == "adaptive":
        return f"{case.engine}, adaptive{settings}"
    step = rung_words(e.simulation)
    return f"{case.engine}, {case.profile}{', ' if step else ''}{step}{settings}"


def digests(drawn: Sequence[Evaluation]) -> tuple[str, ...]:
    """Return the names of the cases that are drawn."""
    return tuple(e.simulation.digest for e in drawn)


def longest(drawn: Sequence[Evaluation]) -> Evaluation:
    """Return the run with the densest truth, to draw the truth from."""
    return max(drawn, key=lambda e: len(e.truth.time) if e.truth else 0)


def curve(
    e: Evaluation, x: Floats, y: Floats, mark: Literal["line", "both"] = "line", name: str = ""
) -> Series:
    """Return a curve of a run, or of several under a name; dashed if the engine ran as shipped."""
    case = e.simulation.case
    dashed = case.profile == "default"
    return Series(label=name or label(e), kind=case.engine, x=x, y=y, mark=mark, dashed=dashed)


def exact_curve(x: Floats, y: Floats) -> Series:
    """Return a curve of the exact motion."""
    return Series(label=EXACT, kind="reference", x=x, y=y)


_MOVED = frozenset(
    {
        *(Outcome.FINISHED, Outcome.FLAT, Outcome.OVERTURNED),
        *(Outcome.TIMED_OUT, Outcome.ENDED_EARLY),
    }
)
"""Endings of a can's motion: once it has parted from the exact one, none of them is a failure."""

_OWN_ERROR = 1e-5
"""rad: error of the best engine's run of a bounce."""


def chaotic(e: Evaluation) -> bool:
    """Whether a run is chaotic and moved, so that its difference in the end is no error."""
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
    runs = [e for e in finest(evaluations) if chaotic(e)]
    if not runs or runs[0].divergence is None:
        return ""
    chaos = runs[0].divergence
    first = (
        f"The scene is chaotic: a disturbance grows by e in {chaos.lyapunov_time:.2g} s, and one "
        f"of {_OWN_ERROR:g} is as large as the motion after "
        f"{chaos.decidable_until(_OWN_ERROR):.2g} s."
    )
    parted = [(e.parts_at, label(e)) for e in runs if e.parts_at is not None]
    if not parted:
        return f"{first} No run parts from the exact motion."
    (soon, one), (late, other) = min(parted), max(parted)
    return (
        f"{first} {other} stays within 0.1 rad of the exact motion for {late:.2g} s, {one} for "
        f"{soon:.2g} s."
    )
