"""Runs that cannot be held against the truth to their end: failed ones, and chaotic ones.

A run of a chaotic scene is followed for as long as it stays near the exact motion.
"""

from collections.abc import Sequence

from harness.runner import Evaluation
from harness.simulation import Outcome
from harness.studies.comparison.curves import finest, label

_MOVED = frozenset({Outcome.FINISHED, Outcome.FLAT, Outcome.OVERTURNED, Outcome.TIMED_OUT})
"""Endings of a can's motion: once it has parted from the exact one, none of them is a failure."""

_OWN_ERROR = 1e-5
"""rad: what the best engine's run of a bounce is off by."""


def chaotic(e: Evaluation) -> bool:
    """Whether what differs in the end of a run is no error."""
    return e.divergence is not None and e.divergence.chaotic and e.simulation.outcome in _MOVED


def ended(e: Evaluation) -> str:
    """Return the verdict on a run that cannot be held against the truth to its end, or nothing."""
    if chaotic(e):
        return _followed(e)
    outcome = e.simulation.outcome
    if outcome is Outcome.FINISHED:
        return ""
    return f"failed: {outcome.name.lower().replace('_', ' ')}"


def _followed(e: Evaluation) -> str:
    """Return in words how long a run of a chaotic scene stays near the exact motion."""
    if e.parts_at is None:
        return "not decidable: chaotic, and never 0.1 rad from the exact motion"
    return f"not decidable: chaotic, parts after {e.parts_at:.3g} s"


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
