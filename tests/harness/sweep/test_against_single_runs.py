"""A row of a sweep is what a single run of its scene says."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from harness.core.case import Case
from harness.engines.reference.truth import solve_case
from harness.evaluation.evaluate import evaluate
from harness.sweep.parameters import scene_at
from models import Horizon, load
from reference import PAPER_CAN, Problem
from reference.asymptotic.small_nutation import reduced_of
from tests.support.sweeps import carried_out, make_plan

ROUND_OFF = 1e-11
"""Of a quadrature of tens of terms beside another with other companions in its chunk."""


def test_exact_rows_are_those_of_the_reference(tmp_path: Path) -> None:
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=0.5:3:3", "can.h=0.5:2:3", "gravity=1.6:9.81:2"
    )
    assert chosen.exact
    frame = carried_out(tmp_path / "out", chosen)
    values = chosen.values(range(chosen.rows))
    for row in range(chosen.rows):
        scene = scene_at(load("gentle-rock"), {n: float(v[row]) for n, v in values.items()})
        case = Case(scene=scene, engine="reference", options=(("model", "exact"),))
        (bounce,) = solve_case(case).bounces
        assert frame.angle_of_turn_deg[row] == pytest.approx(
            math.degrees(bounce.angle_of_turn), rel=ROUND_OFF
        )
        assert frame.period_s[row] == pytest.approx(bounce.end - bounce.start, rel=ROUND_OFF)
        assert frame.phi_min_rad[row] == pytest.approx(bounce.phi_min, rel=ROUND_OFF, abs=0)
        assert frame.peak_psi_dot_rad_s[row] == pytest.approx(bounce.peak_psi_dot, rel=ROUND_OFF)


def test_the_papers_release_turns_as_it_does(tmp_path: Path) -> None:
    frame = carried_out(
        tmp_path / "out",
        make_plan("paper-release", "gravity=9.81:9.81:1", quantities=["angle_of_turn_deg"]),
    )
    # fifteen digits from heyoka's Taylor integrator
    assert frame.angle_of_turn_deg[0] == pytest.approx(209.363400462452, rel=1e-11)


def test_epsilon_is_that_of_the_reduced_equation(tmp_path: Path) -> None:
    chosen = make_plan("paper-release", "release.psi_dot=0.05:0.5:4", quantities=["epsilon"])
    frame = carried_out(tmp_path / "out", chosen)
    scene = load("paper-release")
    T = math.sqrt(scene.can.radius / scene.gravity)
    for rate, found in zip(frame.release_psi_dot_rad_s, frame.epsilon, strict=True):
        problem = Problem(
            parameters=PAPER_CAN,
            phi=scene.release.phi,
            psi_dot=rate * T,
            theta_dot=scene.release.theta_dot * T,
            bounces=1,
        )
        assert found == pytest.approx(reduced_of(problem).B_minus_two ** 2, rel=1e-12, abs=0)


def test_runs_of_an_engine_are_those_of_its_adapter(tmp_path: Path) -> None:
    chosen = make_plan(
        "gentle-rock",
        "release.psi_dot=1.5:2.5",
        sample="sobol",
        count=4,
        engine="mujoco",
        timestep=1e-3,
        quantities=["angle_of_turn_deg", "angle_of_turn_error_deg", "steps", "energy_drift"],
    )
    frame = carried_out(tmp_path / "out", chosen)
    for row, rate in enumerate(frame.release_psi_dot_rad_s):
        scene = scene_at(load("gentle-rock"), {"release.psi_dot": rate})
        alone = evaluate(Case(scene=scene, engine="mujoco", timestep=1e-3))
        assert frame.angle_of_turn_deg[row] == math.degrees(alone.bounces[0].angle_of_turn)
        assert frame.steps[row] == alone.simulation.steps
        assert frame.energy_drift[row] == alone.energy_drift
        assert alone.errors is not None
        # the error of a run is held against an integration, that of a sweep against the formula
        assert frame.angle_of_turn_error_deg[row] == pytest.approx(
            math.degrees(alone.errors.angle_of_turn[0]), abs=1e-7
        )


@pytest.mark.slow
def test_runs_of_other_lengths_are_those_of_their_scenes(tmp_path: Path) -> None:
    words = ["period_s", "steps", "energy_drift"]
    more = {"engine": "mujoco", "timestep": 1e-3, "quantities": words}
    counted = carried_out(tmp_path / "a", make_plan("petals", "horizon.bounces=1:3:3", **more))
    assert counted.horizon_bounces.tolist() == [1.0, 2.0, 3.0]
    timed = carried_out(tmp_path / "b", make_plan("petals", "horizon.seconds=0.01:1.5:2", **more))
    horizons = [Horizon(bounces=n) for n in (1, 2, 3)] + [Horizon(seconds=s) for s in (0.01, 1.5)]
    rows = [*counted.itertuples(), *timed.itertuples()]
    for horizon, row in zip(horizons, rows, strict=True):
        scene = replace(load("petals"), horizon=horizon)
        alone = evaluate(Case(scene=scene, engine="mujoco", timestep=1e-3))
        assert row.steps == alone.simulation.steps
        assert row.energy_drift == alone.energy_drift
    assert counted.steps.is_monotonic_increasing
    assert timed.period_s.notna().tolist() == [False, True]
    assert str(timed.outcome[0]).startswith("no bounce")


def test_what_only_a_whole_motion_has_is_solved_for(tmp_path: Path) -> None:
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=1:3:2", quantities=["peak_friction_ratio", "period_s"]
    )
    assert not chosen.exact
    frame = carried_out(tmp_path / "out", chosen)
    for rate, ratio in zip(frame.release_psi_dot_rad_s, frame.peak_friction_ratio, strict=True):
        scene = scene_at(load("gentle-rock"), {"release.psi_dot": rate})
        (bounce,) = solve_case(Case(scene=scene, engine="reference")).bounces
        assert ratio == bounce.peak_friction_ratio


def test_a_scene_without_a_bounce_says_why_and_has_no_number(tmp_path: Path) -> None:
    frame = carried_out(
        tmp_path / "out",
        make_plan("gentle-rock", "can.c=0.2:3:5", "gravity=0:9.81:2", "release.height=-1:1:3"),
    )
    bounced = frame.outcome.astype(str).str.startswith("finished")
    assert bounced.sum() == 2  # the lightest spins on the plane, under gravity
    assert frame.angle_of_turn_deg.notna().tolist() == bounced.tolist()
    words = " ".join(map(str, frame.outcome.unique()))
    for part in ("no rigid body has C greater than 2A", "Without gravity", "inside"):
        assert part in words


def test_the_same_in_runs_of_an_engine(tmp_path: Path) -> None:
    frame = carried_out(
        tmp_path / "out",
        make_plan(
            "gentle-rock", "can.c=0.5:3:2", engine="mujoco", timestep=1e-3, quantities=["period_s"]
        ),
    )
    assert frame.period_s.notna().tolist() == [True, False]
    assert "no rigid body has C greater than 2A" in str(frame.outcome[1])


def test_numbers_beyond_doubles_are_said_to_be(tmp_path: Path) -> None:
    frame = carried_out(
        tmp_path / "out", make_plan("gentle-rock", "release.psi_dot=log:1e-200:1e300:11")
    )
    missing = frame[frame.angle_of_turn_deg.isna()]
    assert len(missing)
    assert not missing.outcome.astype(str).str.startswith("finished").any()


@pytest.mark.parametrize("quantity", ["angle_of_turn_deg", "peak_friction_ratio"])
@pytest.mark.parametrize(
    "axis",
    [
        "release.psi_dot=log:1:1e200:2",
        "release.phi_dot=log:1e-3:1e160:2",
        "release.phi=log:1e-200:0.3:2",
    ],
)
def test_a_release_beyond_doubles_leaves_the_others_alone(
    tmp_path: Path, quantity: str, axis: str
) -> None:
    frame = carried_out(tmp_path / "out", make_plan("gentle-rock", axis, quantities=[quantity]))
    beyond = frame.outcome.astype(str).str.contains("beyond what a double holds")
    assert frame[quantity].isna().tolist() == beyond.tolist()
    assert 0 < beyond.sum() < len(frame)


def test_columns_carry_their_units_and_meaning(tmp_path: Path) -> None:
    chosen = make_plan("gentle-rock", "release.psi_dot=1:2:2", "can.H=0.05:0.06:2")
    frame = carried_out(tmp_path / "out", chosen)
    assert list(frame.columns[:3]) == ["row", "release_psi_dot_rad_s", "can_H_m"] or list(
        frame.columns[:3]
    ) == ["row", "can_H_m", "release_psi_dot_rad_s"]
    schema = pq.read_schema(next((tmp_path / "out" / "parts").iterdir()))
    assert all((field.metadata or {}).get(b"description") for field in schema)
    assert isinstance(frame, pd.DataFrame)
    assert np.array_equal(frame.row, range(4))
