"""The probe of a declared compliance: its closed form, and what engines make of a spring."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy

from harness.core.case import Case
from harness.engines.probes import PROBES
from harness.engines.probes.drop import Drop
from models import Compliance, Effects, Scene
from tests.support.engines import stepping_engine

MASS, GRAVITY, STIFFNESS, SPEED = 0.04, 9.81, 1e4, 0.2


@pytest.mark.parametrize("damping", [0.0, 5.0, 39.0, 42.0])
def test_the_closed_form_is_the_drop_integrated(damping: float) -> None:
    def rate(_: float, y: np.ndarray) -> tuple[float, float]:
        depth, sinking = y
        return sinking, GRAVITY - (STIFFNESS * depth + damping * sinking) / MASS

    def pushes(_: float, y: np.ndarray) -> float:
        return float(STIFFNESS * y[0] + damping * y[1])

    def turns(_: float, y: np.ndarray) -> float:
        return float(y[1])

    pushes.terminal, pushes.direction = True, -1  # type: ignore[attr-defined]
    found = scipy.integrate.solve_ivp(
        rate, (0, 0.03), (0.0, SPEED), "DOP853", events=(pushes, turns), rtol=1e-12, atol=1e-16
    )
    own = Drop.of(MASS, GRAVITY, STIFFNESS, damping, SPEED)
    assert own.deepest == pytest.approx(found.y_events[1][0, 0], rel=1e-8)
    if found.t_events[0].size:
        assert own.lasts == pytest.approx(found.t_events[0][0], rel=1e-8)
        assert own.rebound == pytest.approx(-found.y_events[0][0, 1] / SPEED, rel=1e-6)
    else:
        assert math.isnan(own.lasts)


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_the_spring_of_an_engine_is_the_declared_one_in_the_limit(gentle: Scene, name: str) -> None:
    law = Effects(compliance=Compliance(stiffness=1e4, damping=10.0))

    def misses(timestep: float) -> np.ndarray:
        case = Case(scene=replace(gentle, effects=law), engine=name, timestep=timestep)
        readings = PROBES["declared compliance"](stepping_engine(name), case)
        return np.array([abs(value / expected - 1) for _, _, value, expected, _ in readings])

    coarse, fine = misses(1e-4), misses(1e-5)
    # to first order; the time of the contact is read to one step, and MuJoCo misses by 1e-4
    lasts = 6.3e-3
    assert fine[0] <= 1e-5 / lasts
    assert (fine[1:] <= 0.11 * coarse[1:] + 2e-4).all()
    assert (coarse[1:] < 0.1).all()


def test_without_a_declared_spring_nothing_is_dropped(gentle: Scene) -> None:
    case = Case(scene=gentle, engine="mujoco", timestep=1e-3)
    assert not list(PROBES["declared compliance"](stepping_engine("mujoco"), case))
