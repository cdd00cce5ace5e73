"""The command end to end on a suite of two cases, and what it writes."""

import json
import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.studies.stability.failure_criteria import StabilityStatus
from harness.studies.stability.suite import SUITES
from tests.support.figures import sentences

RUNNER = CliRunner()
TINY = replace(
    SUITES["quick"],
    scenes=("drop-1-cm", "thin-disk"),
    timesteps=(2e-2, 5e-3, 1e-3),
    random_scenes=3,
)


@pytest.fixture
def report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setitem(SUITES, "quick", TINY)
    out = tmp_path / "report"
    done = RUNNER.invoke(app, ["stability", "--jobs", "1", "--figures", "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert "The verdict on mujoco" in done.output
    return out


@pytest.mark.engine("pybullet")
@pytest.mark.slow
def test_the_report_has_the_map_a_page_for_each_engine_and_the_counts(report: Path) -> None:
    files = {path.name for path in report.rglob("*") if path.is_file()}
    for engine in ("mujoco", "pybullet"):
        for profile in ("matched", "default"):
            assert f"map-{engine}-{profile}.svg" in files
    assert {"largest-timesteps.csv", "hard-cases.csv", "random-scenes.csv", "verdicts.csv"} <= files
    page = (report / "index.html").read_text(encoding="utf-8")
    assert "The verdict on pybullet" in page
    assert "Of 3 random scenes" in page
    captions = re.findall(r'<p class="seen">(.*?)</p>', page)
    assert len(captions) >= 5  # a map of each engine in two profiles, and the limits
    assert {sentences(unescape(caption)) for caption in captions} == {2}
    verdicts = pd.read_csv(report / "tables" / "verdicts.csv")
    assert set(verdicts["verdict"]) <= {verdict.value for verdict in StabilityStatus}
    manifest = json.loads((report / "manifest.json").read_text(encoding="utf-8"))
    assert len(manifest["cases"]) == len(verdicts)
    counts = pd.read_csv(report / "tables" / "verdict-counts.csv")
    on_grid = verdicts[verdicts["timestep_s"].isin(TINY.timesteps)]
    on_grid = on_grid[on_grid["scene"].isin(TINY.scenes)]
    matched = on_grid[on_grid["profile"] == "matched"]
    assert counts[counts["profile"] == "matched"]["runs"].sum() == len(matched) > 0
    limits = pd.read_csv(report / "tables" / "largest-timesteps.csv").set_index(["scene", "engine"])
    assert limits["sound_timestep_s"]["thin-disk", "mujoco"] >= 1e-3


def test_an_unknown_suite_is_refused_before_anything_runs() -> None:
    done = RUNNER.invoke(app, ["stability", "--suite", "vast"])
    assert done.exit_code != 0
    assert "quick or full" in str(done.exception)
