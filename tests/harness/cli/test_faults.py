"""The command of the trials: one of them alone leaves the report as it is."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from harness.faults.trial import Trial
from harness.faults.trials import TRIALS, Demands

Command = Callable[..., Any]


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

    monkeypatch.setattr("harness.cli.benchmark.TRIALS", {name: of(name) for name in TRIALS})
    return names


def test_one_trial_alone_writes_no_report(told: Command, tried: list[str], tmp_path: Path) -> None:
    out = tmp_path / "reports"
    assert told("faults", "--only", "disk", "--out", str(out)).code == 0
    assert tried == ["disk"]
    assert told("faults", "--only", "sweeps", "--only", "kills", "--out", str(out)).code == 1
    assert tried == ["disk", "sweeps", "kills"]
    assert not out.exists()


def test_all_trials_write_the_report(told: Command, tried: list[str], tmp_path: Path) -> None:
    assert told("faults", "--out", str(tmp_path / "reports")).code == 1
    assert tried == list(TRIALS)
    page = (tmp_path / "reports" / "faults.md").read_text(encoding="utf-8")
    assert "| sweeps | FAILED |" in page
    assert "| kills | passed |" in page


def test_a_trial_that_is_none_is_refused(told: Command, tried: list[str], tmp_path: Path) -> None:
    answer = told("faults", "--only", "floods", "--out", str(tmp_path / "reports"))
    assert answer.code == 2
    assert ", ".join(TRIALS) in answer.err
    assert not tried
    assert not (tmp_path / "reports").exists()
