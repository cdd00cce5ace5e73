"""Numbers that README and docstrings cite of the study of effects, written out.

They are not imported: whoever changes one in the code is told which sentence no longer holds.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from harness.studies.effects import friction
from harness.studies.effects.changes import EffectsResults
from harness.studies.effects.plan import assumed_strengths, plan_effects
from models import (
    AirFilm,
    Compliance,
    ContourFriction,
    Damping,
    Drilling,
    Effects,
    PointMass,
    Restitution,
    RollingResistance,
    RoundedRim,
    Scene,
    Shake,
    Slip,
    Tilt,
    load,
)

GENTLE = load("gentle-rock")
CAN = GENTLE.can


def test_a_real_can_on_a_real_table_has_the_effects_that_readme_says() -> None:
    found = assumed_strengths(CAN)
    assert found == {
        "slip": Slip(mu=0.4),
        "compliance": Compliance(stiffness=1e7, damping=0.0),
        "restitution": Restitution(coefficient=0.5),
        "drilling": Drilling(length=3e-5),
        "rolling_resistance": RollingResistance(length=3e-5),
        "contour_friction": ContourFriction(coulomb=1e-3),
        "air_film": AirFilm(viscosity=1.8e-5),
        "damping": Damping(linear=0.01, angular=0.01),
        "rim": RoundedRim(radius=0.02 * CAN.radius),
        "tilt": Tilt(angle=1e-3),
        "shake": Shake(frequency=30.0, vertical=1e-6, horizontal=1e-6),
        "point_mass": PointMass(mass=1e-3 * CAN.mass, x=CAN.radius),
    }
    assert f"{1e3 * found['rim'].radius:.2f} mm" == "0.74 mm"


def test_under_its_weight_a_can_sinks_in_by_forty_nanometres() -> None:
    depth = CAN.mass * GENTLE.gravity / assumed_strengths(CAN)["compliance"].stiffness
    assert depth == pytest.approx(40e-9, rel=0.1)


@pytest.mark.parametrize(
    ("key", "counts"),
    [
        ("turn_deg", 0.1),
        ("bounce_time_s", 1e-4),
        ("peak_friction_ratio", 0.01),
        ("phi_end_rad", 1e-3),
        ("x_end_m", 1e-4),
        ("y_end_m", 1e-4),
    ],
)
def test_a_tenth_of_a_degree_counts_and_the_rest_in_proportion(key: str, counts: float) -> None:
    plan = plan_effects(GENTLE, ("mujoco",))
    found = EffectsResults(plan=plan, evaluations={}, times={})
    assert found.threshold("mujoco", key) == pytest.approx(counts, rel=1e-12, abs=0)


@pytest.mark.parametrize(("count", "every"), [(3, True), (4, False)])
def test_of_three_effects_every_subset_is_run(count: int, *, every: bool) -> None:
    strengths = assumed_strengths(CAN)
    declared = ("slip", "tilt", "drilling", "damping")[:count]
    scene = Scene(
        name=GENTLE.name,
        cite=GENTLE.cite,
        gravity=GENTLE.gravity,
        can=CAN,
        release=GENTLE.release,
        horizon=GENTLE.horizon,
        effects=Effects(**{name: strengths[name] for name in declared}),
    )
    plan = plan_effects(scene, ("reference",))
    assert plan.factorial is every
    own = [subset for subset in plan.subsets() if subset <= plan.declared]
    assert len(set(own)) == (2**count if every else 2 + 2 * count)


def test_friction_is_laddered_up_to_one() -> None:
    ladder = friction.friction_ladder(GENTLE, ("reference",), None)["reference"]
    tenths = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
    assert tuple(ladder) == (0.0, 0.05, *tenths)


def test_a_rim_slides_from_a_millionth_of_the_natural_speed_on() -> None:
    natural = math.sqrt(GENTLE.gravity * CAN.radius)
    run = SimpleNamespace(
        simulation=SimpleNamespace(case=SimpleNamespace(scene=GENTLE)),
        motion=SimpleNamespace(
            time=np.arange(3.0), slip=np.array([0.99e-6, 1.01e-6, np.nan]) * natural
        ),
    )
    _, slides = friction._sliding(run)  # type: ignore[arg-type]  # noqa: SLF001 - of a curve
    assert slides.tolist() == [False, True, False]
