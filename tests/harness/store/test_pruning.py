"""Pruning removes nothing that is not a store's own."""

import os
from pathlib import Path

import pytest

from harness.core.errors import CacheWarning
from harness.execution.cache import (
    ASIDE,
    DRAFTS,
    JOURNAL,
    CacheFolder,
    NoCacheError,
    inspect_cache,
    prune_cache,
)
from tests.support.cache_entries import KEY, cut, put

YESTERDAY = 86_400.0
"""s: by then no program is writing, or reading, what was written."""


def aged(*paths: Path) -> None:
    """Date files back."""
    for path in paths:
        then = path.stat().st_mtime - YESTERDAY
        os.utime(path, (then, then))


def test_what_is_not_a_stores_own_stays(store: CacheFolder) -> None:
    cut(put(store))
    with pytest.warns(CacheWarning, match="set aside"):
        assert store.get("things", KEY) is None
    mine = [
        store.folder / ASIDE / "thesis.txt",
        store.folder / DRAFTS / "chapter1.md",
        store.folder / DRAFTS / "999999999-chapter.result",
        store.folder / "proj" / "ab" / "abc.result",
        store.folder / "proj" / "ab" / "abc-1.parquet",
        store.folder / "proj" / "ab" / f"cd{KEY[2:]}.json",
        store.folder / "proj" / "ab" / f"cd{KEY[2:]}.result",
    ]
    for path in mine:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("a year of work", encoding="utf-8")
        aged(path)
    assert prune_cache(store, lambda _: False)[0] == 0
    assert [path for path in mine if not path.exists()] == []
    assert [path.name for path in (store.folder / ASIDE).iterdir()] == ["thesis.txt"]
    assert list(inspect_cache(store)) == []


@pytest.mark.parametrize("journal", [None, "", "Dear diary,\n", '{"event": "kept"'])
def test_a_journal_of_ours_makes_a_store(store: CacheFolder, journal: str | None) -> None:
    put(store).unlink()
    (store.folder / JOURNAL).unlink()
    if journal is not None:
        (store.folder / JOURNAL).write_text(journal, encoding="utf-8")
    if journal in {"", '{"event": "kept"'}:  # a full disk leaves as much of it
        assert prune_cache(store, lambda _: True)[0] == 0
        return
    with pytest.raises(NoCacheError) as caught:
        prune_cache(store, lambda _: True)
    assert caught.value.folder == store.folder


@pytest.mark.parametrize(("before", "ours"), [(4, True), (5, False)])
def test_of_a_journal_the_first_five_lines_are_looked_at(
    store: CacheFolder, before: int, *, ours: bool
) -> None:
    put(store).unlink()
    lines = ["cut short by a full disk\n"] * before + ['{"event": "kept"}\n']
    (store.folder / JOURNAL).write_text("".join(lines), encoding="utf-8")
    if ours:
        assert prune_cache(store, lambda _: True)[0] == 0
        return
    with pytest.raises(NoCacheError) as caught:
        prune_cache(store, lambda _: True)
    assert caught.value.folder == store.folder
