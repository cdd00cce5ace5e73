"""Commands that do what they are told, and say it in exactly the promised keys."""

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from harness.core.case import Case
from harness.engines.registry import names as engine_names
from models import load, names, read_scene
from models.effects import modelling_choices
from models.to_mjcf import mjcf
from models.to_urdf import urdf
from tests.support.command_line import Command

BOUNCE = {
    "time_s",
    "phi_min_rad",
    "angle_of_turn_deg",
    "rotation_turn_deg",
    "peak_psi_dot_rad_s",
    "peak_friction_ratio",
}
MOTION = {
    "scene",
    "engine",
    "outcome",
    "wall_s",
    "steps",
    "period_s",
    "energy_drift",
    "bounces",
    "modelling_choices",
}
RUN = {"compile_s", "setup_s", "errors", "contact", "divergence", "parts_at_s"}
ERRORS = {"phi_rms_rad", "angle_of_turn_deg", "contact_locus_rms_m", "peak_friction_ratio"}
CONTACT = {"max_penetration_m", "max_slip_m_s", "lift_off_fraction", "multi_contact_fraction"}


def test_scenes_are_listed(rockingcan: Command) -> None:
    answer = rockingcan("scenes", "--json")
    assert answer.code == 0
    assert [scene["name"] for scene in answer.json()["scenes"]] == list(names())
    listed = rockingcan("scenes")
    assert listed.code == 0
    assert all(name in listed.out for name in names())


def test_engines_are_listed(rockingcan: Command) -> None:
    assert rockingcan("engines", "--json").json()
    listed = rockingcan("engines")
    assert listed.code == 0
    assert all(name in listed.out for name in engine_names())
    assert "impratio" in rockingcan("engines", "mujoco").out


MODEL = {
    "model",
    "equations",
    "why",
    "method",
    "agreement",
    "phases",
    "impacts",
    "rest",
    "guard",
    "findings",
    "divergence",
}


@pytest.mark.parametrize(
    ("scene", "model", "equations"),
    [
        ("planar-fall", "pendulum", 2),
        ("frictionless", "frictionless", 2),
        ("gentle-rock", "rolling", 4),
        ("slipping-rock", "coulomb", 6),
        pytest.param("tilted-plane", "general", 6, marks=pytest.mark.slow),
        pytest.param("shaken-plane", "general", 7, marks=pytest.mark.slow),
    ],
)
def test_the_smallest_model_is_taken_and_said(
    rockingcan: Command, scene: str, model: str, equations: int
) -> None:
    found = rockingcan("reference", scene, "--json").json()
    assert (found["model"], found["equations"]) == (model, equations)
    assert found["why"].endswith(".")
    assert f"Model: {model}, {equations} equations." in rockingcan("reference", scene).out


def test_a_larger_model_is_taken_where_it_is_asked_for(rockingcan: Command) -> None:
    found = rockingcan("reference", "gentle-rock", "--model", "general", "--json").json()
    assert found["model"] == "general"
    assert "rolling" in found["why"]


def test_phases_and_findings_are_said(rockingcan: Command) -> None:
    found = rockingcan("reference", "slipping-rock", "--json").json()
    assert [phase["kind"] for phase in found["phases"]] == ["stick", "slip"]
    (finding,) = rockingcan("reference", "wobble", "--json").json()["findings"]
    assert finding["model"] == "coulomb"
    assert "Finding: Rolling needs a friction of 1.021" in rockingcan("reference", "wobble").out


@pytest.mark.slow
def test_the_choice_behind_each_declared_effect_is_said(rockingcan: Command) -> None:
    found = rockingcan("reference", "chaotic-can", "--json").json()
    assert found["modelling_choices"] == list(modelling_choices(load("chaotic-can").effects))
    assert len(found["modelling_choices"]) == 2
    # the terminal breaks lines
    shown = " ".join(rockingcan("reference", "chaotic-can").out.split())
    run = rockingcan("run", "slipping-rock", "--engine", "reference").out
    assert all(f"Modelling choice: {choice}" in shown for choice in found["modelling_choices"])
    assert "Modelling choice: Friction has one coefficient, static equal to kinetic" in run
    assert rockingcan("reference", "gentle-rock", "--json").json()["modelling_choices"] == []


def test_an_old_name_of_a_method_is_a_line_on_standard_error(rockingcan: Command) -> None:
    old = rockingcan("reference", "paper-release", "--method", "regular", "--json")
    new = rockingcan("reference", "paper-release", "--method", "half-period", "--json")
    assert old.err == (
        "rockingcan: warning: method 'regular' is called 'half-period' now; "
        "the old name goes with the next release\n"
    )
    assert new.err == ""
    times = {"wall_s", "cpu_s", "setup_s"}
    without = [
        {k: v for k, v in rockingcan.json().items() if k not in times} for rockingcan in (old, new)
    ]
    assert without[0] == without[1]
    assert (old.code, new.code) == (0, 0)


@pytest.mark.slow
def test_processes_of_a_sweep_do_not_repeat_that_a_name_is_old(
    rockingcan_process: Command, tmp_path: Path
) -> None:
    words = ("--over", "release.psi_dot=1:2:3", "--quantity", "steps", "--set", "method=regular")
    done = rockingcan_process(
        "sweep", "gentle-rock", *words, "--out", str(tmp_path / "out"), "--json"
    )
    assert done.code == 0
    assert done.err.count("is called 'half-period' now") == 1
    assert "RenamedValueWarning" not in done.err


def test_the_reference_answers_in_the_promised_keys(rockingcan_process: Command) -> None:
    answer = rockingcan_process("reference", "paper-release", "--json")
    assert (answer.code, answer.err) == (0, "")
    found = answer.json()
    assert set(found) == MOTION | MODEL
    assert (found["model"], found["equations"], found["findings"]) == ("rolling", 4, [])
    (bounce,) = found["bounces"]
    assert set(bounce) == BOUNCE
    # the turn by quadrature to 15 digits, and the friction that the paper prints
    assert bounce["angle_of_turn_deg"] == pytest.approx(209.363400462452, abs=1e-8)
    assert bounce["peak_friction_ratio"] == pytest.approx(0.508, abs=5e-4)
    # in units of sqrt(R/g), with the paper's R = 0.037 m and g = 9.81 m/s^2
    period = 1.00948780968203677 * math.sqrt(0.037 / 9.81)
    assert found["period_s"] == pytest.approx(period, rel=1e-9)
    assert found["outcome"].startswith("finished")


@pytest.mark.parametrize(
    "name",
    ["mujoco", *(pytest.param(name, marks=pytest.mark.slow) for name in ("pybullet", "reference"))],
)
def test_a_run_answers_in_the_promised_keys_and_with_nothing_else(
    rockingcan_process: Command, name: str
) -> None:
    words = () if name == "reference" else ("--timestep", "1e-3")
    answer = rockingcan_process("run", "gentle-rock", "--engine", name, *words, "--json")
    assert (answer.code, answer.err) == (0, "")
    found = answer.json()
    assert set(found) == MOTION | RUN
    assert set(found["errors"]) == ERRORS
    assert set(found["contact"]) == CONTACT
    assert [set(bounce) for bounce in found["bounces"]] == [BOUNCE]
    assert len(found["errors"]["angle_of_turn_deg"]) == 1
    assert len(found["errors"]["peak_friction_ratio"]) == 1
    assert found["scene"] == "gentle-rock"


@pytest.mark.slow
def test_a_chaotic_run_says_when_it_parts_and_how_fast_disturbances_grow(
    rockingcan: Command,
) -> None:
    words = ("run", "chaotic-can", "--engine", "mujoco", "--timestep", "1e-3")
    found, shown = rockingcan(*words, "--json").json(), rockingcan(*words).out
    divergence, parts_at = found["divergence"], found["parts_at_s"]
    assert divergence["chaotic"]
    assert divergence["growth"] > 1e4
    assert 0.1 < parts_at < divergence["parted_s"]
    assert f"grows by e in {divergence['lyapunov_time_s']:.3g} s" in shown
    assert f"0.1 rad away from the exact motion from {parts_at:.3g} s on" in shown
    assert "no errors are given" in shown
    assert "Errors" not in shown  # no row of dashes


def test_a_run_that_is_not_chaotic_says_nothing_of_chaos(rockingcan: Command) -> None:
    words = ("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-4")
    found, shown = rockingcan(*words, "--json").json(), rockingcan(*words).out
    assert (found["divergence"], found["parts_at_s"]) == (None, None)
    assert "Errors" in shown
    assert "haotic" not in shown
    assert "away from the exact motion" not in shown


def test_what_is_unknown_is_null_and_not_nan(
    rockingcan: Command, scene_file: Callable[..., Path]
) -> None:
    # no rigid rim is in the plane: there is no truth of such a release
    path = scene_file(("[release]", "[release]\nheight = -1e-5"))
    answer = rockingcan("run", str(path), "--engine", "mujoco", "--timestep", "1e-3", "--json")
    assert answer.code == 0
    assert answer.json()["errors"]["phi_rms_rad"] is None


def test_a_run_for_people_shows_parity_and_bounces(rockingcan: Command) -> None:
    answer = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3")
    assert answer.code == 0
    assert "radius R" in answer.out
    assert "angle_of_turn" in answer.out


@pytest.mark.engine("pybullet")
def test_a_mismatch_is_an_answer_and_a_failure(rockingcan: Command) -> None:
    words = ("run", "gentle-rock", "--engine", "pybullet", "--timestep", "1e-3")
    answer = rockingcan(*words, "--set", "collisionMargin=0.001", "--json")
    assert answer.code != 0
    assert answer.json()["outcome"].startswith("mismatch")
    assert "rim deviation" in answer.err
    assert "Traceback" not in answer.err


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_motion_is_written_with_units_in_its_columns(
    rockingcan: Command, tmp_path: Path, suffix: str
) -> None:
    out = tmp_path / f"motion{suffix}"
    words = ("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3", "--json")
    assert rockingcan(*words, "--out", str(out)).code == 0
    assert [path.name for path in tmp_path.iterdir()] == [out.name]
    frame = pd.read_csv(out) if suffix == ".csv" else pd.read_parquet(out)
    assert {"t_s", "phi_rad"} <= set(frame.columns)
    assert len(frame) > 300
    assert frame.phi_rad.iloc[0] == pytest.approx(0.4, rel=1e-12, abs=0)


def test_settings_can_be_spelt_as_the_command_of_a_case_spells_them(rockingcan: Command) -> None:
    words = ("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3", "--json")
    plain = rockingcan(*words).json()
    same = rockingcan(
        *words, "--set", "solref=0.002,1.0", "--set", "impratio=100.0", "--set", "cone=elliptic"
    ).json()
    other = rockingcan(*words, "--set", "solref=0.02,1.0").json()
    assert same["errors"] == plain["errors"]
    assert other["errors"] != plain["errors"]


@pytest.mark.engine("pybullet")
def test_the_command_of_a_case_runs_that_case(
    rockingcan: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = (("solref", (0.1 + 0.2, 1.0)), ("cone", "elliptic"), ("iterations", 7))
    boxed = (("URDF_USE_IMPLICIT_CYLINDER", True), ("contactERP", None), ("collisionMargin", 0.0))
    scene = load("gentle-rock")
    for case in (
        Case(scene=scene, engine="mujoco", timestep=1.0 / 240.0, options=options),
        Case(scene=scene, engine="pybullet", profile="default", options=boxed),
        Case(scene=scene, engine="reference"),
    ):
        ran: list[Case] = []

        def stop(asked: Case, ran: list[Case] = ran) -> None:
            ran.append(asked)
            raise KeyboardInterrupt

        monkeypatch.setattr("harness.cli.motions.evaluate", stop)
        rockingcan(*case.command().split()[1:])
        assert ran == [case]
        assert ran[0].digest("1") == case.digest("1")


@pytest.mark.parametrize(("kind", "write"), [("mjcf", mjcf), ("urdf", urdf)])
def test_an_export_is_the_model_itself(
    rockingcan: Command, tmp_path: Path, kind: str, write: Callable[..., str]
) -> None:
    scene = load("petals")
    said = rockingcan("export", "petals", "--format", kind)
    assert (said.code, said.err) == (0, "")
    assert said.out.rstrip("\n") == write(scene).rstrip("\n")
    out = tmp_path / "model.xml"
    assert rockingcan("export", "petals", "--format", kind, "--out", str(out)).code == 0
    assert out.read_text(encoding="utf-8").rstrip("\n") == write(scene).rstrip("\n")
    assert [path.name for path in tmp_path.iterdir()] == ["model.xml"]


def test_a_scene_may_be_a_file(rockingcan: Command, scene_file: Callable[..., Path]) -> None:
    path = scene_file(("name", 'name = "mine"'))
    assert read_scene(path).name == "mine"
    assert rockingcan("reference", str(path), "--json").json()["scene"] == "mine"


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_interrupted_it_leaves_nothing_behind(tmp_path: Path, jobs: str) -> None:
    source = str(Path(__file__).parents[3])
    program = f"import sys; sys.path.insert(0, {source!r}); from harness.cli import main; main()"
    out = tmp_path / "report"
    kept = tmp_path / "kept"
    words = ("validate", "--out", str(out), "--jobs", jobs, "--store", str(kept))
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # as in a terminal, the interrupt reaches the whole group
    )
    while not (kept / "journal.jsonl").exists():  # past the imports, the suite has begun
        assert process.poll() is None
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)
    said, complained = process.communicate(timeout=60)
    assert process.returncode == 130  # 128 and the number of the signal, as shells have it
    assert said == ""
    assert "interrupted; nothing half-written is left behind" in complained
    assert "Traceback" not in complained
    assert not out.exists()
    assert list(tmp_path.iterdir()) == [kept]
