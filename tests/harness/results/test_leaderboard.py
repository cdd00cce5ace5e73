"""The leaderboard: the best case of each engine, in one division, with its cost and command."""

import math
import shlex

import pytest

from harness.results.errors import MixedSuitesError
from harness.results.leaderboard import cost_points, error_rad, frontier, leaderboard
from harness.results.scores import Division, Score
from tests.support.gate_scores import make_score, make_scores

TURN, PHI = "angle_of_turn_error_deg", "phi_rms_rad"


def cell(
    phi: float, steps: float = 10.0, cpu: float = 1.0, turn: float | None = None, **rest: object
) -> Score:
    turned = {} if turn is None else {TURN: turn}
    values = {PHI: phi, "steps": steps, "cpu_s": cpu, **turned}
    return make_score(values, **rest)  # type: ignore[arg-type]


def test_the_best_case_of_each_engine_comes_first_with_what_it_cost() -> None:
    coarse, fine = cell(1e-2), cell(1e-3, steps=100.0, cpu=9.0, timestep=1e-4)
    other = cell(1e-4, engine="pybullet")
    first, second = leaderboard([make_scores(coarse, fine), make_scores(other)], Division.MATCHED)
    assert (first.engine, second.engine) == ("pybullet", "mujoco")
    assert second.best is not None
    assert (second.best.error_rad, second.best.steps, second.best.cpu_s) == (1e-3, 100, 9.0)
    assert second.best.case == "gentle-rock in mujoco (matched, 0.0001 s)"
    assert (second.version, second.best.turn_error_deg) == ("4.0.0", None)


def test_an_error_of_the_turn_that_is_zero_by_chance_does_not_win() -> None:
    lucky, fine = cell(1e-2, turn=0.0), cell(1e-4, turn=0.01, timestep=1e-4)
    (only,) = leaderboard([make_scores(lucky, fine)], Division.MATCHED)
    assert only.best is not None
    assert only.best.turn_error_deg == 0.01
    assert only.best.error_rad == pytest.approx(math.radians(0.01))
    assert error_rad(lucky, turns=True) == 1e-2


def test_divisions_never_meet() -> None:
    shipped = cell(1e-9, profile="default", timestep=0.0, division=Division.AS_SHIPPED)
    result = make_scores(shipped, cell(1e-3))
    (matched,) = leaderboard([result], Division.MATCHED)
    assert matched.best is not None
    assert matched.best.error_rad == 1e-3
    assert leaderboard([result], Division.OPEN) == ()
    assert [point.division for point in cost_points([result], Division.AS_SHIPPED)] == [
        Division.AS_SHIPPED
    ]


@pytest.mark.parametrize(
    "score",
    [
        cell(1e-3, outcome="FLAT"),
        cell(1e-3, truth_pulls=True),
        make_score({"steps": 1.0, "cpu_s": 1.0}),
        make_score({PHI: 1e-3}),
        make_score({PHI: 1e-3, "steps": 1.0, "cpu_s": 1.0, "bounce_time_error_s": 0.1}),
    ],
)
def test_what_cannot_be_ranked_stands_last_with_its_endings(score: Score) -> None:
    fine = cell(1.0, engine="pybullet", turn=1.0)
    first, last = leaderboard([make_scores(score), make_scores(fine)], Division.MATCHED)
    assert first.engine == "pybullet"
    assert (last.best, last.endings) == (None, (score.outcome,))
    assert last.truth_pulls is score.truth_pulls


def test_suites_are_not_mixed() -> None:
    mixed = [make_scores(cell(1.0), suite="quick"), make_scores(cell(1.0), suite="full")]
    for function in (leaderboard, cost_points):
        with pytest.raises(MixedSuitesError) as caught:
            function(mixed, Division.MATCHED)
        assert caught.value.suites == ("full", "quick")


def test_the_frontier_has_what_no_cheaper_case_is_as_exact_as() -> None:
    cases = [
        cell(phi, steps=steps, cpu=cpu, timestep=timestep)
        for phi, steps, cpu, timestep in (
            (1e-2, 1.0, 3.0, 1e-1),
            (1e-3, 2.0, 2.0, 1e-2),
            (5e-3, 3.0, 1.0, 1e-3),
            (1e-3, 4.0, 4.0, 1e-4),
        )
    ]
    points = cost_points([make_scores(*cases)], Division.MATCHED)
    assert [point.steps for point in frontier(points, "steps")] == [1, 2]
    assert [point.steps for point in frontier(points, "cpu_s")] == [3, 2]
    assert frontier((), "steps") == ()


def test_the_command_runs_the_case_with_the_settings_of_its_file() -> None:
    open_ = cell(1e-3, division=Division.OPEN)
    settings = {"mujoco.impratio": "2", "pybullet.contactERP": "0.1"}
    (point,) = cost_points([make_scores(open_, settings=settings)], Division.OPEN)
    assert shlex.split(point.command) == [
        *("rockingcan", "run", "gentle-rock", "--engine", "mujoco", "--profile", "matched"),
        *("--timestep", "0.001", "--set", "impratio=2"),
    ]


def test_engines_that_impose_rolling_stand_apart() -> None:
    imposed, contact = cell(1e-9, engine="exudyn"), cell(1e-3)
    results = [make_scores(imposed), make_scores(contact)]
    last = leaderboard(results, Division.MATCHED)[-1]
    assert (last.engine, last.imposes_rolling) == ("exudyn", True)
    points = cost_points(results, Division.MATCHED)
    assert [point.engine for point in frontier(points, "steps")] == ["mujoco"]
    alone = [point for point in points if point.imposes_rolling]
    assert [point.engine for point in frontier(alone, "steps")] == ["exudyn"]


def test_a_turn_that_nobody_could_count_is_no_small_error() -> None:
    coarse = cell(1e-3, timestep=1e-2)
    (only,) = leaderboard([make_scores(coarse, cell(1e-2, turn=0.1))], Division.MATCHED)
    assert only.best is not None
    assert only.best.phi_rms_rad == 1e-2
