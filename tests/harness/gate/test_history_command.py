"""`rockingcan history`: a report, one JSON object, and refusals before anything is installed."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.core.environments import VARIABLE, environment_names
from harness.engines import registry
from harness.gate.history import study
from harness.results import plausibility
from harness.studies.comparison import study as comparison
from harness.studies.comparison import suite
from tests.support.command_line import Command
from tests.support.environments import described

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    registry.forget_engines()
    yield
    registry.forget_engines()


@pytest.mark.slow
def test_a_release_that_cannot_be_installed_is_a_row_of_the_report(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (study, comparison, suite, plausibility):
        monkeypatch.setattr(module, "SUITES", {"quick": {"gentle-rock": (1e-3,)}})
    version = registry.engine("mujoco").version
    described("mine", registry.entry_of("mujoco").value, sys.executable, command="add mujoco")
    out = tmp_path / "history"
    words = ("history", "mujoco", "--versions", f"0.0.1,{version}", "--out", str(out))
    published = ("--results", str(tmp_path / "results"), "--set", "impratio=10", "--json")
    done = rockingcan(*words, "--jobs", "1", "--store", str(tmp_path / "store"), *published)
    assert done.code == 0, done.err
    absent, ran = json.loads(done.out)["versions"]
    assert (absent["version"], absent["outcome"]) == ("0.0.1", "not installed")
    assert "pip cannot install mujoco==0.0.1" in absent["reason"]
    assert (ran["version"], ran["outcome"], ran["cases"]) == (version, "ran", 3)
    assert json.loads(done.out)["changes"] == []
    assert (out / "index.html").is_file()
    assert (out / "tables" / "versions.csv").is_file()
    (file,) = (tmp_path / "results").iterdir()
    assert file.name == f"mujoco-{version}-quick-impratio-10.json"
    checked = rockingcan("results", "verify", file, "--rerun", "all", "--json").json()["files"][0]
    assert (checked["objections"], len(checked["rerun"])) == ([], 3)
    assert environment_names() == ("mine",)  # which was there before, and stays


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nope", "--versions", "1,2"], "unknown engine 'nope'"),
        (["reference", "--versions", "1,2"], "an engine with a package of its own"),
        (["mujoco", "--versions", "3.5.0"], "two released versions or more"),
        (["mujoco", "--versions", "new,old"], "two released versions or more"),
        (["mujoco", "--versions", "all"], "two released versions or more"),  # no index is asked
        (["mujoco", "--versions", "1,2", "--suite", "short"], "quick or full or field"),
        (["mujoco", "--versions", "1,2", "--scene", "nope"], "one of gentle-rock, paper-release"),
        (["mujoco", "--versions", "1,2", "--set", "cone"], "KEY=VALUE"),
        (["mujoco"], "--versions"),
        (
            ["mujoco", "--versions", "1,2", "--scene", "cusps", "--results", "."],
            "no scene beside --results",
        ),
        (
            ["mujoco", "--versions", "1,2", "--results", f"{__file__}/results"],
            "may write to with --results",
        ),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_wrong_use_is_one_sentence(
    rockingcan: Command, tmp_path: Path, words: list[str], said: str
) -> None:
    refused = rockingcan("history", *words, "--out", str(tmp_path / "out"))
    assert refused.code == 2
    assert said in refused.err
    assert len(refused.err.splitlines()) == 1
    assert not (tmp_path / "out").exists()
