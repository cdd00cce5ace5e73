"""Adaptive steps keep their promises for releases that a generator drew, none of them tuned on."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.evaluation.evaluate import evaluate
from models import Release, load

BOUND = 0.02
"""deg: as README says; the worst of these releases misses by 0.0101, in PyBullet."""

WORST = 0.035
"""deg: of two hundred releases of the hard kind one, in MuJoCo, misses by 0.0334; no other by more
than `BOUND`."""

SEED = 20261121
"""Of the day on which these were first drawn, after the rule was settled."""


def drawn(number: int) -> Release:
    """Return a release from gentle to hard, its spin nearly against its precession."""
    rng = np.random.default_rng((SEED, number))
    psi_dot = float(rng.uniform(-1.0, 1.0))
    return Release(
        phi=float(np.exp(rng.uniform(math.log(0.01), math.log(0.45)))),
        psi_dot=psi_dot,
        theta_dot=-psi_dot * float(rng.uniform(0.9, 1.0)),
    )


def spinning(number: int) -> Release:
    """Draw a release of the gentle kind: any tilt, rates of any sign that need not cancel."""
    rng = np.random.default_rng((SEED, 1000 + number))
    return Release(
        phi=float(rng.uniform(0.1, 0.45)),
        psi_dot=float(rng.uniform(-2.0, 2.0)),
        theta_dot=float(rng.uniform(-2.0, 2.0)),
    )


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
@pytest.mark.parametrize("number", range(8))
@pytest.mark.parametrize("draw", [drawn, spinning])
def test_a_drawn_release_turns_right(
    draw: Callable[[int], Release], number: int, engine: str
) -> None:
    assert abs(missed(draw(number), engine)) <= BOUND


@pytest.mark.parametrize(("engine", "bound"), [("mujoco", WORST), ("pybullet", BOUND)])
def test_the_worst_of_two_hundred_misses_by_little_more(engine: str, bound: float) -> None:
    assert abs(missed(drawn(16), engine)) <= bound


def missed(release: Release, engine: str) -> float:
    """Return by how much the turn is missed, deg."""
    scene = replace(load("paper-release"), release=release)
    found = evaluate(Case(scene=scene, engine=engine, profile="adaptive"))
    assert found.errors is not None
    (turn,) = found.errors.angle_of_turn
    return math.degrees(turn)


def test_the_draw_spans_gentle_and_hard() -> None:
    scenes = [replace(load("paper-release"), release=drawn(number)) for number in range(8)]
    cases = [Case(scene=scene, engine="reference") for scene in scenes]
    depths = [evaluate(case).true_bounces[0].phi_min for case in cases]
    assert min(depths) < 1e-4
    assert max(depths) > 1e-3
