"""The spread: members that nobody could tell apart, and the largest departure among them."""

import pytest

from harness.core.case import Case
from harness.gate.spread import FEWEST, MOST, SIZES, member, members, planned_members, spread
from models import load
from tests.support.gate_scores import make_score

PHI = "phi_rms_rad"


def test_members_differ_by_no_more_than_their_size() -> None:
    case = Case(scene=load("paper-release"), engine="mujoco", timestep=1e-5)
    before, seen = case.scene.release, set()
    for number in range(MOST):
        one, size = member(case, number), SIZES[number % len(SIZES)]
        after = one.scene.release
        for name in ("phi", "psi_dot", "theta_dot"):
            then, now = getattr(before, name), getattr(after, name)
            # half an ulp each for the product and for the sum
            assert abs(now - then) <= (size + 2.3e-16) * abs(then)
        assert abs(after.psi - before.psi) <= size
        assert (one.engine, one.profile, one.timestep) == ("mujoco", "matched", 1e-5)
        seen.add((after.phi, after.psi, after.psi_dot, after.theta_dot))
    assert len(seen) == MOST


def test_engines_share_the_release_of_a_member() -> None:
    scenes = {
        member(Case(scene=load("petals"), engine=engine, timestep=step), 3).scene
        for engine in ("mujoco", "pybullet")
        for step in (1e-4, 1e-3)
    }
    assert len(scenes) == 1


@pytest.mark.parametrize(
    ("steps", "count"), [(0, MOST), (100, MOST), (25_000, 8), (1_000_000, FEWEST)]
)
def test_long_runs_have_few_members(steps: int, count: int) -> None:
    assert members(steps) == count


def test_a_spread_is_the_largest_departure() -> None:
    found = spread(
        make_score({PHI: 1.0, "steps": 10.0}),
        [make_score({PHI: 1.5, "steps": 10.0}), make_score({PHI: 0.25, "steps": 12.0})],
    )
    assert found.spread == {PHI: 0.75, "steps": 2.0}
    assert found.members == 2
    assert found.endings == {"FINISHED": 3}


def test_what_only_some_members_show_is_not_decidable() -> None:
    found = spread(make_score({PHI: 1.0}), [make_score({PHI: 1.5}), make_score({})])
    assert found.spread == {PHI: None}
    found = spread(make_score({}), [make_score({PHI: 1.5}), make_score({})])
    assert found.spread == {PHI: None}


def test_members_that_end_otherwise_count_as_endings() -> None:
    found = spread(
        make_score({PHI: 1.0}), [make_score({PHI: 1.5}), make_score({PHI: 9.0}, outcome="FLAT")]
    )
    assert found.endings == {"FINISHED": 2, "FLAT": 1}
    assert found.spread == {PHI: 0.5}
    assert found.may_finish
    assert found.may_fail


def test_each_case_runs_as_often_as_its_steps_allow() -> None:
    cases = [Case(scene=load(name), engine="mujoco") for name in ("gentle-rock", "petals")]
    scores = [make_score({"steps": steps}) for steps in (0.0, 1e6)]
    assert len(list(planned_members(cases, scores))) == members(0) + members(1_000_000)
    assert members(0) > members(1_000_000)


def test_a_quantity_that_no_member_has_a_spread_of_none_or_nothing() -> None:
    alone = spread(make_score({"phi_rms_rad": 1.0}), [])
    assert alone.spread == {"phi_rms_rad": 0.0}
