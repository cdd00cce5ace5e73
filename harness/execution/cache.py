"""Result cache: a folder that several processes write to; entries are checked when read.

    KIND/KK/KEY.result    a result with where it comes from and its arrays: `cache_entry`
    drafts/               what is being written; a program that was killed leaves its draft
    aside/                broken entries
    journal.jsonl         a line when a case is submitted and when it is stored; marks the folder

Writers need no lock: those of one case write the same, and the last one counts.
"""

import json
import os
import re
import shutil
import uuid
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import Enum
from pathlib import Path
from typing import Any

import psutil

from harness.core.errors import CacheWarning, OutputError, StoreError
from harness.core.writing import WriteError
from harness.execution.atomic_write import write_atomically
from harness.execution.cache_entry import (
    BrokenEntryError,
    CacheEntry,
    Defect,
    Metadata,
    read_entry,
    write_entry,
)
from harness.execution.signals import delay_signals

DRAFTS, ASIDE, JOURNAL = "drafts", "aside", "journal.jsonl"

_FIRST = 5
"""Lines of a journal that are checked; a full disk may cut a line short."""

_KEY = "[0-9a-f]{32}"
_SUFFIX = r"(-[0-9a-f]{12})?\.(result|json|parquet)"
"""Ends of the names of results, and of the two files of earlier releases, which pruning removes."""

_RESULT = re.compile(rf"(?P<key>{_KEY})\.result")
_OLD = re.compile(rf"(?P<key>{_KEY})(-[0-9a-f]{{12}})?\.(json|parquet)")
_DRAFT = re.compile(rf"(?P<process>\d+)-[0-9a-f]{{8}}-{_KEY}{_SUFFIX}")
_SET_ASIDE = re.compile(rf".+-{_KEY}(-[0-9a-f]{{12}})?-[0-9a-f]{{8}}\.(result|json|parquet)")
"""Names of the files that this module writes; a file of another name is never removed."""


class NoCacheError(StoreError):
    """A folder is not a result cache.

    Parameters
    ----------
    folder : Path
    reason : str
        What it is instead.
    """

    def __init__(self, folder: Path, reason: str) -> None:
        super().__init__(folder, reason)
        self.folder, self.reason = folder, reason

    def __str__(self) -> str:
        """Say how a store is named or made."""
        return (
            f"there is no store at '{self.folder}': {self.reason}; name one with --store, or run "
            "something that keeps its results there"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheFolder:
    """A folder of results by kind and key.

    Parameters
    ----------
    folder : Path
        Created when the first entry is stored.
    fresh : bool
        True to ignore and replace the entries that exist.
    """

    folder: Path
    fresh: bool = False

    def has(self, kind: str, key: str) -> bool:
        """Whether an entry exists; it may be broken."""
        return not self.fresh and self.path(kind, key).exists()

    def get(self, kind: str, key: str) -> Any:  # noqa: ANN401 - any result
        """Return a result, or None if there is none.

        A broken entry is moved to the folder `aside`, with a `CacheWarning`.
        """
        if self.fresh:
            return None
        try:
            return self.read(kind, key).value()
        except FileNotFoundError:
            return None
        except StoreError as error:
            self.reject(kind, key, str(error))
            return None

    def read(self, kind: str, key: str) -> CacheEntry:
        """Return an entry; its `value` is the result.

        Raises
        ------
        FileNotFoundError
            If there is none.
        BrokenEntryError
            If it is not what was written.
        """
        try:
            content = self.path(kind, key).read_bytes()
        except FileNotFoundError:
            raise
        except OSError as error:
            raise BrokenEntryError(defect=Defect.UNREADABLE, reason=str(error.strerror)) from error
        return read_entry(content, kind, key)

    def put(self, kind: str, key: str, metadata: Metadata, value: object) -> None:
        """Store a result; a signal that arrives meanwhile waits.

        Raises
        ------
        OutputError
            If the folder cannot be written to; the earlier entry is then unchanged.
        """
        path, drafts = self.path(kind, key), self.folder / DRAFTS
        draft = drafts / f"{os.getpid()}-{uuid.uuid4().hex[:8]}-{path.name}"
        try:
            with delay_signals():
                if path.is_dir():  # which no file can replace
                    self.reject(kind, key, "a folder is where a file of it belongs")
                for folder in (drafts, path.parent):
                    folder.mkdir(parents=True, exist_ok=True)
                write_atomically(path, write_entry(kind, key, metadata, value), draft=draft)
                self.note("kept", kind, key)
        except OSError as error:
            raise self._write_error(error) from error

    def check(self) -> None:
        """Refuse a folder that is not a result cache; an empty folder is one without entries.

        Raises
        ------
        NoCacheError
            If the folder has no journal, or does not exist.
        """
        try:
            if not any(self.folder.iterdir()) or _is_ours(self.folder / JOURNAL):
                return
        except FileNotFoundError:
            raise NoCacheError(self.folder, "it is not there") from None
        except OSError as error:
            raise NoCacheError(self.folder, error.strerror or str(error)) from error
        raise NoCacheError(self.folder, f"it has no '{JOURNAL}' of ours")

    def note(self, event: str, kind: str, key: str) -> None:
        """Add a line to the journal.

        Raises
        ------
        OutputError
            As `put` does.
        """
        line = {
            "event": event,
            "kind": kind,
            "key": key,
            "process": os.getpid(),
            "at": datetime.now(UTC).isoformat(timespec="milliseconds"),
        }
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            # one write of a short line at the end of the file: lines of two processes do not mix
            handle = os.open(self.folder / JOURNAL, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            try:
                os.write(handle, (json.dumps(line) + "\n").encode())
            finally:
                os.close(handle)
        except OSError as error:
            raise self._write_error(error) from error

    def reject(self, kind: str, key: str, reason: str) -> None:
        """Move a broken entry to the folder `aside`, with a `CacheWarning` that says why."""
        path, place = self.path(kind, key), self.folder / ASIDE
        place.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # another process was faster
            path.rename(place / f"{kind}-{key}-{uuid.uuid4().hex[:8]}{path.suffix}")
        self.note("aside", kind, key)
        warnings.warn(CacheWarning(path, reason, place), stacklevel=3)

    def path(self, kind: str, key: str) -> Path:
        """Return the path of an entry."""
        return self.folder / kind / key[:2] / f"{key}.result"

    def _write_error(self, error: OSError) -> OutputError:
        """Return the error of a folder that cannot be written to."""
        if isinstance(error, OutputError):
            return error
        return WriteError(
            path=self.folder,
            reason=error.strerror or str(error),
            what="to the store",
            fix="what is kept there is whole: make room, or choose another folder with --store, "
            "and start again",
        )


def _is_ours(journal: Path) -> bool:
    """Whether a file is the journal of a result cache, whose lines a full disk may cut short."""
    try:
        with journal.open(encoding="utf-8") as file:
            lines = [file.readline() for _ in range(_FIRST)]
    except (FileNotFoundError, IsADirectoryError, UnicodeDecodeError):
        return False
    return not lines[0] or any(line.startswith('{"event": "') for line in lines)


class EntryState(Enum):
    """State of an entry."""

    WHOLE = "whole"
    BROKEN = "broken"


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryStatus:
    """An entry and its state.

    Parameters
    ----------
    kind, key : str
    state : EntryState
    metadata : Metadata or None
        None if the entry cannot be read.
    size : int
        Bytes.
    reason : str
        What is wrong with a broken entry.
    """

    kind: str
    key: str
    state: EntryState
    metadata: Metadata | None
    size: int
    reason: str = ""


def inspect_cache(store: CacheFolder, *, thoroughly: bool = False) -> Iterator[EntryStatus]:
    """Yield every entry, but those that another program removes meanwhile.

    Parameters
    ----------
    store : CacheFolder
    thoroughly : bool
        True to check the arrays too.
    """
    for path in _entries(store, _RESULT):
        kind, key = path.parent.parent.name, path.stem
        metadata, reason = None, ""
        size = _size(path)
        try:
            entry = store.read(kind, key)
            metadata = entry.metadata
            if thoroughly:
                entry.value()
        except FileNotFoundError:
            continue
        except StoreError as error:
            reason = str(error)
        state = EntryState.BROKEN if reason else EntryState.WHOLE
        yield EntryStatus(
            kind=kind, key=key, state=state, metadata=metadata, size=size, reason=reason
        )


def prune_cache(store: CacheFolder, keep: Callable[[Metadata], bool]) -> tuple[int, int]:
    """Remove entries; return the number of removed entries and the bytes freed in all.

    Broken entries are removed as well, and so are drafts of killed programs and files in the
    formats of earlier releases. Files that this module did not write stay.

    Parameters
    ----------
    store : CacheFolder
    keep : callable
        Returns whether to keep an entry, given its metadata.

    Raises
    ------
    StoreError
        If the folder is no store.
    """
    store.check()
    before = _bytes(store)
    removed = 0
    for entry in list(inspect_cache(store)):
        if entry.metadata is None or not keep(entry.metadata):
            _remove(store.path(entry.kind, entry.key))
            removed += 1
    for path in list(_entries(store, _OLD)):
        _remove(path)
    for path in _listed(store.folder / ASIDE):
        if _SET_ASIDE.fullmatch(path.name):
            _remove(path)
    for path in _listed(store.folder / DRAFTS):
        name = _DRAFT.fullmatch(path.name)
        if name is not None and not psutil.pid_exists(int(name["process"])):
            _remove(path)
    with suppress(OSError):  # not empty, or not there
        (store.folder / ASIDE).rmdir()
    return removed, before - _bytes(store)


def _remove(path: Path) -> None:
    """Remove a file, or a folder in its place, if it still exists."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _entries(store: CacheFolder, names: re.Pattern[str]) -> Iterator[Path]:
    """Yield the files KIND/KK/KEY... whose names match a pattern, sorted."""
    for kind in _listed(store.folder):
        for shelf in _listed(kind):
            for path in _listed(shelf):
                name = names.fullmatch(path.name)
                if name is not None and name["key"][:2] == shelf.name:
                    yield path


def _listed(place: Path) -> list[Path]:
    """Return the contents of a folder, sorted; empty if it is no folder or does not exist."""
    try:
        return sorted(place.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []


def _size(path: Path) -> int:
    """Return the size of a file in bytes; zero if it was removed meanwhile."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def _bytes(store: CacheFolder) -> int:
    # a walk passes over what goes meanwhile, as a glob does not
    return sum(
        _size(Path(root, name)) for root, _, names in os.walk(store.folder) for name in names
    )
