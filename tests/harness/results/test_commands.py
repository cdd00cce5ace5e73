"""`submit`, `results verify` and `results compare`: files, exit codes, and what is said."""

from pathlib import Path

import pytest

from harness.results.files import read_result, write_result
from harness.results.scores import Division
from tests.support.command_line import Command
from tests.support.gate_scores import make_score, make_scores
from tests.support.suites import shorten_suites

PHI = "phi_rms_rad"


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the quick suite three runs, with few members each."""
    shorten_suites(monkeypatch)


def submit(rockingcan: Command, *words: object) -> None:
    """Submit MuJoCo in this process."""
    answer = rockingcan("submit", "--engine", "mujoco", "--jobs", 2, *words)
    assert answer.code == 0, answer


@pytest.mark.slow
@pytest.mark.usefixtures("brief")
def test_submit_then_verify_then_compare(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    told = rockingcan(
        *("submit", "--engine", "mujoco", "--jobs", 2, "--name", "A. Person", "--json")
    ).json()
    result = read_result(Path(told["file"]))
    version = result.engines["mujoco"].version
    assert told == {
        "file": f"reports/results/mujoco-{version}-quick.json",
        "suite": "quick",
        "engine": "mujoco",
        "version": version,
        "divisions": ["as shipped", "matched"],
        "cases": 3,
        "finished": 3,
    }
    assert (result.name, result.note) == ("A. Person", "")
    assert all(score.members == 4 for score in result.cases)
    assert result.perturbed_by

    again = rockingcan("submit", "--engine", "mujoco", "--jobs", 2, "--out", "again.json")
    assert "3 of 3 already in the store" in again.err  # what was stopped goes on
    assert read_result(Path("again.json")).cases == result.cases

    fine = rockingcan("results", "verify", "reports/results", "again.json", "--rerun", "all")
    assert fine.code == 0, fine
    assert fine.out.count("3 cases, 3 of them run again: nothing found") == 2

    opened = ("--set", "mujoco.iterations=2", "--out", "open.json", "--fresh")
    submit(rockingcan, *opened)
    settings = read_result(Path("open.json"))
    assert settings.settings == {"mujoco.iterations": "2"}
    assert {score.division for score in settings.cases} == {Division.OPEN}
    checked = rockingcan("results", "verify", "open.json", "--rerun", "all", "--json").json()
    assert (checked["failed"], len(checked["files"][0]["rerun"])) == (0, 3)
    one = rockingcan("results", "verify", "open.json", "--rerun", "1")
    words = one.out.split("the same cases again: ")[1].split()
    assert [words[0], words[2]] == ["--rerun", "--seed"]
    drawn = rockingcan("results", "verify", "open.json", "--json", *words).json()
    assert (drawn["seed"], len(drawn["files"][0]["rerun"])) == (int(words[3]), 1)

    none = rockingcan("results", "compare", "again.json", "open.json")
    assert (none.code, "have no case in common" in none.err) == (2, True)

    better = {**result.cases[0].values, PHI: 1e-3 * result.cases[0].values[PHI]}
    forged = [result.cases[0].model_copy(update={"values": better}), *result.cases[1:]]
    write_result(result.of_cases(forged), Path("forged.json"))
    caught = rockingcan("results", "verify", "forged.json", "--rerun", "all")
    assert caught.code == 1, caught
    said = " ".join(caught.out.split())
    assert "not the numbers of the same case, run here: gentle-rock in mujoco" in said
    assert rockingcan("results", "verify", "forged.json", "--rerun", "0").code == 0
    changes = rockingcan("results", "compare", "again.json", "forged.json", "--json").json()
    assert set(changes["divisions"]) == {"as shipped", "matched"}
    (change,) = changes["divisions"]["as shipped"]["differences"]
    assert (change["quantity"], change["verdict"]) == (PHI, "b is better")
    assert changes["divisions"]["matched"]["differences"] == []


def test_divisions_are_compared_one_by_one(rockingcan: Command, tmp_path: Path) -> None:
    shipped = {"profile": "default", "timestep": 0.0, "division": Division.AS_SHIPPED}
    for name, size in (("a", 1.0), ("b", 2.0)):
        scores = make_score({PHI: size}, **shipped), make_score({PHI: 1.0})  # type: ignore[arg-type]
        write_result(make_scores(*scores), tmp_path / f"{name}.json")
    paths = (tmp_path / "a.json", tmp_path / "b.json")
    shown = rockingcan("results", "compare", *paths)
    assert shown.code == 0, shown
    first, second = shown.out.split("Division: ")[1:]
    assert first.startswith("as shipped")
    assert "A is better" in first
    assert second.startswith("matched")
    assert "better" not in second


def test_suites_are_not_compared(rockingcan: Command, tmp_path: Path) -> None:
    for suite in ("quick", "full"):
        write_result(make_scores(make_score({PHI: 1.0}), suite=suite), tmp_path / suite)
    answer = rockingcan("results", "compare", tmp_path / "quick", tmp_path / "full")
    assert answer.code == 2
    assert "of different suites (quick, full)" in answer.err


def test_a_file_that_is_no_result_fails_and_the_others_are_checked(
    rockingcan: Command, tmp_path: Path
) -> None:
    (tmp_path / "a.json").write_text("{}", encoding="utf-8")
    theirs = make_score({PHI: 1e-3, "steps": 1.0, "cpu_s": 1.0}, engine="theirs", outcome="FLAT")
    write_result(make_scores(theirs, suite="quick"), tmp_path / "b.json")
    answer = rockingcan("results", "verify", tmp_path, "--json")
    again = rockingcan("results", "verify", tmp_path, "--json", "--seed", 7).json()
    assert again.pop("seed") == 7
    seeds = {rockingcan("results", "verify", tmp_path, "--json").json()["seed"] for _ in range(3)}
    assert len(seeds) > 1  # drawn anew
    assert again.items() < answer.json().items()
    assert answer.code == 1
    first, second = answer.json()["files"]
    assert first["objections"][0]["rule"] == "a file of the published schema"
    assert "is no result of version 2" in first["objections"][0]["text"]
    assert second["not_rerun"]["theirs"] == "no engine of that name is registered here"
    assert answer.json()["failed"] == 2  # its scene is none of this program's


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("results", "verify", "nowhere"), "'nowhere' is not there"),
        (("results", "verify", "."), "'.' holds no results"),
        (("results", "verify", "file", "--rerun", "some"), "a number of cases, or 'all'"),
        (("results", "compare", "nowhere", "file"), "'nowhere' is not there"),
        (("submit", "--engine", "mujoco", "--out", "file/a.json"), "may write to with --out"),
        (("submit", "--engine", "mujoco", "--suite", "slow"), "'slow'"),
        (("submit", "--engine", "mujoco", "--set", "pybullet.contactERP=1"), "that runs: mujoco"),
        (("submit", "--engine", "mujoco", "--name", "two\nlines"), "words on one line"),
        (("submit", "--engine", "none"), "unknown engine 'none'"),
    ],
)
def test_wrong_use_is_told_before_anything_runs(
    words: tuple[str, ...],
    said: str,
    rockingcan: Command,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("", encoding="utf-8")
    answer = rockingcan(*words)
    assert answer.code == 2, answer
    assert said in answer.err
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("name", ["verify", "compare"])
def test_every_command_of_results_teaches(rockingcan: Command, name: str) -> None:
    answer = rockingcan("results", name, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Usage: rockingcan results {name} [OPTIONS]" in " ".join(answer.out.split())
    assert "For example: rockingcan results" in answer.out
