"""A store: whole entries or none, checked on reading, for several processes."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from harness.core.errors import CacheWarning
from harness.core.writing import WriteError
from harness.execution.cache import (
    ASIDE,
    DRAFTS,
    JOURNAL,
    CacheFolder,
    EntryState,
    inspect_cache,
    prune_cache,
)
from harness.execution.cache_entry import BrokenEntryError, Defect, Metadata
from tests.support.cache_entries import KEY, content, cut, put


def test_what_is_kept_comes_back_bit_for_bit(store: CacheFolder) -> None:
    put(store)
    found = store.get("things", KEY)
    assert found is not None
    assert list(found) == list(content())
    for name, value in content().items():
        if isinstance(value, np.ndarray):
            assert (found[name].dtype, found[name].shape) == (value.dtype, value.shape)
            assert found[name].tobytes() == value.tobytes()
        else:
            assert found[name] == value


def test_what_is_not_there_is_none(store: CacheFolder) -> None:
    assert not store.has("things", KEY)
    assert store.get("things", KEY) is None
    assert list(inspect_cache(store)) == []


def test_fresh_finds_nothing_and_replaces_what_is_there(store: CacheFolder) -> None:
    put(store)
    fresh = CacheFolder(folder=store.folder, fresh=True)
    assert not fresh.has("things", KEY)
    assert fresh.get("things", KEY) is None
    put(fresh, seed=1)
    found = store.get("things", KEY)
    assert found is not None
    assert found["points"].tobytes() == content(1)["points"].tobytes()


def flip(path: Path) -> None:
    """Change one bit in the middle."""
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(bytes(data))


def empty(path: Path) -> None:
    path.write_bytes(b"")


def renamed(path: Path) -> None:
    """Give an entry the content of another."""
    line, _, arrays = path.read_bytes().partition(b"\n")
    told = json.loads(line)
    told["key"] = "cd" * 16
    path.write_bytes(json.dumps(told).encode() + b"\n" + arrays)


def cut_in_the_line(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:100])


def flip_in_the_line(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b'"x": 0.1', b'"x": 0.3'))


@pytest.mark.parametrize("hurt", [cut, flip, empty, cut_in_the_line, flip_in_the_line])
def test_a_broken_entry_is_set_aside_with_a_warning(
    store: CacheFolder, hurt: Callable[[Path], None]
) -> None:
    hurt(put(store))
    with pytest.warns(CacheWarning):
        assert store.get("things", KEY) is None
    assert not store.has("things", KEY)
    assert list((store.folder / ASIDE).iterdir())
    put(store)
    assert store.get("things", KEY) is not None


def test_the_entry_of_another_case_is_refused(store: CacheFolder) -> None:
    renamed(put(store))
    with pytest.raises(BrokenEntryError) as caught:
        store.read("things", KEY)
    assert caught.value.defect is Defect.CHECKSUM
    store.path("things", "ef" * 16).parent.mkdir(parents=True)
    put(store, "cd" * 16).rename(store.path("things", "ef" * 16))
    with pytest.raises(BrokenEntryError) as caught:
        store.read("things", "ef" * 16)
    assert caught.value.defect is Defect.OTHER_CASE


def test_a_survey_names_what_is_broken(store: CacheFolder) -> None:
    put(store)
    flip(put(store, "cd" * 16))
    states = {found.key: found.state for found in inspect_cache(store, thoroughly=True)}
    assert states == {KEY: EntryState.WHOLE, "cd" * 16: EntryState.BROKEN}
    assert {found.state for found in inspect_cache(store)} == {EntryState.WHOLE}  # arrays unseen


def test_pruning_keeps_what_is_current_and_removes_the_rest(store: CacheFolder) -> None:
    put(store)
    store.put("things", "cd" * 16, Metadata(label="old", code="yesterday"), content())
    cut(put(store, "ef" * 16))
    (store.folder / DRAFTS / f"999999999-0dead000-{KEY}.result").write_text(
        "half", encoding="utf-8"
    )
    mine = store.folder / DRAFTS / f"{os.getpid()}-a11fe000-{KEY}.result"
    mine.write_text("half", encoding="utf-8")
    former = [
        put(store).with_name(f"{KEY[:-2]}12{end}") for end in (f"-{12 * '0'}.parquet", ".json")
    ]
    for path in former:
        path.write_bytes(b"")
    removed, freed = prune_cache(store, lambda about: about.code == "today")
    assert removed == 2
    assert freed > 0
    assert [found.key for found in inspect_cache(store)] == [KEY]
    assert [path.name for path in (store.folder / DRAFTS).iterdir()] == [mine.name]
    assert not any(path.exists() for path in former)  # as earlier releases kept results
    assert prune_cache(store, lambda _: False)[0] == 1


def test_a_write_that_fails_leaves_what_was_there(
    store: CacheFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(store)

    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), handle)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(WriteError) as caught:
        put(store, seed=1)
    assert (caught.value.path, caught.value.reason) == (store.folder, os.strerror(errno.ENOSPC))
    monkeypatch.undo()
    found = store.get("things", KEY)
    assert found is not None
    assert found["points"].tobytes() == content()["points"].tobytes()
    assert list((store.folder / DRAFTS).iterdir()) == []


_WRITER = """
import sys
from pathlib import Path
sys.path[:0] = [{tests!r}, {source!r}]
from test_store import CacheFolder, put
store = CacheFolder(folder=Path({folder!r}))
number = 0
while True:
    put(store, f"{{number % 7:032x}}", seed=number % 7)
    number += 1
"""


@pytest.mark.slow
def test_writers_and_readers_at_once_and_a_kill_in_between(store: CacheFolder) -> None:
    program = _WRITER.format(
        tests=str(Path(__file__).parent),
        source=str(Path(__file__).parents[3]),
        folder=str(store.folder),
    )
    writers = [subprocess.Popen([sys.executable, "-c", program]) for _ in range(2)]  # noqa: S603
    try:
        until = time.monotonic() + 60.0
        while time.monotonic() < until and not store.has("things", f"{6:032x}"):
            time.sleep(0.01)
        read = 0
        # a kill in the midst of a write, and readers that never see half of one
        while read < 200:
            for number in range(7):
                found = store.get("things", f"{number:032x}")  # a warning would fail the test
                assert found is not None
                expected = content(number)["points"].tobytes()
                assert found["points"].tobytes() == expected
                read += 1
            if read > 100:
                writers[0].send_signal(signal.SIGKILL)
    finally:
        for writer in writers:
            writer.kill()
            writer.wait()
    assert {found.state for found in inspect_cache(store, thoroughly=True)} == {EntryState.WHOLE}
    lines = (store.folder / JOURNAL).read_text(encoding="utf-8").splitlines()
    assert {json.loads(line)["event"] for line in lines} == {"kept"}
