"""Lean against everything, on one scene: the same motion, and what is said of it."""

import math
from dataclasses import replace

from harness.benchmark.lean import GAIN, PIECE, TOLERANCE, between, in_mujoco, in_reference
from harness.case import Case
from harness.engines.registry import engine
from harness.trajectory import Trajectory
from models import Horizon, Scene, load


def _path(scene: Scene, build: str, timestep: float = 1e-3) -> Trajectory:
    options = (("build", build),)
    case = Case(scene=scene, engine="mujoco", timestep=timestep, options=options)
    found = engine("mujoco").simulate(case).trajectory
    assert found is not None
    return found


def test_a_lean_can_of_mujoco_moves_as_one_with_everything(gentle: Scene) -> None:
    found = in_mujoco(gentle, pairs=1)
    assert (found.scene, found.who, found.model) == ("gentle-rock", "mujoco", "condim 3")
    # how much faster is not for tests to say, but that it was measured is
    assert found.ratio == found.everything_s / found.lean_s > 0.0
    assert found.holds == (found.ratio >= GAIN["mujoco"])
    assert found.difference <= found.tolerance == TOLERANCE


def test_the_reference_turns_alike_without_its_locus(gentle: Scene) -> None:
    found = in_reference(gentle, pairs=1)
    assert (found.who, found.model, found.quantity) == ("reference", "rolling", "")
    assert found.difference == 0.0  # the locus is a quadrature beside the angles: not a bit moves
    assert found.claim == "at least 2"


def test_nothing_is_claimed_where_the_contact_point_is_part_of_the_equations() -> None:
    scene = replace(load("tilted-plane"), horizon=Horizon(seconds=0.05))
    found = in_reference(scene, pairs=1)
    assert (found.model, found.claim, found.holds) == ("general", "", True)


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
