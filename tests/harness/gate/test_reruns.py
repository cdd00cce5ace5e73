"""Cases of a result that are run again: which they are, and that a forged number is named."""

import pytest

from harness import api
from harness.evaluation.run_cases import run_cases
from harness.execution.isolated_pool import SerialExecutor
from harness.gate import reruns
from harness.gate.reruns import not_run_again, rerun_objections, sample
from harness.results.plausibility import Rule
from harness.results.result import EngineRelease, Result, input_digests, make_result
from harness.results.scores import scored

SERIAL = SerialExecutor()


@pytest.fixture(scope="module")
def result() -> Result:
    """Return a result of three short cases."""
    cases = [case for case in api.suite("quick", ["mujoco"]) if case.scene.name == "gentle-rock"]
    short = [case for case in cases if case.profile == "default" or (case.timestep or 0.0) >= 1e-4]
    evaluations = run_cases(short)
    return make_result(
        "quick",
        scored(short, evaluations),
        versions={"mujoco": evaluations[0].simulation.engine_version},
        inputs=input_digests(case.scene for case in short),
    )


def test_the_sample_is_drawn_with_the_seed(result: Result) -> None:
    every = [score.digest for score, _ in sample(result, {})]
    assert len(every) == len(result.cases) == 3
    drawn = [tuple(score.digest for score, _ in sample(result, {}, 1, seed=n)) for n in range(30)]
    assert {name for (name,) in drawn} == set(every)  # no case is out of reach
    assert sample(result, {}, 2, seed=7) == sample(result, {}, 2, seed=7)
    assert sample(result, {}, 9) == sample(result, {})
    assert sample(result, {}, 0) == ()
    cases = {score.digest: case for score, case in sample(result, {})}
    assert all(case.digest(result.versions["mujoco"]) == name for name, case in cases.items())


def test_an_honest_result_repeats(result: Result) -> None:
    labels: list[str] = []
    chosen = sample(result, {})
    assert list(rerun_objections(result, chosen, SERIAL, labels.append)) == []
    assert len(labels) == 3


def test_a_forged_number_and_a_forged_ending_are_named(result: Result) -> None:
    first, *others = result.cases
    values = {**first.values, "phi_rms_rad": first.values["phi_rms_rad"] / 2.0}
    forged = first.model_copy(update={"values": values})
    claims = result.of_cases((forged, *others))
    (found,) = rerun_objections(claims, sample(claims, {}), SERIAL)
    assert (found.rule, found.case) == (Rule.RERUN, forged.identity.label())
    assert found.text.startswith("a is better, error of the nutation phi")

    fallen = first.model_copy(update={"outcome": "FLAT"})
    claims = result.of_cases((fallen, *others))
    (found,) = rerun_objections(claims, sample(claims, {}), SERIAL)
    assert found.text == "b is better, flat, then finished"


@pytest.mark.parametrize("width", [1e9, None])
def test_no_spread_of_the_file_excuses_a_forged_number(result: Result, width: float | None) -> None:
    first = result.cases[0]
    values = {**first.values, "phi_rms_rad": first.values["phi_rms_rad"] / 1000.0}
    excuse = {"members": 4, "endings": {"FINISHED": 3, "FLAT": 2}}
    told = {**excuse, "values": values, "spread": dict.fromkeys(values, width)}
    claims = result.of_cases([first.model_copy(update=told)])
    (found,) = rerun_objections(claims, sample(claims, {}), SERIAL)
    assert found.text.startswith("a is better, error of the nutation phi")

    claims = result.of_cases([first.model_copy(update={**excuse, "outcome": "FLAT"})])
    (found,) = rerun_objections(claims, sample(claims, {}), SERIAL)
    assert found.text == "b is better, flat, then finished"


def test_what_perturbed_runs_here_move_is_no_forgery(
    result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = result.cases[0]
    phi = first.values["phi_rms_rad"]
    claims = result.of_cases(
        [first.model_copy(update={"values": {**first.values, "phi_rms_rad": 3.0 * phi}})]
    )
    spread = [first.model_copy(update={"members": 4, "spread": {"phi_rms_rad": phi}})]
    monkeypatch.setattr(reruns, "measured", lambda *_: spread)
    assert list(rerun_objections(claims, sample(claims, {}), SERIAL)) == []


def test_two_ways_to_end_early_are_a_difference(
    result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = result.cases[0]
    claims = result.of_cases([first.model_copy(update={"outcome": "FLAT"})])
    fallen = first.model_copy(update={"outcome": "OVERTURNED"})
    monkeypatch.setattr(reruns, "scored", lambda *_: [fallen])
    (found,) = rerun_objections(claims, sample(claims, {}), SERIAL)
    assert found.text == "not judged, flat, then overturned"


@pytest.mark.parametrize(
    ("name", "version", "reason"),
    [
        ("theirs", "1", "no engine of that name is registered here"),
        ("mujoco", "0.1", "its version is 0.1, and "),
    ],
)
def test_what_is_not_here_is_not_run_again(
    result: Result, name: str, version: str, reason: str
) -> None:
    engines = {name: EngineRelease(label=name, version=version)}
    cases = [score.model_copy(update={"engine": name}) for score in result.cases]
    other = result.of_cases(cases).model_copy(update={"engines": engines})
    assert not_run_again(other, {})[name].startswith(reason)
    assert sample(other, {}) == ()


def test_an_engine_that_is_not_installed_is_not_run_again(
    result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reruns, "installed", lambda: ())
    assert not_run_again(result, {}) == {"mujoco": "it is not installed here"}


def test_settings_that_are_not_known_here_are_not_run_again(result: Result) -> None:
    opened = result.model_copy(update={"settings": {"mujoco.impratio": "3"}})
    assert not_run_again(opened, {}) == {"mujoco": "it does not have these settings here"}
    assert not_run_again(opened, {"mujoco": {"impratio": 3}}) == {}
    ((_, case), *_) = sample(opened, {"mujoco": {"impratio": 3}})
    assert case.options == (("impratio", 3),)
