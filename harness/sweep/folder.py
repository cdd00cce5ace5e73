"""A sweep on the disk: its plan, and a file for each partition that is done.

    sweep.json                       the plan, written once and the same ever after
    parts/part-INDEX-PLAN-CHECK.parquet   a partition; the digest of its plan and its own checksum
    reduced/part-INDEX-PLAN-CHECK.reduction   the same of a sweep without rows
    damaged/                         partitions that are not what was written
    .lock                            held by the one process that is at work here

Every file is there whole or not at all, so a sweep goes on wherever it was stopped. A partition has
its name from its plan and its content: files of different plans never meet in one table.
"""

import fcntl
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa

from harness.core.errors import HarnessError, OutputError
from harness.core.writing import ForeignFolderError, WriteError, writing
from harness.execution.atomic_write import DRAFT_SUFFIX, write_atomically
from harness.execution.cache_entry import BrokenEntryError, checksum
from harness.execution.signals import delay_signals
from harness.sweep.partition import decode_partition, encode_partition
from harness.sweep.plan import SweepPlan, digest_of
from harness.sweep.reduction import Reduction, decode_reduction, encode_reduction

PLAN = "sweep.json"
PARTS = "parts"
REDUCED = "reduced"
DAMAGED = "damaged"
LOCK = ".lock"
NAME = re.compile(
    r"part-(?P<index>[0-9]{6,})-(?P<plan>[0-9a-f]{16})-(?P<check>[0-9a-f]{32})\.(parquet|reduction)"
)
"""Of the file of a partition: its number, the digest of its plan, the checksum of its content."""

_FORMAT = "rockingcan-sweep"
_PROGRAM = "program"
_OF_THE_PROGRAM = frozenset({_PROGRAM, "compiled", "rows_per_partition"})
"""What a plan has of the program that computes it: the extra `fast` decides of the last two."""
_REPORT = "report"
"""Folder of the report, which the command writes into the folder of the sweep."""

_DRAFTS = f".*{DRAFT_SUFFIX}"

_DIGITS = 32
"""Of a SHA-256, in a name: none of 2^64 damaged files passes."""


class PlanMismatchError(HarnessError, ValueError):
    """The folder holds another sweep than the one that is asked for.

    Parameters
    ----------
    out : Path
        The folder.
    differing : str
        In what the two sweeps differ.
    """

    def __init__(self, out: Path, differing: str) -> None:
        super().__init__(out, differing)
        self.out, self.differing = out, differing

    def __str__(self) -> str:
        """Say what to do about the difference."""
        return (
            f"'{self.out}' holds another sweep, which differs in {self.differing}; "
            "choose another folder with --out, or remove this one"
        )


class RowsMismatchError(PlanMismatchError):
    """The folder holds a sweep with rows, and is asked for one without, or the contrary."""

    def __str__(self) -> str:
        """Say which of the two is there."""
        return (
            f"'{self.out}' holds a sweep {self.differing}; choose another folder with --out, or "
            "remove this one"
        )


class ProgramMismatchError(PlanMismatchError):
    """The folder holds this sweep, computed by another version of the program."""

    def __str__(self) -> str:
        """Say why the two programs are not mixed, and what to do."""
        return (
            f"'{self.out}' holds this sweep as another program made it, with {self.differing}: "
            "rows of both might not go together; choose another folder with --out, or remove this "
            "one to make all anew"
        )


@dataclass(eq=False, kw_only=True)
class SweepBusyError(OutputError):
    """Another process is at work in the folder `out`."""

    out: Path

    def __str__(self) -> str:
        """Say to wait."""
        return f"a sweep is already at work in '{self.out}'; wait for it"


@dataclass(eq=False, kw_only=True)
class UnreadablePlanError(OutputError):
    """The file `place` states no plan, and `reason` says why."""

    place: Path
    reason: str

    def __str__(self) -> str:
        """Say how to go on with what is there."""
        return (
            f"the plan of the sweep in '{self.place.parent}' cannot be read ({self.reason}); "
            f"remove '{self.place}' and start the same sweep again, which goes on with the "
            "partitions that are there, or choose another folder with --out"
        )


@dataclass(eq=False, kw_only=True)
class PartitionError(OutputError):
    """The partition of number `index` in the folder `parts` is missing or damaged."""

    parts: Path
    index: int

    def __str__(self) -> str:
        """Say how it is mended."""
        return (
            f"partition {self.index} in '{self.parts}' is missing or damaged; run the sweep again "
            "to mend it"
        )


@dataclass(eq=False, kw_only=True)
class UnreadablePartitionError(OutputError):
    """The partition in the file `path` is whole, but this Arrow cannot read it."""

    path: Path
    reason: str

    def __str__(self) -> str:
        """Say to remove it."""
        return f"cannot read '{self.path}' ({self.reason}); remove it"


class Folder:
    """The place of one sweep; opened by `opened`, which holds its lock."""

    def __init__(self, out: Path, plan: SweepPlan) -> None:
        self.out = out
        self.plan = plan
        self._digest = plan.digest()
        self._suffix = ".reduction" if plan.reduced else ".parquet"
        self.damaged: list[Path] = []

    @property
    def parts(self) -> Path:
        """The folder of the partitions, which reads as one table if they have rows."""
        return self.out / (REDUCED if self.plan.reduced else PARTS)

    def there(self) -> dict[int, list[Path]]:
        """Return the files of each partition by their names, whether damaged or not."""
        files: dict[int, list[Path]] = {}
        for path in sorted(self.parts.glob(f"*{self._suffix}")):
            name = NAME.fullmatch(path.name)
            if name is not None and name["plan"] == self._digest:
                files.setdefault(int(name["index"]), []).append(path)
        return files

    def largest_partition(self) -> int:
        """Return the size of the largest file of a partition, in bytes; 0 if there is none."""
        return max((path.stat().st_size for path in self.parts.glob(f"*{self._suffix}")), default=0)

    def missing(self) -> list[int]:
        """Return the numbers of missing partitions, in order; damaged files are moved away.

        Raises
        ------
        OutputError
            If a damaged file cannot be moved.
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

    def write(self, part: pd.DataFrame | Reduction) -> None:
        """Write a partition atomically; a signal waits until it is done.

        Raises
        ------
        OutputError
            If it cannot be written, such as to a full disk.
        """
        with delay_signals():
            if isinstance(part, Reduction):
                first, content = part.start, encode_reduction(part, self._digest)
            else:
                first, content = part.index[0], encode_partition(part, self._digest)
            index, check = first // self.plan.rows_per_partition, _check(content)
            path = self.parts / f"part-{index:06d}-{self._digest}-{check}{self._suffix}"
            with writing(path, fix="what is done stays, and the same command goes on from it"):
                write_atomically(path, content)

    def read(self) -> Iterator[Any]:
        """Yield the partitions, one at a time, in order: a DataFrame each, or a Reduction.

        Raises
        ------
        PartitionError
            If a partition is missing or damaged.
        UnreadablePartitionError
            If it is whole and cannot be read.
        """
        there = self.there()
        for index in range(self.plan.partitions):
            paths = there.get(index, [])
            content = _content(paths[0]) if len(paths) == 1 else None
            if content is None:
                raise PartitionError(parts=self.parts, index=index)
            try:
                if self.plan.reduced:
                    yield decode_reduction(content, self._digest)
                else:
                    yield decode_partition(content)
            except (pa.ArrowException, BrokenEntryError) as error:  # whole, but of another Arrow
                raise UnreadablePartitionError(path=paths[0], reason=str(error)) from error

    def _set_aside(self, path: Path) -> None:
        """Move a damaged partition out of the table."""
        aside = self.out / DAMAGED
        with writing(self.out, "to"):
            aside.mkdir(exist_ok=True)
            self.damaged.append(path.rename(aside / path.name))


@contextmanager
def opened(out: Path, plan: SweepPlan) -> Iterator[Folder]:
    """Open the folder of a sweep, new or begun earlier, for one process at a time.

    Raises
    ------
    PlanMismatchError
        If another sweep is there.
    WriteError
        If the folder cannot be written.
    ForeignFolderError
        If it holds something else.
    UnreadablePlanError
        If the plan that is there cannot be read.
    SweepBusyError
        If a sweep is at work there.
    """
    folder = Folder(out, plan)
    with writing(out, "to"):
        if out.exists() and not out.is_dir():
            raise WriteError(path=out, reason="it is a file, not a folder", what="a sweep to")
        check_same(out, plan)  # before anything is written into a folder of others
        folder.parts.mkdir(parents=True, exist_ok=True)
        lock = (out / LOCK).open("w")
    with lock:
        with writing(out, "to"):
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise SweepBusyError(out=out) from None
            check_same(out, plan)  # another sweep may have begun since
            for draft in (*out.glob(_DRAFTS), *folder.parts.glob(_DRAFTS)):
                draft.unlink()
            if not (out / PLAN).exists():
                stated = {"format": _FORMAT, "digest": plan.digest(), "plan": plan.to_dict()}
                write_atomically(out / PLAN, (json.dumps(stated, indent=1) + "\n").encode())
        yield folder


def _check(content: bytes) -> str:
    """Return the checksum of a content as the name of its file has it."""
    return checksum(content)[:_DIGITS]


def _content(path: Path) -> bytes | None:
    """Return the content of the file of a partition, or None if it is damaged."""
    name = NAME.fullmatch(path.name)
    try:
        content = path.read_bytes()
    except OSError:
        return None
    return content if name is not None and name["check"] == _check(content) else None


def check_same(out: Path, plan: SweepPlan) -> None:
    """Refuse a folder that holds anything but this sweep; a folder need not exist.

    Raises
    ------
    PlanMismatchError
        If another sweep is there, or this one as another program made it.
    ForeignFolderError
        If something else is.
    UnreadablePlanError
        If the plan that is there cannot be read.
    """
    if not (out / PLAN).exists():
        _check_without_plan(out, plan)
        return
    here, there = plan.to_dict(), {"reduce": False, **_read(out)}  # which older plans do not say
    differing = [key for key in here | there if here.get(key) != there.get(key)]
    if differing and set(differing) <= _OF_THE_PROGRAM:
        raise ProgramMismatchError(out, _other_program(here[_PROGRAM], there.get(_PROGRAM)))
    if here["reduce"] != there["reduce"]:
        words = "with --reduce, so without rows" if there["reduce"] else "with rows"
        raise RowsMismatchError(out, words)
    if differing:
        named = [f"{key} ({there.get(key)!r:.200} there)" for key in differing if key != "scene"]
        raise PlanMismatchError(out, ", ".join((["the scene"] * ("scene" in differing)) + named))


def _other_program(here: dict[str, str], there: object) -> str:
    """Return in words how another program differs from this one."""
    if not isinstance(there, dict):
        return "no word of which"
    names = list(dict.fromkeys((*here, *there)))
    other = [name for name in names if here.get(name) != there.get(name)]
    without = {"numba": "none, without the extra fast"}
    said = {name: without.get(name, "none") for name in other}
    return ", ".join(
        f"{name} {there.get(name, said[name])} (now {here.get(name, said[name])})" for name in other
    )


def _check_without_plan(out: Path, plan: SweepPlan) -> None:
    """Refuse a folder without a plan, unless it is empty or holds partitions of this sweep."""
    drafts = set(out.glob(f".{PLAN}.*{DRAFT_SUFFIX}"))
    names = {path.name for path in out.iterdir() if path not in drafts} if out.exists() else set()
    # a plan may have been written since we looked for it: the lock decides whose folder it is
    ours = {LOCK, PLAN, PARTS, REDUCED} | ({DAMAGED, _REPORT} if LOCK in names else set())
    if names - ours:
        raise _foreign(out)
    for path in (*out.glob(f"{PARTS}/part-*"), *out.glob(f"{REDUCED}/part-*")):
        name = NAME.fullmatch(path.name)
        if name is None or name["plan"] != plan.digest():
            raise PlanMismatchError(out, f"its partitions, such as {path.name}")


def _read(out: Path) -> dict[str, Any]:
    """Return the plan that a folder states."""
    place = out / PLAN
    try:
        content: Any = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        reason = f"{type(error).__name__}: {error}"
        raise UnreadablePlanError(place=place, reason=reason) from error
    if not isinstance(content, dict) or content.get("format") != _FORMAT:
        raise _foreign(out)
    there = content.get("plan")
    if not isinstance(there, dict) or digest_of(there) != content.get("digest"):
        reason = "its checksum is not that of its content"
        raise UnreadablePlanError(place=place, reason=reason)
    return there


def _foreign(out: Path) -> ForeignFolderError:
    return ForeignFolderError(
        path=out,
        action="write a sweep to",
        thing="sweep",
        fix="choose another folder with --out",
    )
