"""The probe of the heading: nothing in an engine without a direction, and what has one is told."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case
from harness.engines.mujoco.engine import MujocoEngine
from harness.engines.mujoco.world import MujocoWorld
from harness.engines.probes import PROBES
from harness.engines.probes.heading import HEADINGS, passing
from harness.engines.reference.truth import truth
from harness.engines.registry import engine
from models import Scene, angles


def spreads(chosen: Any, case: Case) -> Mapping[str, float]:
    """Return the readings of the probe by quantity, deg."""
    readings = PROBES["heading"](chosen, case)
    return {quantity: math.degrees(value) for quantity, _, value, _, _ in readings}


@pytest.mark.parametrize("profile", ["matched", "adaptive"])
@pytest.mark.parametrize(
    "name",
    [
        *("mujoco", "reference"),
        pytest.param("pybullet", marks=pytest.mark.engine("pybullet")),
        pytest.param("dart", marks=(pytest.mark.engine("dart"), pytest.mark.slow)),
        pytest.param("mjx", marks=(pytest.mark.engine("mjx"), pytest.mark.slow)),
    ],
)
def test_an_engine_in_double_precision_has_one_answer(
    gentle: Scene, name: str, profile: str
) -> None:
    found = spreads(engine(name), Case(scene=gentle, engine=name, profile=profile))
    # an ulp over the least tilt is 3e-10 deg, which some thousand steps amplify; friction along the
    # directions of a manifold has a grain of its own, of half a thousandth in a resolved bounce
    assert found["spread of the turn"] < 0.01
    assert found["spread of the tilt behind it"] < 1e-3


@pytest.mark.parametrize("profile", ["matched", "adaptive"])
@pytest.mark.parametrize(
    ("name", "options"),
    [
        pytest.param("mujoco-warp", (), marks=pytest.mark.engine("mujoco-warp")),
        pytest.param(
            "mjx", (("jax_enable_x64", False),), marks=(pytest.mark.engine("mjx"), pytest.mark.slow)
        ),
    ],
)
def test_a_rim_whose_direction_is_lost_in_single_precision_has_many(
    gentle: Scene, name: str, options: tuple[tuple[str, bool], ...], profile: str
) -> None:
    case = Case(scene=gentle, engine=name, profile=profile, options=options)
    assert spreads(engine(name), case)["spread of the turn"] > 10.0


class LeaningEngine(MujocoEngine):
    """Has a plane that is not level by a thousandth, unseen where gravity is probed."""

    def open(self, case: Case) -> MujocoWorld:
        """Compile a scene, and let gravity point aside."""
        world = super().open(case)
        world.model.opt.gravity[0] = 1e-3 * case.scene.gravity
        return world


def test_a_direction_of_the_plane_is_told(gentle: Scene) -> None:
    case = Case(scene=gentle, engine="mujoco")
    assert spreads(LeaningEngine(), case)["spread of the turn"] > 1.0


def test_the_can_passes_the_flat_state_where_it_is_said(gentle: Scene) -> None:
    for heading in HEADINGS[:2]:
        exact = truth(passing(gentle, heading))
        path = exact.at(np.linspace(0.0, exact.ends, 20_000))
        phi, psi, _ = angles(path.quaternion)
        assert 1e-5 < phi.min() < 4e-5
        assert psi[0] == pytest.approx(heading)
        assert phi[-1] > phi[0]
