"""One partition of a sweep: its scenes, solved or run, as columns."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.sweep.exact import solved_exactly
from harness.sweep.parameters import PARAMETERS, Floats, scene_at
from harness.sweep.plan import SweepPlan
from harness.sweep.quantities import SOURCES, SweepValues
from harness.sweep.simulated import ERRORS, run_each
from models.errors import InvalidValueError, ModelError
from models.scene import Scene

_INSTANT = 1e-9
"""s: what a clock may not have seen."""

IMPOSSIBLE = "no such scene:"
"""How the outcome of values begins that exclude each other."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Partition:
    """Consecutive rows of a sweep.

    Parameters
    ----------
    index : int
        Of the partition.
    rows : range
    parameters : mapping of str to ndarray, shape (n,)
        By their columns.
    quantities : mapping of str to ndarray, shape (n,)
        By their names; NaN stands for none, which the outcome explains.
    code : ndarray of int, shape (n,)
        Index into `sentences`.
    sentences : tuple of str
        How scenes of this part ended, sorted.
    """

    index: int
    rows: range
    parameters: Mapping[str, Floats]
    quantities: Mapping[str, Floats]
    code: NDArray[np.int64]
    sentences: tuple[str, ...]


def compute(plan: SweepPlan, index: int, rows: range | None = None) -> Partition:
    """Return a partition, or some rows of it; the same wherever and in whatever order it is made.

    Parameters
    ----------
    plan : Plan
    index : int
        Of the partition.
    rows : range, optional
        Of the sweep, within the partition; all of it if left out.
    """
    rows = plan.span(index) if rows is None else rows
    values = plan.values(rows)
    if plan.exact:
        return to_partition(plan, index, rows, solved_exactly(plan.scene, values, plan.quantities))
    scenes = [_scene(plan, values, place) for place in range(len(rows))]
    return to_partition(plan, index, rows, run_each(plan, scenes, _exact(plan, index, rows)))


def compute_for(plan: SweepPlan, index: int, rows: range, seconds: float) -> Partition:
    """Return the first of some rows of a partition: as many as there is time for, and at least one.

    So a slow engine needs no more time for a task than a task may take, however many rows there
    are; the others are for the next task. Which rows are made together changes no bit of them.

    Parameters
    ----------
    plan : Plan
    index : int
        Of the partition.
    rows : range
    seconds : float
        In which to be done, if scenes take about as long as those before them.
    """
    if plan.exact or math.isinf(seconds):
        return compute(plan, index, rows)
    end = time.monotonic() + seconds
    done: list[Partition] = []
    start, count = rows.start, 1
    while start < rows.stop and count > 0:
        block = range(start, min(start + count, rows.stop))
        began = time.monotonic()
        done.append(compute(plan, index, block))
        now = time.monotonic()
        start = block.stop
        count = int((end - now) * len(block) / max(now - began, _INSTANT))
    return concatenate(index, done)


def to_partition(plan: SweepPlan, index: int, rows: range, found: SweepValues) -> Partition:
    """Return what was found of rows as a part, its outcomes as codes."""
    sentences = tuple(sorted(set(found.outcomes)))
    place = {sentence: number for number, sentence in enumerate(sentences)}
    return Partition(
        index=index,
        rows=rows,
        parameters={PARAMETERS[name].column: v for name, v in plan.values(rows).items()},
        quantities={name: found.numbers[name] for name in plan.quantities},
        code=np.array([place[outcome] for outcome in found.outcomes], dtype=np.int64),
        sentences=sentences,
    )


def concatenate(index: int, parts: Sequence[Partition]) -> Partition:
    """Return parts that follow each other as one."""
    if len(parts) == 1:
        return parts[0]
    sentences = tuple(sorted({sentence for one in parts for sentence in one.sentences}))
    place = {sentence: number for number, sentence in enumerate(sentences)}
    first = parts[0]
    return Partition(
        index=index,
        rows=range(first.rows.start, parts[-1].rows.stop),
        parameters={n: np.concatenate([p.parameters[n] for p in parts]) for n in first.parameters},
        quantities={n: np.concatenate([p.quantities[n] for p in parts]) for n in first.quantities},
        code=np.concatenate([np.array([place[s] for s in p.sentences])[p.code] for p in parts]),
        sentences=sentences,
    )


def _scene(plan: SweepPlan, values: Mapping[str, Floats], place: int) -> Scene | str:
    """Return one scene of a partition, or why there is none."""
    try:
        return scene_at(plan.scene, {name: float(v[place]) for name, v in values.items()})
    except InvalidValueError as error:  # without the value: a sentence for all such rows
        return f"{IMPOSSIBLE} `{error.key}` must be {error.allowed}"
    except ModelError as error:
        return f"{IMPOSSIBLE} {error}"


def _exact(plan: SweepPlan, index: int, rows: range) -> dict[str, Floats]:
    """Return exact numbers that runs are held against, or that no run has, if any is asked for.

    Of the whole partition, whichever rows: of other companions they might differ by round-off.
    """
    wanted = ["epsilon"] if "epsilon" in plan.quantities else []
    if any(SOURCES[name] == "error" for name in plan.quantities):
        wanted += ERRORS.values()
    if not wanted:
        return {}
    span = plan.span(index)
    numbers = solved_exactly(plan.scene, plan.values(span), wanted).numbers
    inside = slice(rows.start - span.start, rows.stop - span.start)
    return {name: values[inside] for name, values in numbers.items()}
