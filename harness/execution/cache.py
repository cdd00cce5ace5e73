"""A folder of entries, several processes at once: written whole, checked when read.

    KIND/KK/KEY.json            the record; an entry is there once this is
    KIND/KK/KEY-CHECK.parquet   its arrays, written before; their checksum is part of the name
    drafts/                     what is being written; a program that was killed leaves its draft
    aside/                      entries that were found broken
    journal.jsonl               a line when a case is begun, and when it is kept: names a store

A file is written as a draft, flushed to the disk and renamed, so that none is ever half there
under its own name. Writers need no lock: those of one case write the same, and the last one counts.
"""

import json
import os
import re
import uuid
import warnings
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from harness.core.errors import OutputError, StoreError
from harness.execution.cache_entry import (
    EntryContent,
    EntryRecord,
    Metadata,
    checksum,
    read_arrays,
    read_record,
    write_arrays,
    write_record,
)
from harness.execution.signals import delay_signals

DRAFTS, ASIDE, JOURNAL = "drafts", "aside", "journal.jsonl"

_FIRST = 5
"""Lines of a journal that are looked at; one may be cut short by a full disk."""

_KEY = "[0-9a-f]{32}"
_DRAWN = "[0-9a-f]{8}"

RECORD = re.compile(rf"(?P<key>{_KEY})\.json")
ARRAYS = re.compile(rf"(?P<key>{_KEY})-[0-9a-f]{{12}}\.parquet")
DRAFT = re.compile(rf"(?P<process>\d+)-{_DRAWN}-{_KEY}(-[0-9a-f]{{12}})?\.(json|parquet)")
SET_ASIDE = re.compile(rf".+-{_KEY}(-[0-9a-f]{{12}})?-{_DRAWN}\.(json|parquet)")
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

    def get(self, kind: str, key: str) -> EntryContent | None:
        """Return what is kept, or None if nothing is.

        An entry that is not what was written is set aside, with a `StoreWarning`.
        """
        if self.fresh:
            return None
        try:
            return self.read(kind, key)
        except FileNotFoundError:
            return None
        except StoreError as error:
            self.reject(kind, key, str(error))
            return None

    def read(self, kind: str, key: str) -> EntryContent:
        """Return what is kept.

        Raises
        ------
        FileNotFoundError
            If there is no entry.
        StoreError
            If it is not what was written.
        """
        record = self.record(kind, key)
        if record.arrays_file is None:
            return EntryContent(record=record.record)
        try:
            arrays = self.path(kind, key).with_name(record.arrays_file).read_bytes()
        except OSError as error:
            raise StoreError(f"its arrays cannot be read: {error.strerror}") from error
        if checksum(arrays) != record.arrays_sha256:
            raise StoreError("the checksum of its arrays is not that of their file")
        return EntryContent(record=record.record, arrays=read_arrays(arrays, record.widths))

    def record(self, kind: str, key: str) -> EntryRecord:
        """Return the record of an entry, its arrays unseen; raises as `read` does."""
        try:
            content = self.path(kind, key).read_bytes()
        except FileNotFoundError:
            raise
        except OSError as error:
            raise StoreError(f"it cannot be read: {error.strerror}") from error
        return read_record(content, kind, key)

    def put(self, kind: str, key: str, about: Metadata, content: EntryContent) -> None:
        """Keep a result; a signal that comes meanwhile waits.

        Raises
        ------
        OutputError
            If the folder cannot be written to. What was there before is still there.
        """
        path = self.path(kind, key)
        try:
            with delay_signals():
                self._make_way(kind, key)
                file = None
                if content.arrays:
                    arrays = write_arrays(content.arrays)
                    digest = checksum(arrays)
                    file = (f"{key}-{digest[:12]}.parquet", digest)
                    self._write(path.with_name(file[0]), arrays)
                self._write(path, write_record(kind, key, about, content, file))
                self.note("kept", kind, key)
        except OSError as error:
            raise self._full(error) from error

    def check(self) -> None:
        """Refuse a folder that no program of ours wrote to; an empty one is a store of nothing.

        Raises
        ------
        NoStoreError
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
        """Set a broken entry aside, with a `StoreWarning` that says why."""
        path, place = self.path(kind, key), self.folder / ASIDE
        place.mkdir(parents=True, exist_ok=True)
        for file in (path, *path.parent.glob(f"{key}-*.parquet")):
            try:
                file.rename(place / f"{kind}-{file.stem}-{uuid.uuid4().hex[:8]}{file.suffix}")
            except FileNotFoundError:  # another process was faster
                continue
        self.note("aside", kind, key)
        warnings.warn(
            f"{path}: {reason}; it is set aside in '{place}' and done again",
            CacheWarning,
            stacklevel=3,
        )

    def path(self, kind: str, key: str) -> Path:
        """Return where the record of an entry is."""
        return self.folder / kind / key[:2] / f"{key}.json"

    def _make_way(self, kind: str, key: str) -> None:
        """Set aside an entry in whose place is a folder, which no file can replace."""
        path = self.path(kind, key)
        if any(file.is_dir() for file in (path, *path.parent.glob(f"{key}-*.parquet"))):
            self.reject(kind, key, "a folder is where a file of it belongs")

    def _write(self, path: Path, content: bytes) -> None:
        """Write a file so that it is there whole or not at all, after a power cut too."""
        drafts = self.folder / DRAFTS
        draft = drafts / f"{os.getpid()}-{uuid.uuid4().hex[:8]}-{path.name}"
        drafts.mkdir(parents=True, exist_ok=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with draft.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)
        place = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)

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
