"""The command that scores records: exact to round-off, and plain about what a record lacks."""

import csv
import json
import math
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory
from harness.engines.reference.to_reference_problem import refusal
from harness.records.evidence import NOT_CHECKED, evidence
from harness.records.export import exact_frame
from harness.records.score import Labels, score
from models import Scene, load
from models.catalogue import names
from models.scene import Horizon
from tests.harness.records.written import EVERY, frame_of, saved
from tests.support.command_line import Command

EXACT = [name for name in names() if not refusal(load(name))]


@pytest.fixture
def motion(rockingcan: Command, tmp_path: Path) -> Path:
    """Return the exact motion of gentle-rock, as the command writes it."""
    path = tmp_path / "motion.csv"
    assert rockingcan("export", "gentle-rock", "--format", "csv", "--out", str(path)).code == 0
    return path


def test_the_exact_motion_scores_no_error(rockingcan: Command, motion: Path) -> None:
    answer = rockingcan("score", "gentle-rock", str(motion), "--json").json()
    run = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--json").json()
    errors = answer["errors"]
    off = (errors["phi_rms_rad"], errors["contact_locus_rms_m"], *errors["angle_of_turn_deg"])
    assert max(map(abs, off)) < 1e-12
    assert abs(errors["peak_friction_ratio"][0]) < 1e-13
    assert answer["unknown"] == []
    assert run.keys() <= answer.keys()


@pytest.mark.parametrize("name", EXACT)
def test_every_exact_motion_scores_to_round_off(name: str, tmp_path: Path) -> None:
    scene = load(name)
    e = score(scene, saved(exact_frame(scene), tmp_path / "m.csv"), Labels(name="p")).evaluation
    if e.divergence is not None and e.divergence.chaotic:
        assert e.parts_at is None
        return
    errors = e.errors
    assert errors is not None
    assert len(errors.angle_of_turn) == len(e.true_bounces)
    several = (errors.angle_of_turn, errors.rotation_turn, errors.time_of_bounce, errors.phi_min)
    ratios = [
        own.peak_friction_ratio - true.peak_friction_ratio
        for own, true in zip(e.bounces, e.true_bounces, strict=False)
        if math.isfinite(true.peak_friction_ratio)  # of cusps it is not
    ]
    # of a plane that has to pull, the record has no contact points
    locus = errors.contact_locus_rms if e.truth_pulls else errors.contact_locus_hausdorff
    single = (errors.phi_max, errors.rotation_rms, locus)
    assert max(abs(error) for error in (*single, *sum(several, ()))) < 1e-11
    # a peak is taken from a parabola through three samples
    assert max(map(abs, ratios), default=0.0) < 1e-9


def test_parquet_is_read_as_text_is(gentle: Scene, tmp_path: Path) -> None:
    frame, path = exact_frame(gentle), tmp_path / "motion.parquet"
    frame.to_parquet(path)
    scored = score(gentle, path, Labels(name="p"))
    assert scored.evaluation.errors is not None
    assert scored.evaluation.errors.phi_rms == 0.0


def test_several_records_make_one_report(rockingcan: Command, motion: Path, tmp_path: Path) -> None:
    out, name = tmp_path / "report", "<script>alert(1)</script>"
    options = ("--name", name, "--name", "b", "--version", "9", "--timestep", "1e-3")
    answer = rockingcan(
        *("score", "gentle-rock", str(motion), str(motion), *options),
        *("--settings", "solver=PGS", "--out", str(out), "--json"),
    )
    assert answer.code == 0, answer.err
    assert [one["engine"] for one in answer.json()["records"]] == [name, "b"]
    page = (out / "index.html").read_text(encoding="utf-8")
    assert name not in page
    assert "--settings solver=PGS" in page
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    assert {case["engine_version"] for case in manifest["cases"]} == {"9"}


def test_what_a_record_does_not_tell_is_null(
    rockingcan: Command, motion: Path, tmp_path: Path
) -> None:
    out = tmp_path / "report"
    answer = rockingcan("score", "gentle-rock", str(motion), "--out", str(out), "--json").json()
    untold = ("steps", "wall_s", "compile_s", "setup_s")
    assert {answer[key] for key in untold} == {None}
    assert answer["contact"]["multi_contact_fraction"] is None
    (row,) = csv.DictReader((out / "tables/results.csv").read_text(encoding="utf-8").splitlines())
    empty = (*untold, "cpu_s", "constraint_rows", "multi_contact_fraction", "static_penetration_m")
    assert {row[key] for key in empty} == {""}
    (row,) = csv.DictReader((out / "tables/scorecard.csv").read_text(encoding="utf-8").splitlines())
    assert row["best_run"] == "recorded"
    assert "timestep" not in (out / "summary.md").read_text(encoding="utf-8")


def test_the_command_that_is_shown_repeats_the_score(rockingcan: Command, tmp_path: Path) -> None:
    scene, path = load("gentle-rock"), tmp_path / "my motion.csv"
    theirs = frame_of(scene, replace(EVERY[0], up="y")).rename(columns={"time_s": "my time"})
    saved(theirs, path)
    first = rockingcan(
        *("score", "gentle-rock", str(path), "--name", "a b", "--version", "9 beta"),
        *("--timestep", "1e-3", "--column", "time_s=my time", "--convention", "up=y"),
        *("--settings", "note=two words", "--out", str(tmp_path / "report"), "--json"),
    )
    assert first.code == 0, first.err
    manifest = json.loads((tmp_path / "report/manifest.json").read_text(encoding="utf-8"))
    program, *words = shlex.split(manifest["cases"][0]["command"])
    again = rockingcan(*words, "--out", str(tmp_path / "again"), "--json")
    assert program == "rockingcan"
    assert again.json() == first.json()
    repeated = json.loads((tmp_path / "again/manifest.json").read_text(encoding="utf-8"))
    assert repeated["cases"] == manifest["cases"]
    assert "--" not in manifest["cases"][0]["label"]


def test_files_of_one_name_and_timestep_are_refused(rockingcan: Command, motion: Path) -> None:
    twice = ("score", "gentle-rock", str(motion), str(motion))
    answer = rockingcan(*twice)
    assert answer.code == 2
    assert "--name" in answer.err
    assert "--timestep" in answer.err
    assert "did you mean" not in answer.err
    assert rockingcan(*twice, "--timestep", "1e-3").code == 2
    assert rockingcan(*twice, "--timestep", "1e-3", "--timestep", "1e-4").code == 0


def test_labels_are_one_or_one_for_each(rockingcan: Command, motion: Path) -> None:
    answer = rockingcan("score", "gentle-rock", *[str(motion)] * 3, "--name", "a", "--name", "b")
    assert answer.code == 2
    assert "--name" in answer.err
    assert "one for each of the 3 files" in answer.err


def test_a_record_that_stops_too_soon_says_so(gentle: Scene, tmp_path: Path) -> None:
    path = saved(exact_frame(gentle).iloc[:-20], tmp_path / "short.csv")
    scored = score(gentle, path, Labels(name="p"))
    assert scored.evaluation.simulation.outcome is Outcome.ENDED_EARLY
    assert any("with 0 of 1 bounces complete" in sentence for sentence in scored.unknown)


def test_a_coarse_record_counts_no_turns(tmp_path: Path) -> None:
    release = load("paper-release")
    frame = exact_frame(replace(release, horizon=Horizon(bounces=2)))
    coarse = frame.iloc[np.unique(np.searchsorted(frame["time_s"], np.linspace(0, 0.07, 100)))]
    lean = coarse[["time_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]]
    scored = score(release, saved(lean, tmp_path / "coarse.csv"), Labels(name="p"))
    assert any("turns: the record is too coarse" in sentence for sentence in scored.unknown)
    assert any("no forces" in sentence for sentence in scored.unknown)


def test_another_can_is_a_mismatch(gentle: Scene, tmp_path: Path) -> None:
    frame = exact_frame(gentle)
    found = score(gentle, saved(frame, tmp_path / "m.csv"), Labels(name="p"))
    trajectory = found.evaluation.simulation.trajectory
    assert trajectory is not None
    rows = {row.quantity: row.verdict for row in evidence(trajectory, gentle)}
    assert rows == dict.fromkeys(rows, "equal") | {"mass m": NOT_CHECKED}
    heavier = replace(gentle, gravity=1.1 * gentle.gravity)
    rows = {row.quantity: row.verdict for row in evidence(trajectory, heavier)}
    assert rows["gravity g"] == "mismatch"
    assert rows["radius R"] == "equal"


def test_gravity_is_told_by_free_flight(gentle: Scene) -> None:
    time, still = np.linspace(0.0, 0.05, 40), np.zeros((40, 3))
    up = np.array((0.0, 0.0, 1.0))
    flight = Trajectory(
        time=time,
        position=np.outer(0.2 - 4.905 * time**2, up),
        quaternion=np.tile((1.0, 0.0, 0.0, 0.0), (40, 1)),
        velocity=np.outer(-9.81 * time, up),
        angular_velocity=still,
        contact_point=np.full((40, 3), np.nan),
        contact_force=still,
        penetration=np.full(40, -0.1),
        contact_count=np.zeros(40, dtype=np.int64),
    )
    (row,) = [row for row in evidence(flight, gentle) if row.quantity == "gravity g"]
    assert row.verdict == "equal"
    assert row.found == pytest.approx(9.81, rel=1e-9)
    assert "free flight" in row.how
