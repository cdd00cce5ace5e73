"""A report's folder appears whole or not at all, and replaces nothing but a report."""

import json
import os
from pathlib import Path

import pytest

from harness.core.errors import OutputError
from harness.core.writing import ForeignFolderError, WriteError
from harness.report.atomic_folder import FORMAT, MANIFEST, check_writable, replace_folder


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def write(out: Path, word: str) -> None:
    with replace_folder(out) as draft:
        (draft / "word").write_text(word)
        (draft / MANIFEST).write_text(json.dumps({"format": FORMAT}))


def test_a_folder_appears_with_its_parents(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b" / "report"
    check_writable(out)
    assert not (tmp_path / "a").exists()
    write(out, "new")
    assert (out / "word").read_text() == "new"
    assert names(out.parent) == ["report"]


def test_an_earlier_report_is_replaced_as_a_whole(tmp_path: Path) -> None:
    out = tmp_path / "report"
    write(out, "old")
    (out / "left-over").touch()
    check_writable(out)
    write(out, "new")
    assert names(out) == [MANIFEST, "word"]
    assert (out / "word").read_text() == "new"
    assert names(tmp_path) == ["report"]


def test_an_empty_folder_may_be_used(tmp_path: Path) -> None:
    out = tmp_path / "report"
    out.mkdir()
    check_writable(out)
    write(out, "new")
    assert (out / "word").exists()


def test_a_report_behind_a_link_stays_behind_it(tmp_path: Path) -> None:
    write(tmp_path / "there", "old")
    link = tmp_path / "link"
    link.symlink_to("there")
    write(link, "new")
    assert link.is_symlink()
    assert (tmp_path / "there" / "word").read_text() == "new"


@pytest.mark.parametrize("manifest", [None, "{}", "no json", '{"format": "another"}', "[1]"])
def test_a_folder_that_is_no_report_is_refused_and_untouched(
    tmp_path: Path, manifest: str | None
) -> None:
    out = tmp_path / "thesis"
    out.mkdir()
    (out / "chapter").write_text("years of work")
    if manifest is not None:
        (out / MANIFEST).write_text(manifest)
    with pytest.raises(ForeignFolderError) as caught:
        check_writable(out)
    assert (caught.value.path, caught.value.thing) == (out, "report")
    with pytest.raises(ForeignFolderError), replace_folder(out):
        pytest.fail("the folder was given")
    assert (out / "chapter").read_text() == "years of work"
    assert names(tmp_path) == ["thesis"]


def test_a_file_and_a_link_to_nowhere_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for place, word in ((tmp_path / "file", "file"), (tmp_path / "link", "link")):
        with pytest.raises(WriteError) as caught:
            check_writable(place)
        assert caught.value.path == place
        assert word in caught.value.reason
    assert names(tmp_path) == ["file", "link"]


def test_a_parent_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "report"
    for refused in (check_writable, lambda place: write(place, "new")):
        with pytest.raises(WriteError) as caught:
            refused(out)
        assert caught.value.path == out
        assert isinstance(caught.value.__cause__, NotADirectoryError)


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere"
)
def test_a_parent_without_permission_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(WriteError) as caught:
            check_writable(tmp_path / "report")
        assert isinstance(caught.value.__cause__, PermissionError)
    finally:
        tmp_path.chmod(0o755)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a file system for reading only")
def test_a_place_where_nobody_may_write_is_refused() -> None:
    with pytest.raises(WriteError) as caught:
        check_writable(Path("/proc/self/report"))
    assert caught.value.path == Path("/proc/self/report")


@pytest.mark.parametrize("stop", [KeyboardInterrupt, ValueError, OSError])
def test_an_interruption_leaves_things_as_they_were(
    tmp_path: Path, stop: type[BaseException]
) -> None:
    out = tmp_path / "report"
    write(out, "old")

    def interrupted() -> None:
        with replace_folder(out) as draft:
            (draft / "word").write_text("half")
            raise stop

    # what the file system refuses is said in our words, all else goes through
    with pytest.raises(OutputError if stop is OSError else stop):
        interrupted()
    assert (out / "word").read_text() == "old"
    assert names(tmp_path) == ["report"]


def test_an_interruption_between_the_two_moves_puts_the_report_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "report"
    write(out, "old")
    move = Path.rename

    def interrupted(self: Path, target: Path) -> Path:
        if ".draft-" in self.name:
            raise KeyboardInterrupt
        return move(self, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(out, "new")
    assert (out / "word").read_text() == "old"
    assert names(tmp_path) == ["report"]
