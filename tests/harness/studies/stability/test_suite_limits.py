"""Numbers that README and docstrings cite of the hard cases and of their exact motions.

They are written out here and not imported: whoever changes one in the code is told which sentence
no longer holds.
"""

import math
from dataclasses import replace

import pytest

from harness.core.case import Case
from harness.engines.reference.truth import Truth, solve_case
from harness.studies.stability import survey
from harness.studies.stability.suite import SUITES, ladder, random_scenes
from models import Horizon, hard_names, load

GENTLE = load("gentle-rock")


def test_the_full_suite_is_the_one_of_readme() -> None:
    full = SUITES["full"]
    assert full.scenes == hard_names()
    assert len(full.scenes) == 36
    assert (max(full.timesteps), min(full.timesteps)) == (2e-2, 1e-8)
    assert (full.most_steps, full.random_scenes) == (200_000, 10_000)
    # releases of each case, and the ratio at which a largest timestep counts as known
    assert (full.members, full.ratio) == (3, 1.05)
    quick = SUITES["quick"]
    assert (quick.most_steps, quick.random_scenes) == (10_000, 200)
    assert (quick.members, quick.ratio) == (2, 1.25)


@pytest.mark.parametrize(("seconds", "runs"), [(0.0799, False), (0.08, True)])
def test_a_run_of_fewer_than_four_steps_is_none(seconds: float, *, runs: bool) -> None:
    scene = replace(GENTLE, horizon=Horizon(seconds=seconds))
    assert (2e-2 in ladder(SUITES["full"], scene)) is runs


@pytest.mark.parametrize(("seconds", "runs"), [(0.1999, True), (0.2001, False)])
def test_a_run_of_more_than_200_000_steps_is_none(seconds: float, *, runs: bool) -> None:
    scene = replace(GENTLE, horizon=Horizon(seconds=seconds))
    assert (1e-6 in ladder(SUITES["full"], scene)) is runs


def test_random_cans_go_from_disks_to_rods_and_releases_from_1e_9_rad_to_pi_over_2() -> None:
    scenes = list(random_scenes(500))
    heights = [scene.can.h for scene in scenes]
    assert 1e-2 <= min(heights) < 1.2e-2
    assert 8.0 < max(heights) <= 10.0
    tilts = [scene.release.phi for scene in scenes]
    assert 1e-9 <= min(tilts) < 1.5e-9
    assert 0.95 < max(tilts) / (math.pi / 2.0) < 1.0


@pytest.fixture(scope="module")
def motion() -> Truth:
    return solve_case(Case(scene=GENTLE, engine="reference"))


def checked(
    motion: Truth,
    monkeypatch: pytest.MonkeyPatch,
    *,
    off: float = 0.0,
    drift: float = 0.0,
    ulp: float = 0.0,
    other: Truth | None = None,
) -> survey.ReferenceCheck:
    """Return what is said of two motions that differ and drift by so much."""
    monkeypatch.setattr(survey, "_apart", lambda *_: off)
    monkeypatch.setattr(survey, "_energy_error", lambda *_: drift)
    monkeypatch.setattr(survey, "_of_an_ulp", lambda _: ulp)
    monkeypatch.setattr(survey, "cancelled", lambda _: 0.0)
    return survey.compared(GENTLE, motion, other or motion)


@pytest.mark.parametrize(("size", "holds"), [(0.99e-9, True), (1.01e-9, False)])
def test_two_solutions_agree_to_a_billionth_and_keep_the_energy_to_one(
    motion: Truth, size: float, monkeypatch: pytest.MonkeyPatch, *, holds: bool
) -> None:
    assert (checked(motion, monkeypatch, off=size).failure == "") is holds
    assert (checked(motion, monkeypatch, drift=size).failure == "") is holds


@pytest.mark.parametrize(("times", "refused"), [(15.9, True), (16.1, False)])
def test_what_sixteen_ulps_do_is_the_input_s(
    motion: Truth, times: float, monkeypatch: pytest.MonkeyPatch, *, refused: bool
) -> None:
    found = checked(motion, monkeypatch, off=times * 1.01e-9, ulp=1.01e-9)
    assert (found.failure == "") is refused
    assert found.refusal.startswith("One ulp") is refused
    # an ulp that does less than what is promised excuses nothing
    assert checked(motion, monkeypatch, off=1.01e-9, ulp=0.99e-9).failure


@pytest.mark.parametrize(("evaluations", "holds"), [(4000, True), (4001, False)])
def test_a_bounce_takes_four_thousand_evaluations_at_most(
    motion: Truth, evaluations: int, monkeypatch: pytest.MonkeyPatch, *, holds: bool
) -> None:
    solution = replace(motion.solution, model="rolling", evaluations=evaluations)
    found = checked(motion, monkeypatch, other=replace(motion, solution=solution))
    assert (found.failure == "") is holds
