"""`validate --baseline`, `--accept`, `--set` and `diff`: exit codes, and what is said."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

from harness.results.errors import FILE
from harness.results.files import read_scores
from tests.support.command_line import Answer, Command
from tests.support.suites import shorten_suites


@pytest.fixture
def told(rockingcan: Command, monkeypatch: pytest.MonkeyPatch) -> Command:
    """Return a function that runs a command, which says things in wide lines, folded into one."""
    monkeypatch.setenv("COLUMNS", "200")

    def run(*words: object) -> Answer:
        answer = rockingcan(*words)
        return replace(answer, out=" ".join(answer.out.split()))

    return run


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the quick suite three runs, with few members each."""
    shorten_suites(monkeypatch)


QUICK = ("validate", "--engine", "mujoco", "--no-store", "--jobs", 2)


@pytest.mark.slow
@pytest.mark.usefixtures("brief")
def test_accept_then_pass_then_catch_then_compare(told: Command, tmp_path: Path) -> None:
    baseline, before, after = (tmp_path / name for name in ("baseline", "before", "after"))
    baseline.mkdir()
    (baseline / "figure.png").write_bytes(b"stays")
    accepted = told(*QUICK, "--out", before, "--accept", "--baseline", baseline)
    assert accepted.code == 0, accepted
    assert FILE in accepted.out
    assert sorted(path.name for path in baseline.iterdir()) == [FILE, "figure.png"]

    unchanged = told(*QUICK, "--out", before, "--baseline", baseline)
    assert unchanged.code == 0, unchanged
    assert "3 cases of this run (quick suite) were held against" in unchanged.out
    assert "worse" not in unchanged.out
    # a report is read back as what the run was
    report, file = read_scores(before), read_scores(baseline)
    assert {name: one.values["phi_rms_rad"] for name, one in report.scores.items()} == {
        name: one.values["phi_rms_rad"] for name, one in file.scores.items()
    }

    worse = told(*QUICK, "--out", after, "--baseline", baseline, "--set", "mujoco.iterations=2")
    assert worse.code == 1, worse
    assert "Worse: gentle-rock in mujoco" in worse.out
    assert "found has set: mujoco.iterations = 2" in worse.out
    summary = (after / "summary.md").read_text(encoding="utf-8")
    assert "Worse: gentle-rock in mujoco" in summary
    assert (after / "tables" / "gate.csv").is_file()
    written = (after / "junit.xml").read_text(encoding="utf-8")
    suites = {one.get("name"): one for one in fromstring(written)}  # noqa: S314 - our own
    held = suites["mujoco, against accepted results"]
    failed = [case for case in held if case.find("failure") is not None]
    assert ("mujoco.gentle-rock", "phi_rms_rad, matched, 0.001 s") in {
        (case.get("classname"), case.get("name")) for case in failed
    }
    assert held.get("failures") == str(len(failed))
    assert read_scores(after).settings == {"mujoco.iterations": "2"}

    sides = told("diff", before, after, "--baseline", baseline)
    assert sides.code == 0, sides
    assert "A is better: gentle-rock in mujoco" in sides.out
    assert told("diff", before, after, "--gate").code == 1
    assert told("diff", after, before, "--gate").code == 0
    answer = told("diff", before, after, "--json")
    assert {one["verdict"] for one in json.loads(answer.out)["differences"]} == {"a is better"}
    assert told("diff", before, baseline).code == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--baseline", "nowhere"), "'nowhere' is not there"),
        (("--baseline", "."), "neither a report nor accepted results"),
        (("--set", "impratio"), "KEY=VALUE"),
        (("--set", "pybullet.contactERP=0.1"), "a setting of an engine that runs: mujoco"),
        (("--set", "contactERP=0.1"), "ENGINE.KEY=VALUE with one of mujoco: "),
        (("--set", "mujoco.nonsense=1"), "has no setting 'nonsense'"),
        (("--set", "mujoco.impratio=much"), "setting 'impratio' cannot be 'much'"),
        (("--set", "impratio=2", "--set", "mujoco.impratio=3"), "mujoco has it twice"),
        (("--set", "impratio=2", "--accept"), "accepted results are an engine's own"),
        (("--accept", "--baseline", "file"), "no folder that you may write to"),
    ],
)
def test_wrong_use_is_told_before_anything_runs(
    words: tuple[str, ...],
    said: str,
    told: Command,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("", encoding="utf-8")
    answer = told(*QUICK, "--out", tmp_path / "out", *words)
    assert answer.code == 2, answer
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_diff_needs_two_folders_that_can_be_compared(
    told: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert told("diff", "a", "b").code == 2
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "manifest.json").write_text('{"format": "another"}', encoding="utf-8")
    answer = told("diff", "a", "a")
    assert answer.code == 2
    assert answer.err == "rockingcan: 'a' is no report of rockingcan\n"
    shutil.rmtree(tmp_path / "a")
    (tmp_path / "a").mkdir()
    told_by = {"format": "rockingcan-report", "provenance": {}, "cases": []}
    (tmp_path / "a" / "manifest.json").write_text(json.dumps(told_by), encoding="utf-8")
    answer = told("diff", "a", "a")
    assert answer.code == 2
    assert "not of rockingcan validate" in answer.err
