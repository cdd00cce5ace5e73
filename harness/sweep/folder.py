"""The folder of a sweep: its plan, and one Parquet file a partition, each whole or not there.

A file is named by its partition, by the digest of the plan, and by the first half of its own
SHA-256; one that is not what its name says is damaged, and set aside to be made again. While a
sweep is at work it holds a lock, which goes with its process however that ends.

A partition as a table of Arrow, and back: a column each, with its meaning.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from harness.core.errors import HarnessError, OutputError
from harness.execution.cache_entry import checksum
from harness.execution.signals import delay_signals
from harness.sweep.parameters import PARAMETERS, Floats
from harness.sweep.partition import Partition
from harness.sweep.plan import SweepPlan
from harness.sweep.plan_file import DAMAGED, LOCK, NAME, PARTS, SUFFIX, check_same, write_plan
from harness.sweep.quantities import QUANTITIES

_OF_PLAN = b"rockingcan.plan"
_OUTCOME = "How the scene ended; says why where the numbers are missing."


def table_of(part: Partition, digest: str) -> pa.Table:
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


def part_of(table: pa.Table, index: int, plan: SweepPlan) -> Partition:
    """Return a table as the part that it was written from."""
    outcome = table.column("outcome").combine_chunks()
    sentences = [str(sentence) for sentence in outcome.dictionary.to_pylist()]

    def numbers(name: str) -> Floats:
        return np.asarray(table.column(name).to_numpy(zero_copy_only=False), dtype=np.float64)

    return Partition(
        index=index,
        rows=plan.span(index),
        parameters={axis.column: numbers(axis.column) for axis in plan.axes},
        quantities={name: numbers(name) for name in plan.quantities},
        code=outcome.indices.to_numpy(zero_copy_only=False).astype(np.int64),
        sentences=tuple(sentences),
    )


_DIGITS = 32
"""Of a SHA-256, in a name: none of 2^64 damaged files passes."""


class Folder:
    """The place of one sweep; opened by `opened`, which holds its lock."""

    def __init__(self, out: Path, plan: SweepPlan) -> None:
        self.out = out
        self.plan = plan
        self._digest = plan.digest()
        self.damaged: list[Path] = []

    @property
    def parts(self) -> Path:
        """The folder of the partitions, which reads as one table."""
        return self.out / PARTS

    def there(self) -> dict[int, list[Path]]:
        """Return the files of the partitions by their names alone, whether sound or not."""
        found: dict[int, list[Path]] = {}
        for path in sorted(self.parts.glob(f"*{SUFFIX}")):
            name = NAME.fullmatch(path.name)
            if name is not None and name["plan"] == self._digest:
                found.setdefault(int(name["index"]), []).append(path)
        return found

    def missing(self) -> list[int]:
        """Return the partitions that are not there, in order; damaged ones are set aside.

        Raises
        ------
        OutputError
            If a damaged one cannot be.
        """
        there, gone = self.there(), []
        for index in range(self.plan.partitions):
            sound = False
            for path in there.get(index, ()):
                # a second of the same partition would be in the table twice
                if sound or _content(path) is None:
                    self._set_aside(path)
                else:
                    sound = True
            if not sound:
                gone.append(index)
        return gone

    def write(self, part: Partition) -> None:
        """Write a partition, whole or not at all; a signal waits until it is done.

        Raises
        ------
        OutputError
            If it cannot be written, such as to a full disk.
        """
        with delay_signals():
            content = _bytes(table_of(part, self._digest))
            name = f"part-{part.index:06d}-{self._digest}-{_check(content)}{SUFFIX}"
            path, draft = self.parts / name, self.parts / f".{name}.draft"
            try:
                with draft.open("wb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
                draft.replace(path)
            except OSError as error:
                draft.unlink(missing_ok=True)
                raise OutputError(
                    f"cannot write '{path}': {error.strerror or error}; what is done stays, and "
                    "the same command goes on from it"
                ) from error

    def read(self) -> Iterator[Partition]:
        """Yield the partitions, one at a time, in order.

        Raises
        ------
        OutputError
            If one is missing, or is not what was written.
        """
        there = self.there()
        for index in range(self.plan.partitions):
            paths = there.get(index, [])
            content = _content(paths[0]) if len(paths) == 1 else None
            if content is None:
                raise OutputError(
                    f"partition {index} in '{self.parts}' is missing or damaged; run the sweep "
                    "again to mend it"
                )
            try:
                yield part_of(_table(content), index, self.plan)
            except pa.ArrowException as error:  # whole, but of another Arrow
                raise OutputError(f"cannot read '{paths[0]}' ({error}); remove it") from error

    def _set_aside(self, path: Path) -> None:
        """Move a damaged partition out of the table."""
        aside = self.out / DAMAGED
        with _writing(self.out):
            aside.mkdir(exist_ok=True)
            self.damaged.append(path.rename(aside / path.name))


@contextmanager
def opened(out: Path, plan: SweepPlan) -> Iterator[Folder]:
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


def _check(content: bytes) -> str:
    """Return what the name of a file says of its content."""
    return checksum(content)[:_DIGITS]


def _content(path: Path) -> bytes | None:
    """Return what is in the file of a partition, or None if it is not what was written."""
    name = NAME.fullmatch(path.name)
    try:
        content = path.read_bytes()
    except OSError:
        return None
    return content if name is not None and name["check"] == _check(content) else None


def _bytes(table: pa.Table) -> bytes:
    """Return a table as the content of a file."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def _table(content: bytes) -> pa.Table:
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort it
    with pq.ParquetFile(pa.BufferReader(content), pre_buffer=False) as file:
        return file.read(use_threads=False)
