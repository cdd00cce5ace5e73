"""What a result is: its parts agree, each case has one division, and settings decide it."""

import math

import pytest
from pydantic import ValidationError

from harness import api
from harness.cli.settings import parse_settings, settings_to_dict
from harness.core.case import Case, Value
from harness.results.result import Result, input_digests, make_result
from harness.results.scores import Division, division_of, identity, score_of_row
from models import load
from tests.support.gate_scores import make_score, make_scores


@pytest.mark.parametrize(
    ("profile", "settings", "division"),
    [
        ("default", (), Division.AS_SHIPPED),
        ("matched", (), Division.MATCHED),
        ("adaptive", (), Division.MATCHED),
        ("default", ("mujoco.cone",), Division.OPEN),
        ("matched", ("mujoco.cone",), Division.OPEN),
        ("matched", ("pybullet.contactERP",), Division.MATCHED),
        ("default", ("mujoco-3.2.cone",), Division.AS_SHIPPED),
    ],
)
def test_profile_and_settings_give_the_division(
    profile: str, settings: tuple[str, ...], division: Division
) -> None:
    assert division_of("mujoco", profile, settings) is division


def test_the_settings_of_a_version_in_its_own_environment_are_its_own() -> None:
    assert division_of("mujoco-3.2", "default", ["mujoco-3.2.cone"]) is Division.OPEN


def test_a_result_has_each_division_by_itself() -> None:
    shipped = make_score(profile="default", timestep=0.0, division=Division.AS_SHIPPED)
    result = make_scores(shipped, make_score())
    assert result.of_division(Division.AS_SHIPPED).cases == (shipped,)
    assert result.of_division(Division.OPEN).cases == ()


@pytest.mark.parametrize("twice", [make_score(), make_score(outcome="FLAT")])
def test_a_case_that_is_there_twice_is_refused(twice: object) -> None:
    with pytest.raises(ValidationError, match="a case is there twice: gentle-rock in mujoco"):
        make_scores(make_score(), twice)  # type: ignore[arg-type]


@pytest.mark.parametrize(("key", "said"), [("engines", "lacks mujoco"), ("inputs", "lacks gentle")])
def test_an_engine_or_a_scene_that_is_not_declared_is_refused(key: str, said: str) -> None:
    whole = make_scores(make_score()).model_dump()
    with pytest.raises(ValidationError, match=said):
        Result.model_validate(whole | {key: {}})


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("values", {"no_such_m": 1.0}),
        ("values", {"phi_rms_rad": math.inf}),
        ("values", {"phi_rms_rad": "1"}),
        ("spread", {"no_such_m": 1.0}),
        ("endings", {"HAPPY": 1}),
        ("outcome", "HAPPY"),
        ("profile", "best"),
        ("members", -1),
        ("timestep", -1.0),
        ("digest", "xyz"),
        ("another", 1),
        ("options", "two\nlines"),
        ("scene", "\x1b[2J"),
        *(("scene", f"a{chr(mark)}b") for mark in (0x85, 0x9B, 0x2028, 0x2029, 0x202E, 0x2066)),
    ],
)
def test_what_no_score_has_is_refused(key: str, value: object) -> None:
    whole = make_score().model_dump()
    with pytest.raises(ValidationError):
        type(make_score()).model_validate(whole | {key: value})


def test_a_result_of_this_program_says_which_program_and_machine_it_was() -> None:
    case = Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3)
    row = {"digest": case.digest("4.0.0"), "truth_pulls": False, "steps": 5}
    score = score_of_row(row, identity=identity(case), outcome="FLAT")
    inputs = input_digests([case.scene])
    made = make_result("quick", [score], versions={"mujoco": "4.0.0"}, inputs=inputs)
    assert made.engines["mujoco"].label == "MuJoCo"
    assert made.program.fingerprint is not None
    assert made.machine.cores >= 1
    assert "numpy" in made.machine.packages
    assert made.versions["mujoco"] == "4.0.0"


def test_every_case_of_a_suite_has_one_division() -> None:
    divisions = {
        (case.profile, division_of(case.engine, case.profile, ())) for case in api.suite("quick")
    }
    assert divisions == {
        ("default", Division.AS_SHIPPED),
        ("matched", Division.MATCHED),
        ("adaptive", Division.MATCHED),
    }


def test_settings_are_in_the_file_with_every_digit() -> None:
    chosen: dict[str, dict[str, Value]] = {
        "mujoco": {"o_solref": (0.1 + 0.2, 1.0), "cone": "elliptic", "iterations": 3}
    }
    told = settings_to_dict(chosen)
    pairs = [f"{name.removeprefix('mujoco.')}={value}" for name, value in told.items()]
    assert dict(parse_settings(pairs)) == chosen["mujoco"]
