"""The probe of a declared restitution: what MuJoCo and PyBullet give back of a drop."""

import re
from dataclasses import replace

import pytest

from harness.core.case import Case
from harness.engines.probes import PROBES
from harness.engines.probes.impact import COEFFICIENTS, SPEEDS
from models import Effects, Restitution, Scene
from tests.support.engines import stepping_engine


def misses(scene: Scene, name: str, timestep: float) -> dict[tuple[float, str], float]:
    """Return by coefficient and manner how far the worst rebound is off."""
    case = Case(scene=scene, engine=name, timestep=timestep)
    found = {}
    for quantity, _, value, expected, _ in PROBES["declared restitution"](
        stepping_engine(name), case
    ):
        how = re.split(r" at |, ", quantity)[1]
        found[expected, how] = abs(value - expected)
    return found


def test_mujoco_misses_newton_s_law_by_half_of_the_depth_taken(gentle: Scene) -> None:
    found = misses(gentle, "mujoco", 1e-5)
    straight = [value for (_, how), value in found.items() if how != "slipping through"]
    assert len(straight) == len(COEFFICIENTS) * len(SPEEDS)
    # half of kappa, 0.002, the impedance, and one that takes two steps without restitution
    assert max(straight) < 2e-3
    assert sorted(straight)[-len(SPEEDS) - 1] < 1.2e-3
    # convex coupling: a tenth at least, whatever the timestep, which is why it is told
    assert min(value for (_, how), value in found.items() if how == "slipping through") > 0.1


def test_pybullet_adds_the_gravity_of_a_step(gentle: Scene) -> None:
    coarse, fine = (misses(gentle, "pybullet", step) for step in (1e-4, 1e-5))
    for (coefficient, how), value in fine.items():
        if coefficient >= 0.5:
            assert value == pytest.approx(0.1 * coarse[coefficient, how], rel=0.15)
    unit = (gentle.gravity * gentle.can.radius) ** 0.5
    # e g dt/v at the lowest speed, and once more in the step in which the rim leaves
    at_most = 2.2 * gentle.gravity * 1e-5 / (SPEEDS[0] * unit)
    assert max(fine.values()) < at_most


def test_an_engine_without_an_impact_law_is_not_dropped(gentle: Scene) -> None:
    class Without:
        capabilities = replace(stepping_engine("mujoco").capabilities, honours=frozenset())

    case = Case(scene=gentle, engine="mujoco", timestep=1e-3)
    assert not list(PROBES["declared restitution"](Without(), case))  # type: ignore[arg-type]


@pytest.mark.parametrize("timestep", [2e-3, 1e-4])
def test_the_coefficient_is_that_of_the_timestep(gentle: Scene, timestep: float) -> None:
    scene = replace(gentle, effects=Effects(restitution=Restitution(coefficient=0.5)))
    for profile in ("default", "matched"):
        case = Case(scene=scene, engine="mujoco", timestep=timestep, profile=profile)
        rows = {row.quantity: row for row in stepping_engine("mujoco").parity(case)}
        assert rows["restitution"].found == pytest.approx(0.5, abs=1.2e-3)
