"""A partition as a table of Arrow, and back: a column each, with its meaning."""

import numpy as np
import pyarrow as pa

from harness.sweep.parameters import PARAMETERS, Floats
from harness.sweep.partition import Part
from harness.sweep.planning import Plan
from harness.sweep.quantities import QUANTITIES

_OF_PLAN = b"rockingcan.plan"
_OUTCOME = "How the scene ended; says why where the numbers are missing."


def table_of(part: Part, digest: str) -> pa.Table:
    """Return a part as a table; what is no number is missing, and units are in the names.

    Parameters
    ----------
    part : Part
    digest : str
        Of the plan; the table carries it.
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
    return pa.Table.from_arrays([array for array, _ in columns.values()], schema=schema)


def part_of(table: pa.Table, index: int, plan: Plan) -> Part:
    """Return a table as the part that it was written from."""
    outcome = table.column("outcome").combine_chunks()
    sentences = [str(sentence) for sentence in outcome.dictionary.to_pylist()]

    def numbers(name: str) -> Floats:
        return np.asarray(table.column(name).to_numpy(zero_copy_only=False), dtype=np.float64)

    return Part(
        index=index,
        rows=plan.span(index),
        parameters={axis.column: numbers(axis.column) for axis in plan.axes},
        quantities={name: numbers(name) for name in plan.quantities},
        code=outcome.indices.to_numpy(zero_copy_only=False).astype(np.int64),
        sentences=tuple(sentences),
    )
