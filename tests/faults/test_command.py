"""The command of the trials: one of them alone leaves the report as it is."""

from collections.abc import Callable
from pathlib import Path

import pytest

from harness.cli.main import code_of
from tests.faults.__main__ import app
from tests.faults.trial import Trial
from tests.faults.trials import TRIALS, Demands

Command = Callable[..., int]


@pytest.fixture
def told() -> Command:
    """Return a function that runs the program in this process and returns its exit code."""
    return lambda *words: code_of(list(words), app, "rockingcan faults")


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Put short trials into the places of all, the last of which fails; return those tried."""
    names: list[str] = []

    def of(name: str) -> Callable[[Demands, Path, Callable[[str], None]], Trial]:
        def trial(demands: Demands, folder: Path, told: Callable[[str], None]) -> Trial:
            del demands, folder
            told(name)
            names.append(name)
            passed = name != "sweeps"
            return Trial(name=name, done="", demanded="", found=(), passed=passed, seconds=0.0)

        return trial

    monkeypatch.setattr("tests.faults.__main__.TRIALS", {name: of(name) for name in TRIALS})
    return names


def test_one_trial_alone_writes_no_report(told: Command, tried: list[str], tmp_path: Path) -> None:
    out = tmp_path / "reports"
    assert told("--only", "disk", "--out", str(out)) == 0
    assert tried == ["disk"]
    assert told("--only", "sweeps", "--only", "kills", "--out", str(out)) == 1
    assert tried == ["disk", "sweeps", "kills"]
    assert not out.exists()


def test_all_trials_write_the_report(told: Command, tried: list[str], tmp_path: Path) -> None:
    assert told("--out", str(tmp_path / "reports")) == 1
    assert tried == list(TRIALS)
    page = (tmp_path / "reports" / "faults.md").read_text(encoding="utf-8")
    assert "| sweeps | FAILED |" in page
    assert "| kills | passed |" in page


def test_a_trial_that_is_none_is_refused(
    told: Command, tried: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told("--only", "floods", "--out", str(tmp_path / "reports")) == 2
    assert ", ".join(TRIALS) in capsys.readouterr().err
    assert not tried
    assert not (tmp_path / "reports").exists()
