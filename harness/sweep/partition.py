"""One partition of a sweep: its scenes, solved or run, as columns."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from harness.core.case import Case
from harness.sweep.parameters import PARAMETERS, Floats, scene_at
from harness.sweep.plan import SweepPlan
from harness.sweep.values import (
    QUANTITIES,
    SOURCES,
    SweepValues,
    held_against,
    run_each,
    solved_exactly,
)
from models.errors import InvalidValueError, ModelError

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
    cases = [_case(plan, values, place) for place in range(len(rows))]
    found = run_each(cases, plan.quantities, _exact(plan, index, rows))
    return to_partition(plan, index, rows, found)


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
    sentences, code = _coded(found.outcomes)
    return Partition(
        index=index,
        rows=rows,
        parameters={PARAMETERS[name].column: v for name, v in plan.values(rows).items()},
        quantities={name: found.numbers[name] for name in plan.quantities},
        code=code,
        sentences=sentences,
    )


def _coded(outcomes: Sequence[str]) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Return the sentences that occur, sorted, and which of them each outcome is."""
    sentences = tuple(sorted(set(outcomes)))
    place = {sentence: number for number, sentence in enumerate(sentences)}
    return sentences, np.array([place[outcome] for outcome in outcomes], dtype=np.int64)


def concatenate(index: int, parts: Sequence[Partition]) -> Partition:
    """Return parts that follow each other as one."""
    if len(parts) == 1:
        return parts[0]
    sentences, code = _coded([p.sentences[number] for p in parts for number in p.code.tolist()])
    first = parts[0]
    return Partition(
        index=index,
        rows=range(first.rows.start, parts[-1].rows.stop),
        parameters={n: np.concatenate([p.parameters[n] for p in parts]) for n in first.parameters},
        quantities={n: np.concatenate([p.quantities[n] for p in parts]) for n in first.quantities},
        code=code,
        sentences=sentences,
    )


def _case(plan: SweepPlan, values: Mapping[str, Floats], place: int) -> Case | str:
    """Return the case of one scene of a partition, or why there is none."""
    chosen = {name: float(v[place]) for name, v in values.items()}
    try:
        return plan.case(scene_at(plan.scene, chosen))
    except InvalidValueError as error:  # without the value: a sentence for all such rows
        return f"{IMPOSSIBLE} `{error.key}` must be {error.allowed}"
    except ModelError as error:
        return f"{IMPOSSIBLE} {error}"


def _exact(plan: SweepPlan, index: int, rows: range) -> dict[str, Floats]:
    """Return exact numbers that runs are held against, or that no run has, if any is asked for.

    Of the whole partition, whichever rows: of other companions they might differ by round-off.
    """
    errors = [name for name, source in SOURCES.items() if source == "error"]
    wanted = ["epsilon"] if "epsilon" in plan.quantities else []
    if set(errors) & set(plan.quantities):
        wanted += map(held_against, errors)
    if not wanted:
        return {}
    span = plan.span(index)
    numbers = solved_exactly(plan.scene, plan.values(span), wanted).numbers
    inside = slice(rows.start - span.start, rows.stop - span.start)
    return {name: values[inside] for name, values in numbers.items()}


_OF_PLAN = b"rockingcan.plan"
_OUTCOME = "How the scene ended; says why where the numbers are missing."


def encode_partition(part: Partition, digest: str) -> bytes:
    """Return a partition as a Parquet file; what is no number is missing, units are in the names.

    Parameters
    ----------
    part : Partition
    digest : str
        Of the plan; the file carries it.
    """
    columns: dict[str, tuple[pa.Array, str]] = {
        "row": (pa.array(np.arange(part.rows.start, part.rows.stop)), "Number of the scene.")
    }
    for known in PARAMETERS.values():
        if known.column in part.parameters:
            told = f"{known.name} of the scene."
            columns[known.column] = (pa.array(part.parameters[known.column]), told)
    for name, values in part.quantities.items():
        numbers = pa.array(values, mask=np.isnan(values))
        columns[name] = (numbers, QUANTITIES[name].meaning)
    outcome = pa.DictionaryArray.from_arrays(part.code.astype(np.int32), list(part.sentences))
    columns["outcome"] = (outcome, _OUTCOME)
    schema = pa.schema(
        [
            pa.field(name, array.type, metadata={"description": told})
            for name, (array, told) in columns.items()
        ],
        metadata={_OF_PLAN: digest.encode()},
    )
    table = pa.Table.from_arrays([array for array, _ in columns.values()], schema=schema)
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def decode_partition(content: bytes, index: int, plan: SweepPlan) -> Partition:
    """Return the partition that a file was written from.

    Raises
    ------
    pyarrow.ArrowException
        If it is of an Arrow that this one cannot read.
    """
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort it
    with pq.ParquetFile(pa.BufferReader(content), pre_buffer=False) as file:
        table = file.read(use_threads=False)
    outcome = table.column("outcome").combine_chunks()

    def numbers(name: str) -> Floats:
        return np.asarray(table.column(name).to_numpy(zero_copy_only=False), dtype=np.float64)

    return Partition(
        index=index,
        rows=plan.span(index),
        parameters={axis.column: numbers(axis.column) for axis in plan.axes},
        quantities={name: numbers(name) for name in plan.quantities},
        code=outcome.indices.to_numpy(zero_copy_only=False).astype(np.int64),
        sentences=tuple(str(sentence) for sentence in outcome.dictionary.to_pylist()),
    )
