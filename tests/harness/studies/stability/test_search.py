"""Searching the largest usable timestep: brackets, ragged boundaries, toys whose limit is known."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.studies.shared.perturbation import SIZE, member
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus, Symptom
from harness.studies.stability.limits import bracket, by_scene, limits, next_round, next_timestep
from harness.studies.stability.suite import SUITES, Suite, ladder, scenes, stability_cases
from models import hard_names, load

RUNGS = (2e-2, 5e-3, 1e-3, 2e-4, 5e-5, 1e-5)
RATIO = 1.05


def searched(usable: Callable[[float], bool], start: float) -> dict[float, bool]:
    known: dict[float, bool] = {}
    while (step := next_timestep(known, RUNGS, RATIO, start)) is not None:
        assert step not in known, "nothing is tried twice"
        known[step] = usable(step)
    return known


@given(limit=st.floats(1.01e-5, 1.99e-2), start=st.sampled_from(RUNGS))
def test_a_sharp_boundary_is_found_from_wherever_the_search_begins(
    limit: float, start: float
) -> None:
    known = searched(lambda step: step <= limit, start)
    usable, unusable = bracket(known)
    assert usable is not None
    assert unusable is not None
    assert usable <= limit < unusable <= RATIO * usable
    # along the ladder, then halving a gap of at most 5 down to 1.05 in its logarithm
    assert len(known) <= len(RUNGS) + math.ceil(math.log2(math.log(5.0) / math.log(RATIO)))


@pytest.mark.parametrize("start", RUNGS)
def test_a_boundary_off_the_ladder_ends_the_search_at_its_end(start: float) -> None:
    assert bracket(searched(lambda _: True, start)) == (RUNGS[0], None)
    assert bracket(searched(lambda _: False, start)) == (None, RUNGS[-1])


def test_luck_above_the_boundary_and_round_off_below_it_do_not_count() -> None:
    known = {2e-2: True, 5e-3: False, 1e-3: True, 2e-4: True, 5e-5: True, 1e-5: False}
    assert bracket(known) == (1e-3, 5e-3)


@given(st.dictionaries(st.sampled_from(RUNGS), st.booleans(), min_size=1))
def test_a_bracket_is_of_what_was_tried_and_in_order(known: dict[float, bool]) -> None:
    usable, unusable = bracket(known)
    assert usable is None or known[usable]
    assert unusable is None or not known[unusable]
    assert usable is None or unusable is None or usable < unusable


# ---- toy engines: an oscillator at 100 rad/s, stepped so that its limit of stability is known

OMEGA = 100.0


def symplectic(x: float, v: float, h: float) -> tuple[float, float]:
    v -= h * OMEGA**2 * x
    return x + h * v, v


def runge_kutta(x: float, v: float, h: float) -> tuple[float, float]:
    """Of fourth order: a step is the Taylor series of the exact motion, to h^4."""
    z = complex(x, v / OMEGA)
    power, total = z, z
    for n in range(1, 5):
        power *= complex(0.0, -OMEGA * h) / n
        total += power
    return total.real, total.imag * OMEGA


TOYS = {"symplectic": (symplectic, 2.0 / OMEGA), "rk4": (runge_kutta, 8**0.5 / OMEGA)}
SUITE = Suite(
    name="toy",
    scenes=("free-axial", "free-transverse"),
    timesteps=(1e-1, 2e-2, 5e-3, 1e-3),
    most_steps=10_000,
    members=3,
    ratio=RATIO,
    random_scenes=0,
)


def judged(case: Case) -> ClassifiedRun:
    """Return the verdict on an oscillator that stands for a run."""
    step, (advance, _) = case.timestep or 1e-3, TOYS[case.engine]
    x, v, most = 1.0, 0.0, 1.0
    for _ in range(4000):
        x, v = advance(x, v, step)
        most = max(most, abs(x))
        if most > 1e6:
            break
    simulation = Simulation(
        case=case,
        outcome=Outcome.FINISHED,
        trajectory=None,
        engine_version="0",
        model="toy",
        timestep=step,
    )
    # at 5 % below its limit a symplectic step swings three times as far as it should
    verdict = StabilityStatus.DIVERGES if most > 100.0 else StabilityStatus.ACCURATE
    return ClassifiedRun(
        simulation=simulation, verdict=verdict, symptom=Symptom(time=0.0, number=most, words="")
    )


def test_the_limits_of_toy_engines_are_found_within_five_percent() -> None:
    engines = list(TOYS)
    found = {case: judged(case) for case in stability_cases(SUITE, engines)}
    rounds = 0
    while cases := next_round(SUITE, engines, by_scene(list(found.values()))):
        assert found.keys().isdisjoint(cases), "nothing is run twice"
        found |= {case: judged(case) for case in cases}
        rounds += 1
    assert rounds < 20
    for limit in limits(SUITE, engines, by_scene(list(found.values()))):
        true = TOYS[limit.engine][1]
        assert len(limit.known) == SUITE.members
        assert limit.spread == pytest.approx(1.0, abs=RATIO - 1.0)
        assert limit.middle is not None
        assert true / RATIO <= limit.middle <= true


# ---- what is run


def test_the_full_suite_has_every_hard_case_and_every_profile() -> None:
    suite = SUITES["full"]
    assert suite.scenes == hard_names()
    cases = stability_cases(suite, ("mujoco", "pybullet"))
    assert len(cases) == len(set(cases))
    assert {(c.scene.name, c.engine, c.profile) for c in cases} == {
        (name, engine, profile)
        for name in hard_names()
        for engine in ("mujoco", "pybullet")
        for profile in ("default", "matched", "adaptive")
    }
    steps = {c.timestep for c in cases}
    assert {2e-2, 1e-8} <= steps


def test_no_run_has_more_steps_than_its_suite_allows() -> None:
    for suite in SUITES.values():
        for scene in scenes(suite):
            rungs = ladder(suite, scene)
            assert list(rungs) == sorted(rungs, reverse=True)
            assert rungs
            assert max((scene.horizon.seconds or 0.0) / step for step in rungs) <= suite.most_steps


@pytest.mark.parametrize("name", hard_names())
def test_members_of_an_ensemble_are_as_hard_as_their_scene(name: str) -> None:
    scene = load(name)
    balance = scene.can.balancing_angle
    assert member(scene, 0) == scene
    others = [member(scene, number) for number in range(1, 5)]
    assert len({other.name for other in others}) == 4
    for other in others:
        off = abs(other.release.phi - scene.release.phi)
        # an ulp of the angle itself
        assert off <= SIZE * abs(scene.release.phi - balance) + 2e-16
        assert off <= SIZE * scene.release.phi
        assert other.release.theta_dot == pytest.approx(scene.release.theta_dot, rel=SIZE, abs=0)
        assert replace(other, name=scene.name, release=scene.release) == scene
