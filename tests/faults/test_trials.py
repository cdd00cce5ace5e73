"""The trials of the fault report, shorter: three kills of a brief command, and the others."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.faults import interruptions
from tests.faults.interruptions import SUITE, disk, kills, signals
from tests.faults.journal_check import differing_tables
from tests.faults.programs import ENGINES
from tests.faults.sweeps import Sizes, _Part, sweeps
from tests.faults.trial import Trial
from tests.faults.workers import deadly

pytestmark = pytest.mark.slow  # programs that are started dozens of times


@pytest.mark.parametrize("trial", [deadly, disk, signals], ids=lambda trial: trial.__name__)
def test_nothing_is_lost(
    trial: Callable[[Path, Callable[[str], None]], Trial],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # how soon a command ends is for the report to judge, on a machine that does nothing else
    monkeypatch.setattr(interruptions, "_PROMPT", 120.0)
    told: list[str] = []
    found = trial(tmp_path, told.append)
    assert found.passed, found.found
    assert told


BRIEF = ("attribute", "gentle-rock", "--engine", ENGINES[-1])
"""A command of the same kind as the suite, of half a minute."""


def test_nothing_is_lost_in_three_kills(tmp_path: Path) -> None:
    found = kills(3, tmp_path, lambda _: None, BRIEF)
    assert found.passed, found.found
    # a machine that was slow meanwhile may have come through before a kill
    assert re.search(r"3 random moments of \d+ suites", found.done)


def test_what_is_killed_is_the_suite_as_it_is_typed() -> None:
    assert SUITE == ("validate", "--suite", "quick")


def test_a_command_that_does_not_come_through_is_no_proof(tmp_path: Path) -> None:
    found = kills(3, tmp_path, lambda _: None, ("validate", "--suite", "quickest"))
    assert not found.passed
    assert "quickest" in found.found[0]


def test_tables_are_compared_but_for_their_times(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in ("mine", "theirs")]
    for folder, seconds in zip(folders, ("0.1", "0.2"), strict=True):
        folder.mkdir()
        (folder / "a.csv").write_text(f"x,wall_s,price_s_s\n1.5,{seconds},{seconds}\n")
    assert differing_tables(*folders) == 0
    (folders[0] / "b.csv").write_text("x\n")
    assert differing_tables(*folders) == 1
    (folders[0] / "a.csv").write_text("x,wall_s,price_s_s\n1.6,0.1,0.1\n")
    assert differing_tables(*folders) == 2


TINY = Sizes(maps=((2, 10), (4, 10), (8, 10), (10, 10)), runs=20, telling=False)


def test_sweeps_are_timed_weighed_and_compared(tmp_path: Path) -> None:
    found = sweeps(TINY, tmp_path, lambda _: None)
    assert found.passed, found.found
    command, cost, scaling = found.found
    assert command.startswith("100 releases, the whole command")
    # the interpreter with arrays and figures is some 100 MB
    assert 30 < float(command.split("at most ")[1].split(" MB")[0]) < 500
    assert all(f"us of {count}" in cost for count in (20, 40, 80, 100))
    assert "1 files, the same to the byte" in scaling
    assert all("(of so few not judged)" in part for part in (cost, scaling))
    assert list((tmp_path / "command" / "map" / "parts").iterdir())


_SLOW = """
import os, time
block = bytearray(b"1" * 60_000_000)
child = os.fork()
time.sleep(0.5)
if child:
    print('"scenes": 100')
"""
"""Two processes of 60 MB each, half a second long."""


@pytest.mark.parametrize(
    ("seconds", "megabytes", "code", "passed"),
    [
        (60.0, 500.0, 0, True),
        (0.4, 500.0, 0, False),
        (60.0, 100.0, 0, False),
        (60.0, 500.0, 3, False),
    ],
)
def test_a_command_that_takes_too_long_or_too_much_or_fails_does_not_pass(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    seconds: float,
    megabytes: float,
    code: int,
    *,
    passed: bool,
) -> None:
    monkeypatch.setattr(
        "tests.faults.sweeps._PROGRAM", f"{_SLOW}\nos._exit({code})" if code else _SLOW
    )
    monkeypatch.setattr("tests.faults.sweeps._SECONDS", seconds)
    monkeypatch.setattr("tests.faults.sweeps._MEMORY", megabytes * 1e6)
    monkeypatch.setattr("tests.faults.sweeps._cost", lambda *_: _Part(words="", passed=True))
    monkeypatch.setattr("tests.faults.sweeps._scaling", lambda *_: _Part(words="", passed=True))
    found = sweeps(TINY, tmp_path, lambda _: None)
    assert found.passed is passed, found.found
    held = float(found.found[0].split("at most ")[1].split(" MB")[0])
    assert held > 120


@pytest.mark.parametrize("telling", [True, False])
def test_ratios_are_judged_where_they_tell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, telling: bool
) -> None:
    fine = _Part(words="", passed=True)
    monkeypatch.setattr("tests.faults.sweeps._whole_command", lambda *_: fine)
    monkeypatch.setattr("tests.faults.sweeps._FLAT", 0.0)
    monkeypatch.setattr("tests.faults.sweeps._scaling", lambda *_: fine)
    found = sweeps(replace(TINY, telling=telling), tmp_path, lambda _: None)
    assert found.passed is not telling
