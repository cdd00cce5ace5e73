"""The commands of the store, and options of running that exclude each other."""

from pathlib import Path

import pytest

from tests.support.command_line import Command

RUN = ("attribute", "gentle-rock", "--engine", "mujoco", "--jobs", "1")


@pytest.mark.slow
def test_a_second_run_does_nothing_and_says_so(rockingcan: Command, tmp_path: Path) -> None:
    words = ("--store", str(tmp_path))
    first = rockingcan(*RUN, "--json", *words)
    assert "already in the store" not in first.err
    again = rockingcan(*RUN, "--json", *words)
    assert again.out == first.out
    listed = rockingcan("store", "list", "--json", *words).json()["entries"]
    count = len(listed)
    assert f"{count} of {count} already in the store '{tmp_path}'" in again.err
    assert {entry["state"] for entry in listed} == {"whole"}
    assert all(entry["command"].startswith("rockingcan run gentle-rock") for entry in listed)
    assert f"{count} entries" in rockingcan("store", "list", *words).out

    broken = next(tmp_path.glob("evaluations/??/*.result"))
    broken.write_bytes(broken.read_bytes()[:-1])
    verified = rockingcan("store", "verify", *words)
    assert verified.code == 1
    assert f"{count - 1} of {count} entries are whole" in verified.out
    assert rockingcan("store", "verify", *words).code == 0

    third = rockingcan(*RUN, "--json", *words)
    assert third.out == first.out
    assert f"{count - 1} of {count} already in the store" in third.err
    assert "removed 0 entries" in rockingcan("store", "prune", *words).out
    assert f"removed {count} entries" in rockingcan("store", "prune", "--all", *words).out
    assert rockingcan("store", "list", "--json", *words).json()["entries"] == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--jobs", "2", "--on", "tcp://127.0.0.1:1"), "nothing beside --on"),
        (("--no-store", "--fresh"), "nothing beside --store or --fresh"),
        (("--time-limit", "0"), "a positive number of seconds"),
        (("--memory-limit", "-1"), "a positive number of bytes"),
    ],
)
def test_options_that_make_no_sense_are_refused(
    rockingcan: Command, words: tuple[str, ...], said: str
) -> None:
    answer = rockingcan("attribute", "gentle-rock", "--engine", "mujoco", *words)
    assert answer.code == 2
    assert said in answer.err


def test_an_empty_folder_is_a_store_of_nothing(rockingcan: Command, tmp_path: Path) -> None:
    words = ("--store", str(tmp_path))
    assert "0 entries" in rockingcan("store", "list", *words).out
    assert rockingcan("store", "verify", *words).code == 0
    assert rockingcan("store", "prune", *words).code == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["list", "verify", "prune"])
@pytest.mark.parametrize(
    ("what", "reason"),
    [("none", "it is not there"), ("file", "Not a directory"), ("mine", "it has no 'journal")],
)
def test_what_is_no_store_is_refused_and_left_alone(
    rockingcan: Command, tmp_path: Path, command: str, what: str, reason: str
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    chapters = [tmp_path / "mine" / name for name in ("aside/thesis.txt", "drafts/chapter1.md")]
    for chapter in chapters:
        chapter.parent.mkdir(parents=True)
        chapter.write_text("a year of work", encoding="utf-8")
    answer = rockingcan("store", command, "--store", str(tmp_path / what))
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith(f"rockingcan: there is no store at '{tmp_path / what}': {reason}")
    assert len(answer.err.splitlines()) == 1
    assert all(chapter.exists() for chapter in chapters)
    assert not (tmp_path / "none").exists()
