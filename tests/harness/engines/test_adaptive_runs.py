"""What steps that follow the motion buy in both engines."""

import math
from dataclasses import replace

import pytest

from harness.core.case import Case
from harness.evaluation.evaluate import evaluate
from models import Horizon, Release, load


@pytest.mark.parametrize(("engine", "bound"), [("mujoco", 0.01), ("pybullet", 0.05)])
def test_the_paper_release_turns_right(engine: str, bound: float) -> None:
    e = evaluate(Case(scene=load("paper-release"), engine=engine, profile="adaptive"))
    assert e.errors is not None
    assert abs(math.degrees(e.errors.angle_of_turn[0])) <= bound
    assert e.simulation.steps < 10_000  # a fixed timestep with this error takes millions


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_three_gentle_bounces_in_a_row(engine: str) -> None:
    scene = replace(load("gentle-rock"), horizon=Horizon(bounces=3))
    e = evaluate(Case(scene=scene, engine=engine, profile="adaptive"))
    assert e.errors is not None
    turns = [abs(math.degrees(turn)) for turn in e.errors.angle_of_turn]
    assert len(turns) == 3
    assert turns[0] <= 0.02
    assert max(turns) <= 0.05


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
@pytest.mark.parametrize("release", [(0.05, 0.4, -0.38), (0.15, -0.7, 0.68), (0.02, 0.02, -0.021)])
def test_releases_that_nobody_tuned_on(engine: str, release: tuple[float, float, float]) -> None:
    phi, psi_dot, theta_dot = release
    scene = replace(
        load("paper-release"), release=Release(phi=phi, psi_dot=psi_dot, theta_dot=theta_dot)
    )
    e = evaluate(Case(scene=scene, engine=engine, profile="adaptive"))
    assert e.errors is not None
    assert (
        abs(math.degrees(e.errors.angle_of_turn[0])) <= {"mujoco": 0.01, "pybullet": 0.05}[engine]
    )
