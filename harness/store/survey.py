"""What is in a store: each entry and its state; and what may go."""

import os
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum

from harness.errors import StoreError
from harness.store.entry import About
from harness.store.folder import ASIDE, DRAFTS, Store

_RECENT = 3600.0
"""s: arrays without a record may belong to a program that is about to write it."""


class State(Enum):
    """How an entry is."""

    WHOLE = "whole"
    BROKEN = "broken"


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
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
    state: State
    about: About | None
    size: int
    reason: str = ""


def survey(store: Store, *, thoroughly: bool = False) -> Iterator[Found]:
    """Yield every entry.

    Parameters
    ----------
    store : Store
    thoroughly : bool
        True to read the arrays too and check them.
    """
    for path in sorted(store.folder.glob("*/??/*.json")):
        kind, key = path.parent.parent.name, path.stem
        about, reason = None, ""
        size = path.stat().st_size
        try:
            record = store.record(kind, key)
            about = record.about
            if record.arrays_file is not None:
                arrays = path.with_name(record.arrays_file)
                size += arrays.stat().st_size if arrays.exists() else 0
            if thoroughly:
                store.read(kind, key)
        except StoreError as error:
            reason = str(error)
        state = State.BROKEN if reason else State.WHOLE
        yield Found(kind=kind, key=key, state=state, about=about, size=size, reason=reason)


def prune(store: Store, keep: Callable[[About], bool]) -> tuple[int, int]:
    """Remove what is not to be kept; return how many entries went, and how many bytes in all.

    Broken entries go as well, and what programs left over that did not come to their end.

    Parameters
    ----------
    store : Store
    keep : callable
        Whether an entry is kept, from where it comes from.
    """
    before = _bytes(store)
    removed = 0
    for found in list(survey(store)):
        if found.state is State.BROKEN or found.about is None or not keep(found.about):
            path = store.path(found.kind, found.key)
            path.unlink(missing_ok=True)
            for arrays in path.parent.glob(f"{found.key}-*.parquet"):
                arrays.unlink(missing_ok=True)
            removed += 1
    _remove_left_over(store)
    return removed, before - _bytes(store)


def _remove_left_over(store: Store) -> None:
    """Remove drafts of programs that are gone, arrays without a record, what was set aside."""
    shutil.rmtree(store.folder / ASIDE, ignore_errors=True)
    for draft in (store.folder / DRAFTS).glob("*"):
        owner = draft.name.partition("-")[0]
        if not (owner.isdigit() and _lives(int(owner))):
            draft.unlink(missing_ok=True)
    for arrays in store.folder.glob("*/??/*.parquet"):
        record = arrays.with_name(f"{arrays.stem.rpartition('-')[0]}.json")
        if not record.exists() and time.time() - arrays.stat().st_mtime > _RECENT:
            arrays.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _bytes(store: Store) -> int:
    return sum(path.stat().st_size for path in store.folder.rglob("*") if path.is_file())
