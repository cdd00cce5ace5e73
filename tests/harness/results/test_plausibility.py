"""What a result cannot claim is named; what is honest is not."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness import api
from harness.core.case import Value
from harness.results.errors import FILE, ResultsError
from harness.results.files import read_result, to_text
from harness.results.plausibility import Rule, changed_scenes, designed_cases, objections
from harness.results.result import Result, input_digests, make_result
from harness.results.scores import Division, Score, score_of_row
from tests.support.gate_scores import make_score, make_scores

REPORTS = Path(__file__).parents[3] / "reports"
COMMITTED = [REPORTS / "baseline" / FILE, *sorted((REPORTS / "results").glob("*.json"))]

HONEST = {
    **dict.fromkeys(("phi_rms_rad", "psi_rms_rad", "theta_rms_rad", "rotation_rms_rad"), 1e-4),
    "angle_of_turn_error_deg": 1e-3,
    "contact_locus_rms_m": 1e-6,
    "energy_drift": -1e-6,
    "max_slip_m_s": 1e-6,
    "steps": 1e6,
    "cpu_s": 1.0,
    "wall_s": 1.0,
}


@pytest.fixture(scope="module")
def honest() -> Result:
    """Return a result of the quick suite to which there is nothing to object."""
    cases = api.suite("quick", ["mujoco"])
    scores = [
        score_of_row(
            {**HONEST, "turn_resolved": True, "digest": case.digest("4.0.0"), "truth_pulls": False},
            identity=name,
            outcome="FINISHED",
        )
        for name, case in designed_cases(make_scores(suite="quick")).items()
    ]
    inputs = input_digests(case.scene for case in cases)
    return make_result("quick", scores, versions={"mujoco": "4.0.0"}, inputs=inputs)


def rules(result: Result, **on_top: Mapping[str, Value]) -> list[Rule]:
    return [objection.rule for objection in objections(result, on_top)]


def with_first(honest: Result, **changed: Any) -> Result:
    """Return a result of which the first case at a fixed timestep says something else."""
    place = next(i for i, score in enumerate(honest.cases) if score.timestep > 0.0)
    cases = list(honest.cases)
    if "values" in changed:
        changed["values"] = {**HONEST, **changed["values"]}
    cases[place] = Score.model_validate(cases[place].model_dump() | changed)
    return honest.of_cases(cases)


def test_to_an_honest_result_there_is_nothing_to_object(honest: Result) -> None:
    assert list(objections(honest, {})) == []


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.name)
def test_to_what_is_committed_there_is_nothing_to_object(path: Path) -> None:
    assert list(objections(read_result(path), {})) == []


@pytest.mark.parametrize(
    ("changed", "rule"),
    [
        ({"division": Division.AS_SHIPPED}, Rule.DIVISION),
        ({"digest": "0" * 16}, Rule.DIGEST),
        ({"values": {"rotation_rms_rad": 0.0}}, Rule.ROUND_OFF),
        ({"values": {"rotation_rms_rad": 2e-17}}, Rule.ROUND_OFF),
        ({"values": {"angle_of_turn_error_deg": 0.0}}, Rule.ROUND_OFF),
        ({"values": {"energy_drift": 0.0}}, Rule.ROUND_OFF),
        ({"values": {"contact_locus_rms_m": 1e-19}}, Rule.ROUND_OFF),
        ({"values": {"phi_rms_rad": -1e-4}}, Rule.VALUES),
        ({"values": {"lift_off_fraction": 1.1}}, Rule.VALUES),
        ({"values": {"steps": 0.0}}, Rule.VALUES),
        ({"values": {"steps": 2.5}}, Rule.VALUES),
        ({"values": {"cpu_s": 0.0}}, Rule.VALUES),
        ({"values": {"cpu_s": 9e-5}}, Rule.VALUES),
        ({"endings": {"FINISHED": 1}}, Rule.SPREAD),
        ({"members": 4}, Rule.SPREAD),
        ({"spread": {"phi_rms_rad": 1e-9}}, Rule.SPREAD),
    ],
)
def test_what_cannot_be_is_named(honest: Result, changed: dict[str, Any], rule: Rule) -> None:
    assert rule in rules(with_first(honest, **changed))


def test_a_run_without_a_number_cannot_have_reached_its_horizon(honest: Result) -> None:
    case = honest.cases[0].model_copy(update={"values": {}})
    assert Rule.VALUES in rules(honest.of_cases((case, *honest.cases[1:])))
    flat = case.model_copy(update={"outcome": "FLAT"})
    assert rules(honest.of_cases((flat, *honest.cases[1:]))) == []


@pytest.mark.parametrize(
    "changed",
    [
        {"values": {"rotation_rms_rad": 3e-17}},
        {"values": {"peak_friction_ratio_error": 0.0}},
        {"values": {"max_penetration_m": -1e-9}},
    ],
)
def test_what_can_be_is_not_named(honest: Result, changed: dict[str, Any]) -> None:
    assert rules(with_first(honest, **changed)) == []


def spread_over(honest: Result, width: float | None, engine: str = "mujoco") -> Result:
    endings, spread = {"FINISHED": 5}, {"phi_rms_rad": width}
    own = with_first(honest, members=4, endings=endings, spread=spread)
    score = next(score for score in own.cases if score.members)
    one = score.model_copy(update={"engine": engine})
    engines = {engine: honest.engines["mujoco"]}
    return own.of_cases([one]).model_copy(update={"perturbed_by": (1e-9,), "engines": engines})


def test_errors_that_no_release_moves_are_of_one_run(honest: Result) -> None:
    assert Rule.SPREAD in rules(spread_over(honest, 0.0))
    assert Rule.SPREAD not in rules(spread_over(honest, 1e-20))
    # 1e-9 of a number is less than the last digit that single precision has
    assert Rule.SPREAD not in rules(spread_over(honest, 0.0, "mujoco-warp"))


@pytest.mark.parametrize("width", [1e9, 1.1, None])
def test_a_spread_that_no_members_have_is_named(honest: Result, width: float | None) -> None:
    assert Rule.SPREAD in rules(spread_over(honest, width))


@pytest.mark.parametrize(
    ("column", "width", "named"),
    [
        ("angle_of_turn_error_deg", None, False),  # of a member that shows no bounce
        ("rotation_rms_rad", 0.9, False),
        ("max_slip_m_s", 9.0, False),
        ("max_slip_m_s", 11.0, True),
        ("lift_off_fraction", 1.0, False),
        ("lift_off_fraction", 1.1, True),
        ("steps", 1e11, True),
    ],
)
def test_what_a_spread_can_be_depends_on_its_quantity(
    honest: Result, column: str, width: float | None, *, named: bool
) -> None:
    own = spread_over(honest, 1e-9)
    (score,) = own.cases
    values = {**score.values, "lift_off_fraction": 0.0}
    told = score.model_copy(
        update={"values": values, "spread": {"phi_rms_rad": 1e-9, column: width}}
    )
    assert (Rule.SPREAD in rules(own.of_cases([told]))) is named


def test_an_unknown_spread_is_of_members_that_ended_early(honest: Result) -> None:
    own = spread_over(honest, None)
    (score,) = own.cases
    early = score.model_copy(update={"endings": {"FINISHED": 3, "FLAT": 2}})
    assert Rule.SPREAD not in rules(own.of_cases([early]))


def test_single_precision_rounds_more(honest: Result) -> None:
    exact = with_first(honest, values={"rotation_rms_rad": 1e-9})
    assert Rule.ROUND_OFF not in rules(exact)
    one = next(s for s in exact.cases if s.values["rotation_rms_rad"] == 1e-9)
    warp = one.model_copy(update={"engine": "mujoco-warp"})
    engines = {"mujoco-warp": honest.engines["mujoco"]}
    assert Rule.ROUND_OFF in rules(exact.of_cases([warp]).model_copy(update={"engines": engines}))


def test_a_case_that_is_left_out_and_one_that_is_none_are_named(honest: Result) -> None:
    assert rules(honest.of_cases(honest.cases[1:])) == [Rule.CASES]
    other = honest.cases[0].model_copy(update={"timestep": 0.5})
    assert rules(honest.of_cases((*honest.cases, other))).count(Rule.CASES) == 1


def test_steps_that_do_not_reach_the_horizon_are_named(honest: Result) -> None:
    steady = next(s for s in honest.cases if s.scene == "straight-rolling" and s.timestep == 1e-3)
    others = [score for score in honest.cases if score is not steady]
    for steps, named in ((900.0, True), (999.0, False), (1001.0, False)):
        few = steady.model_copy(update={"values": {**HONEST, "steps": steps}})
        assert (Rule.STEPS in rules(honest.of_cases((few, *others)))) is named


def test_another_scene_is_named_and_its_digests_are_not_judged(honest: Result) -> None:
    inputs = {**honest.inputs, "gentle-rock": "0" * 16}
    other = with_first(honest, digest="0" * 16).model_copy(update={"inputs": inputs})
    assert changed_scenes(other) == ("gentle-rock",)
    assert rules(other) == [Rule.SCENE]


def test_of_a_suite_or_an_engine_that_is_not_known_nothing_more_is_said() -> None:
    assert rules(make_scores(make_score(HONEST), suite="slow")) == [Rule.SUITE]
    theirs = make_score(HONEST, engine="theirs", digest="0" * 16)
    result = make_scores(theirs, suite="quick").model_copy(update={"engines": {}})
    engines = {"theirs": make_scores().engines["mujoco"]}
    inputs = {"gentle-rock": next(iter(input_digests([api.suite("quick")[0].scene]).values()))}
    known = result.model_copy(update={"engines": engines, "inputs": inputs})
    assert rules(known) == []


def test_settings_on_top_are_part_of_the_digest_where_they_are_known(honest: Result) -> None:
    opened = honest.of_cases(
        score.model_copy(update={"division": Division.OPEN}) for score in honest.cases
    ).model_copy(update={"settings": {"mujoco.impratio": "3"}})
    assert rules(opened) == []  # what was set is not known here
    assert set(rules(opened, mujoco={"impratio": 3})) == {Rule.DIGEST}


def leaves(told: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths of all values in what a file holds, inner ones too."""
    inner = told.items() if isinstance(told, dict) else enumerate(told)
    found = [(*path, key) for key, _ in inner]
    nested = told.items() if isinstance(told, dict) else enumerate(told)
    return found + [
        each
        for key, value in nested
        if isinstance(value, dict | list)
        for each in leaves(value, (*path, key))
    ]


def said_of(path: Path) -> list[str]:
    """Return why a file is refused, or what there is to object to in it."""
    try:
        return [objection.text for objection in objections(read_result(path), {})]
    except ResultsError as error:
        return [str(error)]


@given(
    place=st.integers(0, 10**6),
    value=st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=5)
    | st.lists(st.integers(), max_size=2)
    | st.dictionaries(st.text(max_size=3), st.integers(), max_size=2),
)
def test_a_damaged_file_is_refused_in_a_sentence_or_judged(
    honest: Result, tmp_path_factory: pytest.TempPathFactory, place: int, value: object
) -> None:
    told = json.loads(to_text(honest.of_cases(honest.cases[:2])))
    paths = leaves(told)
    *outer, last = paths[place % len(paths)]
    inner = told
    for key in outer:
        inner = inner[key]
    inner[last] = value
    path = tmp_path_factory.getbasetemp() / "damaged.json"
    path.write_text(json.dumps(told), encoding="utf-8")
    assert all("\n" not in text for text in said_of(path))
