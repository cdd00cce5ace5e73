"""A folder of results, several processes at once: written whole, checked when read.

    KIND/KK/KEY.result    a result with where it comes from and its arrays: `cache_entry`
    drafts/               what is being written; a program that was killed leaves its draft
    aside/                entries that were found broken
    journal.jsonl         a line when a case is begun, and when it is kept: names a store

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

from harness.core.errors import OutputError, StoreError
from harness.execution.atomic_write import write_atomically
from harness.execution.cache_entry import CacheEntry, Metadata, read_entry, write_entry
from harness.execution.signals import delay_signals

DRAFTS, ASIDE, JOURNAL = "drafts", "aside", "journal.jsonl"

_FIRST = 5
"""Lines of a journal that are looked at; one may be cut short by a full disk."""

_KEY = "[0-9a-f]{32}"
_SUFFIX = r"(-[0-9a-f]{12})?\.(result|json|parquet)"
"""Of results, and of the two files of earlier releases, which pruning removes."""

_RESULT = re.compile(rf"(?P<key>{_KEY})\.result")
_OLD = re.compile(rf"(?P<key>{_KEY})(-[0-9a-f]{{12}})?\.(json|parquet)")
_DRAFT = re.compile(rf"(?P<process>\d+)-[0-9a-f]{{8}}-{_KEY}{_SUFFIX}")
_SET_ASIDE = re.compile(rf".+-{_KEY}(-[0-9a-f]{{12}})?-[0-9a-f]{{8}}\.(result|json|parquet)")
"""The names that are given here: whatever has another is somebody else's."""


class NoCacheError(StoreError):
    """A folder is no store."""

    def __init__(self, folder: Path, reason: str) -> None:
        super().__init__(
            f"there is no store at '{folder}': {reason}; name one with --store, or run something "
            "that keeps its results there"
        )


class CacheWarning(UserWarning):
    """An entry was found broken and set aside."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheFolder:
    """A folder of results by kind and key.

    Parameters
    ----------
    folder : Path
        Is made when the first entry is kept.
    fresh : bool
        True to find nothing that is there, and replace it.
    """

    folder: Path
    fresh: bool = False

    def has(self, kind: str, key: str) -> bool:
        """Whether there is an entry; `get` may still find it broken."""
        return not self.fresh and self.path(kind, key).exists()

    def get(self, kind: str, key: str) -> Any:  # noqa: ANN401 - whatever was kept
        """Return a result, or None if there is none.

        An entry that is not what was written is set aside, with a `CacheWarning`.
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
        StoreError
            If it is not what was written.
        """
        try:
            content = self.path(kind, key).read_bytes()
        except FileNotFoundError:
            raise
        except OSError as error:
            raise StoreError(f"it cannot be read: {error.strerror}") from error
        return read_entry(content, kind, key)

    def put(self, kind: str, key: str, metadata: Metadata, value: object) -> None:
        """Keep a result; a signal that comes meanwhile waits.

        Raises
        ------
        OutputError
            If the folder cannot be written to. What was there before is still there.
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
            raise self._full(error) from error

    def check(self) -> None:
        """Refuse a folder that no program of ours wrote to; an empty one is a store of nothing.

        Raises
        ------
        NoCacheError
            If it is none, or is not there.
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
            raise self._full(error) from error

    def reject(self, kind: str, key: str, reason: str) -> None:
        """Set a broken entry aside, with a `CacheWarning` that says why."""
        path, place = self.path(kind, key), self.folder / ASIDE
        place.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # another process was faster
            path.rename(place / f"{kind}-{key}-{uuid.uuid4().hex[:8]}{path.suffix}")
        self.note("aside", kind, key)
        warnings.warn(
            f"{path}: {reason}; it is set aside in '{place}' and done again",
            CacheWarning,
            stacklevel=3,
        )

    def path(self, kind: str, key: str) -> Path:
        """Return where an entry is."""
        return self.folder / kind / key[:2] / f"{key}.result"

    def _full(self, error: OSError) -> OutputError:
        """Return what to say of a folder that cannot be written to."""
        if isinstance(error, OutputError):
            return error
        return OutputError(
            f"cannot write to the store '{self.folder}': {error.strerror or error}; what is kept "
            "there is whole: make room, or choose another folder with --store, and start again"
        )


def _is_ours(journal: Path) -> bool:
    """Whether a file is a journal of a store: its first lines, or what a full disk left of them."""
    try:
        with journal.open(encoding="utf-8") as file:
            lines = [file.readline() for _ in range(_FIRST)]
    except (FileNotFoundError, IsADirectoryError, UnicodeDecodeError):
        return False
    return not lines[0] or any(line.startswith('{"event": "') for line in lines)


class EntryState(Enum):
    """How an entry is."""

    WHOLE = "whole"
    BROKEN = "broken"


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryStatus:
    """An entry of a store.

    Parameters
    ----------
    kind, key : str
    state : EntryState
    metadata : Metadata or None
        None if the entry cannot be read.
    size : int
        Bytes.
    reason : str
        What is wrong with a broken one.
    """

    kind: str
    key: str
    state: EntryState
    metadata: Metadata | None
    size: int
    reason: str = ""


def inspect_cache(store: CacheFolder, *, thoroughly: bool = False) -> Iterator[EntryStatus]:
    """Yield every entry; one that another program removes meanwhile is none.

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
    """Remove what is not to be kept; return how many entries went, and how many bytes in all.

    Broken entries go as well, and what programs left over that did not come to their end, or that
    kept their results in another format. What is not a store's stays.

    Parameters
    ----------
    store : CacheFolder
    keep : callable
        Whether an entry is kept, from where it comes from.

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
    """Remove a file, or a folder that somebody put in its place; what is gone is gone."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _entries(store: CacheFolder, names: re.Pattern[str]) -> Iterator[Path]:
    """Yield the files KIND/KK/KEY... of a pattern in order of their names."""
    for kind in _listed(store.folder):
        for shelf in _listed(kind):
            for path in _listed(shelf):
                name = names.fullmatch(path.name)
                if name is not None and name["key"][:2] == shelf.name:
                    yield path


def _listed(place: Path) -> list[Path]:
    """Return what is in a folder, sorted; nothing if it is none, or has gone meanwhile."""
    try:
        return sorted(place.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []


def _size(path: Path) -> int:
    """Return the bytes of a file; none if it has gone meanwhile."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def _bytes(store: CacheFolder) -> int:
    # a walk passes over what goes meanwhile, as a glob does not
    return sum(
        _size(Path(root, name)) for root, _, names in os.walk(store.folder) for name in names
    )
