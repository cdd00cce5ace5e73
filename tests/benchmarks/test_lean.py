"""Lean against everything, on one scene: the same motion, and what is said of it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.trajectory import Trajectory
from harness.engines.reference.to_reference_problem import problem
from harness.engines.registry import engine
from models import Horizon, Scene, load
from reference import solve
from tests.benchmarks.lean import ENGINE_GAIN, PIECE, TOLERANCE, between, in_engine, in_reference


@pytest.fixture
def gentle() -> Scene:
    """Return the gentle release, one bounce."""
    return load("gentle-rock")


def _path(scene: Scene, build: str, timestep: float = 1e-3) -> Trajectory:
    options = (("build", build),)
    case = Case(scene=scene, engine="mujoco", timestep=timestep, options=options)
    found = engine("mujoco").simulate(case).trajectory
    assert found is not None
    return found


def test_a_lean_can_of_mujoco_moves_as_one_with_everything(gentle: Scene) -> None:
    found = in_engine("mujoco", gentle, pairs=1)
    assert (found.scene, found.who, found.model) == ("gentle-rock", "mujoco", "condim 3")
    # how much faster is not for tests to say, but that it was measured is
    assert found.ratio == found.everything_s / found.lean_s > 0.0
    assert found.holds == (found.ratio >= ENGINE_GAIN)
    assert found.difference <= found.tolerance == TOLERANCE


def test_the_smallest_model_of_the_reference_turns_as_the_largest_does(gentle: Scene) -> None:
    found = in_reference(gentle, pairs=1)
    assert (found.who, found.model, found.claim) == ("reference", "rolling", "at least 2")
    assert found.difference < 1e-12


def test_also_where_the_largest_model_is_the_smallest() -> None:
    scene = replace(load("tilted-plane"), horizon=Horizon(seconds=0.05))
    found = in_reference(scene, pairs=1)
    assert (found.model, found.claim) == ("general", "at least 1")
    assert found.difference < 1e-12


@pytest.mark.parametrize("name", ["slipping-rock", "shaken-plane"])
def test_without_its_locus_the_reference_takes_no_more_steps_to_the_same_angles(name: str) -> None:
    piece = replace(load(name), horizon=Horizon(seconds=0.3))
    posed = problem(piece)
    lean = solve(posed)
    full = solve(posed, outputs={"contact_locus"})
    assert lean.steps <= full.steps
    times = np.linspace(0.0, lean.t_end, 50)
    few, all_of_it = lean.at(times), full.at(times)
    for quantity in ("phi", "psi", "theta"):
        one, other = getattr(few, quantity), getattr(all_of_it, quantity)
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-13)
    assert few.x is None
    assert all_of_it.x is not None


def test_a_difference_is_found_in_every_quantity(gentle: Scene) -> None:
    piece = replace(gentle, horizon=Horizon(seconds=PIECE))
    lean = _path(piece, "lean")
    same = between(lean, _path(piece, "everything"), piece)
    assert set(same) == {"phi rms", "place at the end", "time of the bounce", "turn"}
    assert max(same.values()) <= TOLERANCE
    faster = replace(piece, release=replace(piece.release, psi_dot=2.02))
    other = between(lean, _path(faster, "lean"), piece)
    # a hundredth more spin is seen in each, and as no more than it is
    assert all(TOLERANCE < value < 0.1 for value in other.values())


def test_a_bounce_that_one_motion_lacks_is_no_small_difference(gentle: Scene) -> None:
    piece = replace(gentle, horizon=Horizon(seconds=PIECE))
    balanced = replace(piece, release=replace(piece.release, phi=gentle.can.balancing_angle))
    found = between(_path(piece, "lean"), _path(balanced, "lean"), piece)
    assert found["bounce"] == math.inf
