"""From chunks to a simulation: record, watch, count, and stop where the run is over."""

from collections.abc import Iterable
from dataclasses import replace

from harness.engines.chunk import Chunk
from harness.engines.horizon import Watch
from harness.engines.recorder import Recorder
from harness.simulation import Outcome, Simulation

_MOST_STEPS = 100_000_000
"""Steps, some minutes of MuJoCo, from which a run counts as one that does not end."""


def record(prepared: Simulation, chunks: Iterable[Chunk]) -> Simulation:
    """Take chunks until the watch or the horizon ends the run; return what was prepared, completed.

    Parameters
    ----------
    prepared : Simulation
        Everything but outcome, trajectory and counts.
    chunks : iterable of Chunk
        Of consecutive steps, up to the horizon in time.
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
        taken = chunk.times <= watch.ended_at
        steps += int(taken.sum())
        rows += int(chunk.constraint_rows[taken].sum())
        if outcome is None and steps >= _MOST_STEPS:
            outcome = Outcome.TOO_SLOW
        if outcome is not None:
            break
    if outcome is None:
        outcome = Outcome.FINISHED if scene.horizon.seconds else Outcome.TIMED_OUT
    return replace(
        prepared,
        outcome=outcome,
        trajectory=recorder.trajectory(watch.ended_at),
        steps=steps,
        constraint_rows=rows,
    )
