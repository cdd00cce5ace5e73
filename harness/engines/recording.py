"""From chunks to a simulation: record, watch, count, and stop where the run is over."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from harness.engines.chunk import Chunk
from harness.engines.horizon import Watch
from harness.engines.recorder import Recorder
from harness.simulation import Outcome, Simulation
from harness.trajectory import Integers, Trajectory

_MOST_STEPS = 100_000_000
"""Steps, some minutes of MuJoCo, from which a run counts as one that does not end."""


def record(
    prepared: Simulation,
    chunks: Iterable[Chunk],
    seen: Callable[[Trajectory], object] = lambda _: None,
) -> Simulation:
    """Take chunks until the watch or the horizon ends the run; return what was prepared, completed.

    Parameters
    ----------
    prepared : Simulation
        Everything but outcome, trajectory and counts.
    chunks : iterable of Chunk
        Of consecutive steps, up to the horizon in time.
    seen : callable
        Is shown the samples that are kept of each chunk, before the next one is stepped.
    """
    scene = prepared.case.scene
    recorder, watch = Recorder(scene), Watch(scene)
    outcome: Outcome | None = None
    steps = rows = 0
    for chunk in chunks:
        kept = recorder.add(chunk)
        outcome = None if kept is None else watch.over(kept)
        if outcome is None and not chunk.sound:
            outcome = Outcome.DIVERGED
        taken = int(np.searchsorted(chunk.times, watch.ended_at, side="right"))
        spans = _spans(chunk, taken, ended=watch.ended_at < np.inf)
        steps += taken if spans is None else int(spans.sum())
        worked = chunk.constraint_rows[:taken]
        rows += int(worked.sum()) if spans is None else int(worked @ spans)
        if outcome is None and steps >= _MOST_STEPS:
            outcome = Outcome.TOO_SLOW
        if outcome is not None:
            break
        if kept is not None:
            seen(kept)
    if outcome is None:
        outcome = Outcome.FINISHED if scene.horizon.seconds else Outcome.TIMED_OUT
    return replace(
        prepared,
        outcome=outcome,
        trajectory=recorder.trajectory(watch.ended_at),
        steps=steps,
        constraint_rows=rows,
    )


def _spans(chunk: Chunk, taken: int, *, ended: bool) -> Integers | None:
    """Return the steps that the first readings stand for; where a run ended, the last for one."""
    if chunk.spans is None:
        return None
    spans = chunk.spans[:taken]
    return np.append(spans[:-1], 1) if ended and taken else spans
