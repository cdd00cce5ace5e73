"""Figures for paper are drawn within the `--jobs` of the command."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from harness.cli.main import code_of
from harness.cli.run_options import RunOptions
from harness.cli.study_command import run_command
from harness.execution.limits import NO_LIMITS
from harness.report import write


@pytest.fixture
def jobs(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Return how many processes draw, for each report that is written; none is drawn."""
    found: list[object] = []

    def draw(*words: Any) -> dict[str, Any]:
        found.append(words[-1])
        return {}

    monkeypatch.setattr(write, "_draw", draw)
    return found


def test_of_a_sweep(jobs: list[object], tmp_path: Path) -> None:
    words = ["sweep", "gentle-rock", "--over", "can.h=1:2:2", "--quantity", "epsilon"]
    out = ["--out", str(tmp_path / "sweep"), "--figures", "--json"]
    assert code_of([*words, *out, "--jobs", "1"]) == 0
    assert jobs == [1]


def test_of_a_study(jobs: list[object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = SimpleNamespace(manifest=list)
    monkeypatch.setattr("harness.cli.study_command.run_with_progress", lambda *_: done)
    run_command(
        SimpleNamespace(name="nothing", report=lambda _: ()),
        RunOptions(jobs=1, on=None, limits=NO_LIMITS, store=None),
        out=tmp_path / "report",
        json=False,
        figures=True,
        show=lambda *_: None,
    )
    assert jobs == [1]
