"""The folder of a sweep: its plan, and one Parquet file a partition, each whole or not there.

A file is named by its partition and by the digest of the plan, and carries checksums; one that is
damaged is set aside and made again. While a sweep is at work it holds a lock, which goes with its
process however that ends.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from harness.errors import HarnessError, OutputError
from harness.interruption import finishing
from harness.sweep.parameters import PARAMETERS, Floats
from harness.sweep.partition import Part
from harness.sweep.planning import Plan
from harness.sweep.quantities import QUANTITIES
from harness.sweep.stated import DAMAGED, LOCK, PARTS, SUFFIX, check_same, write_plan

_OF_PLAN = b"rockingcan.plan"
_OUTCOME = "How the scene ended; says why where the numbers are missing."


class Folder:
    """The place of one sweep; opened by `opened`, which holds its lock."""

    def __init__(self, out: Path, plan: Plan) -> None:
        self.out = out
        self.plan = plan
        self._digest = plan.digest()
        self.damaged: list[Path] = []

    @property
    def parts(self) -> Path:
        """The folder of the partitions, which reads as one table."""
        return self.out / PARTS

    def path(self, index: int) -> Path:
        """Return the file of a partition."""
        return self.parts / f"part-{index:06d}-{self._digest}{SUFFIX}"

    def missing(self) -> list[int]:
        """Return the partitions that are not there, in order; damaged ones are set aside.

        Raises
        ------
        OutputError
            If a damaged one cannot be.
        """
        gone = []
        for index in range(self.plan.partitions):
            path = self.path(index)
            if path.exists() and not self._sound(index):
                aside = self.out / DAMAGED
                with _writing(self.out):
                    aside.mkdir(exist_ok=True)
                    self.damaged.append(path.rename(aside / path.name))
            if not path.exists():
                gone.append(index)
        return gone

    def write(self, part: Part) -> None:
        """Write a partition, whole or not at all; a signal waits until it is done.

        Raises
        ------
        OutputError
            If it cannot be written, such as to a full disk.
        """
        with finishing():
            table = _table(part, self._digest)
            path = self.path(part.index)
            draft = path.with_name(f".{path.name}.draft")
            try:
                with draft.open("wb") as file:
                    pq.write_table(table, file, compression="zstd", write_page_checksum=True)
                    file.flush()
                    os.fsync(file.fileno())
                draft.replace(path)
            except OSError as error:
                draft.unlink(missing_ok=True)
                raise OutputError(
                    f"cannot write '{path}': {error.strerror or error}; what is done stays, and "
                    "the same command goes on from it"
                ) from error

    def read(self) -> Iterator[Part]:
        """Yield the partitions, one at a time, in order.

        Raises
        ------
        OutputError
            If one is missing, or is not what was written.
        """
        for index in range(self.plan.partitions):
            try:
                yield _part(self._table(index), index, self.plan)
            except (OSError, pa.ArrowException) as error:
                raise OutputError(
                    f"cannot read '{self.path(index)}' ({error}); run the sweep again to mend it"
                ) from error

    def _table(self, index: int) -> pa.Table:
        # in this thread alone: one of Arrow's own that outlives the interpreter can abort it
        path = self.path(index)
        with pq.ParquetFile(path, page_checksum_verification=True, pre_buffer=False) as file:
            return file.read(use_threads=False)

    def _sound(self, index: int) -> bool:
        """Whether the file of a partition is what was written."""
        try:
            table = self._table(index)
        except (OSError, pa.ArrowException):
            return False
        told: bytes = (table.schema.metadata or {}).get(_OF_PLAN, b"")
        rows: int = table.num_rows
        return told == self._digest.encode() and rows == len(self.plan.span(index))


@contextmanager
def opened(out: Path, plan: Plan) -> Iterator[Folder]:
    """Give the folder of a sweep, new or begun earlier, to one process at a time.

    Raises
    ------
    PlanMismatchError
        If another sweep is there.
    OutputError
        If the folder cannot be written, holds something else, or a sweep is at work there.
    """
    folder = Folder(out, plan)
    with _writing(out):
        if out.exists() and not out.is_dir():
            raise OutputError(f"cannot write a sweep to '{out}': it is a file, not a folder")
        check_same(out, plan)  # before anything is written into a folder of others
        folder.parts.mkdir(parents=True, exist_ok=True)
        lock = (out / LOCK).open("w")
    with lock:
        with _writing(out):
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise OutputError(f"a sweep is already at work in '{out}'; wait for it") from None
            check_same(out, plan)  # another sweep may have begun since
            write_plan(out, plan)
            for draft in folder.parts.glob(".*.draft"):
                draft.unlink()
        yield folder


@contextmanager
def _writing(out: Path) -> Iterator[None]:
    """Say of a folder that it cannot be written to; what is said already passes as it is."""
    try:
        yield
    except OSError as error:
        if isinstance(error, HarnessError):
            raise
        raise OutputError(f"cannot write to '{out}': {error.strerror or error}") from error


def _table(part: Part, digest: str) -> pa.Table:
    """Return a part as a table; what is no number is missing, and units are in the names."""
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


def _part(table: pa.Table, index: int, plan: Plan) -> Part:
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
