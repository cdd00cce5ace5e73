"""One partition of a sweep: consecutive scenes, solved or run, as a frame and as a file.

A partition is a frame with a row for each scene: its parameters by their columns, its quantities by
their names, where NaN stands for none, and its outcome, which explains what is missing. The index
is the number of the scene in the sweep.
"""

import math
import time
from dataclasses import replace

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from harness.core.case import Case
from harness.sweep.parameters import PARAMETERS, Floats, scene_at
from harness.sweep.plan import SweepPlan
from harness.sweep.values import QUANTITIES, SOURCES, compared_quantity, run_each, solved_exactly
from models.errors import InvalidValueError, ModelError

_INSTANT = 1e-9
"""s: shorter than a clock resolves; avoids a division by zero."""

IMPOSSIBLE = "no such scene:"
"""Beginning of the outcome of values that exclude each other."""

OUTCOME = "outcome"
"""Column of the sentences that say how scenes ended."""


def compute(plan: SweepPlan, rows: range) -> pd.DataFrame:
    """Return rows of one partition; they do not depend on machine or order.

    Parameters
    ----------
    plan : SweepPlan
    rows : range
        Of the sweep, within a partition.
    """
    values = plan.values(rows)
    if plan.exact:
        exact = solved_exactly(plan.base.scene, values, plan.quantities, compiled=plan.compiled)
        return to_partition(plan, rows, exact)
    scenes = [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]
    cases = [_case(plan, scene) for scene in scenes]
    return to_partition(plan, rows, run_each(cases, plan.quantities, _exact(plan, rows)))


def compute_for(plan: SweepPlan, rows: range, seconds: float) -> pd.DataFrame:
    """Return the first of some rows of a partition: as many as there is time for, and at least one.

    So a slow engine needs no more time for a task than a task may take, however many rows there
    are; the others are for the next task. Which rows are made together changes no bit of them.

    Parameters
    ----------
    plan : SweepPlan
    rows : range
    seconds : float
        In which to be done, if scenes take about as long as those before them.
    """
    if plan.exact or math.isinf(seconds):
        return compute(plan, rows)
    end = time.monotonic() + seconds
    done: list[pd.DataFrame] = []
    start, count = rows.start, 1
    while start < rows.stop and count > 0:
        block = range(start, min(start + count, rows.stop))
        began = time.monotonic()
        done.append(compute(plan, block))
        now = time.monotonic()
        start = block.stop
        count = int((end - now) * len(block) / max(now - began, _INSTANT))
    return pd.concat(done)


def to_partition(plan: SweepPlan, rows: range, computed: pd.DataFrame) -> pd.DataFrame:
    """Return the parameters and the computed quantities of rows, as a partition has them."""
    values = plan.values(rows)
    columns = {known.column: values[n] for n, known in PARAMETERS.items() if n in values}
    columns |= {str(name): computed[name].to_numpy() for name in plan.quantities}
    index = pd.RangeIndex(rows.start, rows.stop, name="row")
    outcomes = pd.Series(computed[OUTCOME].to_numpy(), index, dtype=object)
    return pd.DataFrame({**columns, OUTCOME: outcomes}, index=index, copy=False)


def _case(plan: SweepPlan, values: dict[str, float]) -> Case | str:
    """Return the case of one scene of a partition, or why there is none."""
    try:
        scene = scene_at(plan.base.scene, {name: float(v) for name, v in values.items()})
        return replace(plan.base, scene=scene)
    except InvalidValueError as error:  # without the value: a sentence for all such rows
        return f"{IMPOSSIBLE} `{error.key}` must be {error.allowed}"
    except ModelError as error:
        return f"{IMPOSSIBLE} {error}"


def _exact(plan: SweepPlan, rows: range) -> dict[str, Floats]:
    """Return the exact numbers from which errors are taken, or that no run has, if asked for.

    They are solved for all rows of the partition: of other rows together they might differ by
    round-off.
    """
    errors = [name for name, source in SOURCES.items() if source == "error"]
    wanted = ["epsilon"] if "epsilon" in plan.quantities else []
    if set(errors) & set(plan.quantities):
        wanted += map(compared_quantity, errors)
    if not wanted:
        return {}
    span = plan.span(rows.start // plan.rows_per_partition)
    exact = solved_exactly(plan.base.scene, plan.values(span), wanted)
    inside = slice(rows.start - span.start, rows.stop - span.start)
    return {name: exact[name].to_numpy()[inside] for name in wanted}


def encode_partition(part: pd.DataFrame, digest: str) -> bytes:
    """Return a partition as a Parquet file; what is no number is missing, units are in the names.

    Parameters
    ----------
    part : DataFrame
    digest : str
        Of the plan; the file carries it.
    """
    meanings = {"row": "Number of the scene."}
    meanings |= {known.column: f"{known.name} of the scene." for known in PARAMETERS.values()}
    meanings |= {name: quantity.meaning for name, quantity in QUANTITIES.items()}
    meanings[OUTCOME] = "How the scene ended; says why where the numbers are missing."
    arrays = {
        str(name): pa.array(column.to_numpy(), from_pandas=True)
        for name, column in part.drop(columns=OUTCOME).reset_index().items()
    }
    sentences = pa.array(part[OUTCOME].tolist(), pa.string())
    arrays[OUTCOME] = sentences.dictionary_encode()
    schema = pa.schema(
        [
            pa.field(name, array.type, metadata={"description": meanings[name]})
            for name, array in arrays.items()
        ],
        metadata={"rockingcan.plan": digest},
    )
    sink = pa.BufferOutputStream()
    table = pa.Table.from_arrays(list(arrays.values()), schema=schema)
    # numbers hardly repeat: a dictionary of them takes time and room. Their exponents do, and lie
    # together where all first bytes come first, then all second ones
    pq.write_table(
        table,
        sink,
        compression="zstd",
        use_dictionary=[OUTCOME],
        use_byte_stream_split=[n for n, array in arrays.items() if pa.types.is_float64(array.type)],
        write_page_checksum=True,
    )
    return bytes(sink.getvalue().to_pybytes())


def decode_partition(content: bytes) -> pd.DataFrame:
    """Return the partition that a file was written from.

    Raises
    ------
    pyarrow.ArrowException
        If it is of an Arrow that this one cannot read.
    """
    # in this thread alone: a thread of Arrow that outlives the interpreter can abort it
    with pq.ParquetFile(pa.BufferReader(content), pre_buffer=False) as file:
        table = file.read(use_threads=False)
    part: pd.DataFrame = table.to_pandas(use_threads=False).set_index("row")
    return part
