"""A motion with friction is followed once in a process, but anew where it is timed."""

import importlib
from collections import OrderedDict
from dataclasses import replace

import pytest

from harness.core.case import Case, Value
from harness.engines.reference.assumption_checks import divergence_of
from harness.engines.reference.truth import solve_case, truth
from models import Effects, Scene, Slip, load
from models.scene import Horizon


def test_an_answer_is_the_truth_and_a_timed_one_is_its_own() -> None:
    scene = replace(load("slipping-rock"), horizon=Horizon(seconds=0.011))
    case = Case(scene=scene, engine="reference")
    answer = solve_case(case)
    assert truth(scene).solution is answer.solution
    assert solve_case(case, again=False).solution is answer.solution
    timed = solve_case(case)
    assert timed.solution is not answer.solution
    assert timed.solution.t_end == answer.solution.t_end
    assert timed.ends == pytest.approx(0.011, rel=1e-12, abs=0)


def test_a_tolerance_of_its_own_is_no_truth() -> None:
    scene = load("gentle-rock")

    def reduced(**options: float) -> float:
        told: tuple[tuple[str, Value], ...] = (("model", "reduced"), *options.items())
        case = Case(scene=scene, engine="reference", options=told)
        return float(solve_case(case, again=False).bounces[0].angle_of_turn)

    assert reduced(rtol=1e-2) != reduced() == reduced()


def test_the_last_motions_stay_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("harness.engines.reference.truth")  # a function has its name
    monkeypatch.setattr(module, "MOST", 2)
    monkeypatch.setattr(module, "SOLVED", OrderedDict())
    monkeypatch.setattr(module, "solve", lambda *_, **__: object())

    def solution(scene: Scene, model: str = "auto") -> object:
        case = Case(scene=scene, engine="reference", options=(("model", model),))
        return solve_case(case, again=False).solution

    slipping = [
        replace(load("slipping-rock"), effects=Effects(slip=Slip(mu=mu))) for mu in (0.1, 0.2, 0.3)
    ]
    first = [solution(scene) for scene in slipping]
    assert len(module.SOLVED) == 2
    assert [solution(scene) for scene in slipping[1:]] == first[1:]
    # what "auto" means is what was solved, and no other model, nor another scene
    assert solution(slipping[2], "coulomb") is first[2]
    assert solution(slipping[2], "general") is not first[2]
    assert solution(replace(slipping[2], name="another")) is not first[2]
    assert solution(slipping[0]) is not first[0]
    # where the rim rolls "auto" is the formula, which is not the integration
    rolling = load("gentle-rock")
    assert solution(rolling) is not solution(rolling, "rolling")


def test_of_a_motion_that_ends_where_it_begins_no_copies_are_followed() -> None:
    scene = replace(load("off-centre-mass"), horizon=Horizon(seconds=1e-150))
    assert truth(scene).ends == 0.0
    assert divergence_of(scene) is None
