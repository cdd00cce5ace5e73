"""What a store tells afterwards: what was begun and kept, and whether two hold the same."""

import csv
import json
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import ASIDE, JOURNAL, CacheFolder, EntryState, inspect_cache
from harness.execution.cache_entry import Encoder

_TIMES = ("setup_s", "wall_s", "cpu_s")
"""Of a simulation: what a second run measures anew."""

_TIMED = frozenset({*_TIMES, "price_s_s"})
"""The columns of a report's tables that hold them, or what follows from them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """The journal of a store in numbers.

    Parameters
    ----------
    tasks : int
        That were begun at all.
    begun : int
        How often one was.
    again : int
        How often one was begun although its result was kept: work lost.
    """

    tasks: int
    begun: int
    again: int


def ledger(store: CacheFolder) -> Ledger:
    """Return the journal of a store in numbers."""
    begun: Counter[str] = Counter()
    kept: set[str] = set()
    again = 0
    for event in _events(store.folder / JOURNAL):
        name = f"{event['kind']} {event['key']}"
        if event["event"] == "begun":
            begun[name] += 1
            again += name in kept
        elif event["event"] == "kept":
            kept.add(name)
    return Ledger(tasks=len(begun), begun=begun.total(), again=again)


def _events(journal: Path) -> list[dict[str, str]]:
    """Return the lines of a journal; one that a full disk cut short is left out."""
    found = []
    for line in journal.read_text(encoding="utf-8").splitlines() if journal.exists() else ():
        try:
            found.append(json.loads(line))
        except ValueError:
            continue
    return found


def broken(store: CacheFolder) -> int:
    """Return how many entries are not what was written, those set aside before included."""
    aside = len(list((store.folder / ASIDE).glob("*")))
    return aside + sum(
        found.state is EntryState.BROKEN for found in inspect_cache(store, thoroughly=True)
    )


def whole(store: CacheFolder) -> int:
    """Return how many entries are what was written."""
    return sum(found.state is EntryState.WHOLE for found in inspect_cache(store, thoroughly=True))


def differing(store: CacheFolder, other: CacheFolder) -> int:
    """Return how many entries two stores do not share bit for bit, times of runs left out."""
    mine, theirs = _bits(store), _bits(other)
    return sum(mine.get(name) != theirs.get(name) for name in mine.keys() | theirs.keys())


def differing_tables(folder: Path, other: Path) -> int:
    """Return how many tables two reports do not share letter for letter, times left out."""
    names = {path.name for place in (folder, other) for path in place.glob("*.csv")}
    return sum(_told(folder / name) != _told(other / name) for name in names)


def _told(table: Path) -> list[dict[str, str]] | None:
    """Return the rows of a table without times; None if it is not there."""
    if not table.exists():
        return None
    with table.open(encoding="utf-8", newline="") as file:
        return [
            {name: value for name, value in row.items() if name not in _TIMED}
            for row in csv.DictReader(file)
        ]


def _bits(store: CacheFolder) -> dict[str, Any]:
    """Return every entry as a text and the bytes of its arrays, times left out."""
    found = {}
    for entry in inspect_cache(store):
        encoder, value = Encoder(), store.read(entry.kind, entry.key).value()
        if isinstance(value, Evaluation):
            no_times: dict[str, Any] = dict.fromkeys(_TIMES, 0.0)
            timeless = replace(value.simulation, **no_times)
            value = replace(value, simulation=timeless)
        text = repr(encoder.encode(value))
        found[f"{entry.kind} {entry.key}"] = (text, [a.tobytes() for a in encoder.arrays])
    return found
