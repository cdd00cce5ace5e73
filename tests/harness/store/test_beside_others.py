"""A store in which others write and remove meanwhile, and folders lie where files belong."""

import errno
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from harness.core.errors import CacheWarning
from harness.execution.cache import (
    ASIDE,
    DRAFTS,
    CacheFolder,
    EntryState,
    inspect_cache,
    prune_cache,
)
from harness.execution.cache_entry import BrokenEntryError, CacheEntry, Defect
from tests.support.cache_entries import KEY, content, put

OTHER = KEY[:-2] + "cd"
"""In the folder of `KEY`."""

_ARRAYS = f"-{12 * 'a'}.parquet"
"""Of a file that earlier releases kept."""


def folder_in_place_of(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "mine").write_text("kept", encoding="utf-8")


def test_an_entry_that_goes_before_it_is_looked_at_is_none(store: CacheFolder) -> None:
    put(store)
    gone = put(store, OTHER)
    found = inspect_cache(store, thoroughly=True)
    assert next(found).key == KEY
    gone.unlink()
    assert list(found) == []


def test_an_entry_that_goes_while_it_is_looked_at_is_none(
    store: CacheFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(store)
    path = put(store, OTHER)
    usual = CacheFolder.read

    def read(self: CacheFolder, kind: str, key: str) -> CacheEntry:
        if key == OTHER:
            path.unlink()
        return usual(self, kind, key)

    monkeypatch.setattr(CacheFolder, "read", read)
    assert [found.key for found in inspect_cache(store, thoroughly=True)] == [KEY]


def test_a_survey_and_pruning_bear_with_a_program_that_writes_and_removes(
    store: CacheFolder,
) -> None:
    put(store)
    done = threading.Event()

    def others() -> None:
        place = store.folder / DRAFTS
        while not done.is_set():
            passing = [place / f"999999999-{number:08x}-{KEY}.result" for number in range(20)]
            shelves = [store.folder / "things" / f"{number:02d}" for number in range(20)]
            for shelf in shelves:
                shelf.mkdir(exist_ok=True)
                key = f"{shelf.name}{KEY[2:]}"
                passing += [
                    shelf / f"{key}{end}" for end in (".result", ".json", f"-{12 * 'a'}.parquet")
                ]
            for path in passing:
                path.write_bytes(b"")
            for path in passing:
                path.unlink(missing_ok=True)
            for shelf in shelves:
                shelf.rmdir()

    thread = threading.Thread(target=others)
    thread.start()
    try:
        for _ in range(60):
            found = [one for one in inspect_cache(store, thoroughly=True) if one.size]
            assert [one.key for one in found] == [KEY]
            prune_cache(store, lambda _: True)
            assert store.has("things", KEY)
    finally:
        done.set()
        thread.join()


def test_a_folder_in_place_of_a_file_is_a_broken_entry(store: CacheFolder) -> None:
    folder_in_place_of(put(store))
    (found,) = inspect_cache(store, thoroughly=True)
    assert found.state is EntryState.BROKEN
    said = str(BrokenEntryError(defect=Defect.UNREADABLE, reason=os.strerror(errno.EISDIR)))
    assert found.reason == said
    with pytest.warns(CacheWarning, match=said):
        assert store.get("things", KEY) is None
    assert [place.read_text() for place in (store.folder / ASIDE).rglob("mine")] == ["kept"]


def test_what_is_kept_over_a_folder_sets_it_aside(store: CacheFolder) -> None:
    folder_in_place_of(put(store))
    fresh = CacheFolder(folder=store.folder, fresh=True)  # which never looks at what is there
    with pytest.warns(CacheWarning, match="a folder is where a file of it belongs"):
        put(fresh)
    found = store.get("things", KEY)
    assert found is not None
    assert found["count"].tobytes() == content()["count"].tobytes()
    assert [place.read_text() for place in (store.folder / ASIDE).rglob("mine")] == ["kept"]


@pytest.mark.parametrize("where", ["entry", "draft"])
def test_pruning_removes_folders_in_place_of_files(store: CacheFolder, where: str) -> None:
    path = put(store)
    draft = store.folder / DRAFTS / f"999999999-0dead000-{KEY}.result"
    draft.write_text("half", encoding="utf-8")
    place = {"entry": path, "draft": draft}[where]
    folder_in_place_of(place)
    prune_cache(store, lambda about: where == "draft" and about.label == "a case")
    assert not place.exists()


def test_reading_leaves_no_thread_that_could_outlive_the_program(store: CacheFolder) -> None:
    put(store)
    program = f"""
import sys
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parents[3])!r})
from harness.execution.cache import CacheFolder


def threads():
    names = [place.read_text() for place in Path("/proc/self/task").glob("*/comm")]
    return len([name for name in names if not name.startswith("jemalloc")])  # it runs no Python


before = threads()
found = CacheFolder(folder=Path({str(store.folder)!r})).get("things", {KEY!r})
assert found is not None and len(found["count"]) == 50
print(threads() - before)
"""
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "0\n"
