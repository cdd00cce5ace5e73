"""Which accepted cases a run owes, and which accepted results do not fit it."""

from dataclasses import replace

import pytest

from harness import api
from harness.core.case import Case
from harness.engines.description import Description
from harness.gate import baseline
from harness.gate.baseline import required_cases
from harness.gate.errors import ChangedScenesError, OtherEnginesError, OtherSuiteError
from harness.results.result import Result, input_digests
from harness.results.scores import identity, scene_digest
from models import load
from tests.support.gate_scores import make_scores, scores_of


def accepted(suite: str, cases: tuple[Case, ...]) -> Result:
    """Return scores of cases, as if they had been accepted."""
    return make_scores(
        *scores_of(cases),
        suite=suite,
        inputs=input_digests(case.scene for case in cases),
        place="reports/baseline",
    )


def test_the_quick_suite_is_part_of_the_full_one() -> None:
    quick, full = api.suite("quick"), api.suite("full")
    assert set(quick) < set(full)
    assert set(full).isdisjoint(api.suite("field"))
    found = required_cases(accepted("full", full), "quick", quick, every_engine=True)
    assert found == tuple(identity(case) for case in quick)


def test_the_same_suite_owes_all_of_it() -> None:
    quick = api.suite("quick")
    known = accepted("quick", quick)
    assert required_cases(known, "quick", quick[:-1], every_engine=True) == tuple(known.scores)
    own = api.suite("quick", ["mujoco"])
    found = required_cases(known, "quick", own, every_engine=False)
    assert found == tuple(identity(case) for case in own)


def test_an_engine_that_takes_part_where_it_is_named_is_owed_there_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, named = load("gentle-rock"), "quiet"
    monkeypatch.setattr(
        baseline, "description_of", lambda name: Description(by_default=name != named)
    )
    both = [Case(scene=scene, engine=engine, timestep=1e-4) for engine in ("mujoco", named)]
    known = accepted("quick", tuple(both))
    for designed in (both[:1], both):
        found = required_cases(known, "quick", designed, every_engine=True)
        assert found == tuple(identity(case) for case in designed)


def test_a_smaller_suite_does_not_stand_for_a_larger_one() -> None:
    known = accepted("quick", api.suite("quick"))
    with pytest.raises(OtherSuiteError) as caught:
        required_cases(known, "full", api.suite("full"), every_engine=True)
    assert (caught.value.suite, caught.value.accepted) == ("full", "quick")


def test_results_of_another_engine_are_not_those_of_this_one() -> None:
    known = accepted("quick", api.suite("quick", ["pybullet"]))
    with pytest.raises(OtherEnginesError) as caught:
        required_cases(known, "quick", api.suite("quick", ["mujoco"]), every_engine=False)
    assert (caught.value.engines, caught.value.accepted) == (("mujoco",), ("pybullet",))


def test_results_of_a_scene_that_has_changed_are_refused() -> None:
    scene = load("gentle-rock")
    steeper = replace(scene, release=replace(scene.release, phi=0.41))
    known = accepted("quick", (Case(scene=steeper, engine="mujoco", timestep=1e-4),))
    with pytest.raises(ChangedScenesError) as caught:
        required_cases(known, "quick", api.suite("quick", ["mujoco"]), every_engine=False)
    assert caught.value.scenes == ("gentle-rock",)


def test_neither_name_nor_citation_makes_another_motion() -> None:
    scene = load("gentle-rock")
    assert scene_digest(scene) == scene_digest(replace(scene, name="other", cite="elsewhere"))
    assert scene_digest(scene) != scene_digest(replace(scene, gravity=9.8))


def test_a_case_is_the_same_whatever_was_set_on_top() -> None:
    plain = api.suite("quick", ["mujoco"])
    on_top = api.suite("quick", ["mujoco"], {"mujoco": {"impratio": 1.0}})
    assert all(case.options == (("impratio", 1.0),) for case in on_top)
    # the gate names cases as they were designed, so that the two meet
    assert [identity(case) for case in plain] != [identity(case) for case in on_top]
    assert len(plain) == len(on_top)


@pytest.mark.parametrize(
    ("accepted", "said"), [((), "only of none"), (("pybullet", "mine"), "only of pybullet, mine")]
)
def test_whose_results_a_place_has_is_said_also_where_it_has_none(
    accepted: tuple[str, ...], said: str
) -> None:
    error = OtherEnginesError(place="accepted", engines=("mujoco",), accepted=accepted)
    assert f"{said};" in str(error)
