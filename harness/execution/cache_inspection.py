"""What is in a store: each entry and its state; and what may go."""

import math
import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from harness.core.errors import StoreError
from harness.execution.cache import ARRAYS, ASIDE, DRAFT, DRAFTS, RECORD, SET_ASIDE, CacheFolder
from harness.execution.cache_entry import Metadata

_RECENT = 3600.0
"""s: arrays that no record names may belong to a program that is about to write it, or to one that
reads the record before the present one."""

_SHELF = 2
"""Characters of a key that name the folder of its entry."""


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
    state : State
    about : About or None
        None if the record cannot be read.
    size : int
        Bytes, arrays included.
    reason : str
        What is wrong with a broken one.
    """

    kind: str
    key: str
    state: EntryState
    about: Metadata | None
    size: int
    reason: str = ""


def inspect_cache(store: CacheFolder, *, thoroughly: bool = False) -> Iterator[EntryStatus]:
    """Yield every entry; one that another program removes meanwhile is none.

    Parameters
    ----------
    store : Store
    thoroughly : bool
        True to read the arrays too and check them.
    """
    for path, _ in _entries(store, RECORD):
        found = _found(store, path, thoroughly=thoroughly)
        if found is not None:
            yield found


def _found(store: CacheFolder, path: Path, *, thoroughly: bool) -> EntryStatus | None:
    """Return the entry of a record's file, or None if it has gone meanwhile."""
    kind, key = path.parent.parent.name, path.stem
    about, reason = None, ""
    size = _size(path)
    try:
        record = store.record(kind, key)
        about = record.about
        if record.arrays_file is not None:
            size += _size(path.with_name(record.arrays_file))
        if thoroughly:
            store.read(kind, key)
    except FileNotFoundError:
        return None
    except StoreError as error:
        if not path.exists():  # a record goes before its arrays
            return None
        reason = str(error)
    state = EntryState.BROKEN if reason else EntryState.WHOLE
    return EntryStatus(kind=kind, key=key, state=state, about=about, size=size, reason=reason)


def prune_cache(store: CacheFolder, keep: Callable[[Metadata], bool]) -> tuple[int, int]:
    """Remove what is not to be kept; return how many entries went, and how many bytes in all.

    Broken entries go as well, and what programs left over that did not come to their end, or
    replaced. What is not a store's stays.

    Parameters
    ----------
    store : Store
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
    for found in list(inspect_cache(store)):
        if found.state is EntryState.BROKEN or found.about is None or not keep(found.about):
            path = store.path(found.kind, found.key)
            _remove(path)
            for arrays in path.parent.glob(f"{found.key}-*.parquet"):
                _remove(arrays)
            removed += 1
    _remove_left_over(store)
    return removed, before - _bytes(store)


def _remove_left_over(store: CacheFolder) -> None:
    """Remove drafts of programs that are gone, arrays no record names, what was set aside.

    Nothing that has not a name as a store gives it.
    """
    for place in _listed(store.folder / ASIDE):
        if SET_ASIDE.fullmatch(place.name):
            _remove(place)
    for draft in _listed(store.folder / DRAFTS):
        name = DRAFT.fullmatch(draft.name)
        if name is not None and not _lives(int(name["process"])):
            _remove(draft)
    for arrays, key in _entries(store, ARRAYS):
        if _left_over(store, arrays, key):
            _remove(arrays)
    with suppress(OSError):  # not empty, or not there
        (store.folder / ASIDE).rmdir()


def _left_over(store: CacheFolder, arrays: Path, key: str) -> bool:
    """Whether arrays belong to no entry, and to none that is being written or read."""
    record = arrays.with_name(f"{key}.json")
    if min(_age(arrays), _age(record) if record.exists() else math.inf) <= _RECENT:
        return False
    try:
        return store.record(arrays.parent.parent.name, key).arrays_file != arrays.name
    except FileNotFoundError:
        return True
    except StoreError:  # broken meanwhile: the next time
        return False


def _remove(path: Path) -> None:
    """Remove a file, or a folder that somebody put in its place; what is gone is gone."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _entries(store: CacheFolder, names: re.Pattern[str]) -> Iterator[tuple[Path, str]]:
    """Yield the files KIND/KK/KEY of a pattern and their keys, in order of their names."""
    for kind in _listed(store.folder):
        for shelf in _listed(kind):
            if len(shelf.name) == _SHELF:
                for path in _listed(shelf):
                    name = names.fullmatch(path.name)
                    if name is not None and name["key"].startswith(shelf.name):
                        yield path, name["key"]


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


def _age(path: Path) -> float:
    """Return the seconds since a file was written; none if it has gone meanwhile."""
    try:
        return time.time() - path.stat().st_mtime
    except FileNotFoundError:
        return 0.0


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _bytes(store: CacheFolder) -> int:
    # a walk passes over what goes meanwhile, as a glob does not
    return sum(
        _size(Path(root, name)) for root, _, names in os.walk(store.folder) for name in names
    )
