"""Scenes with effects in both engines: against the exact motion, closed forms, and themselves."""

import math
from collections.abc import Iterable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import UnsupportedEffectError
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Trajectory
from harness.engines.conformance.scene_effects import DECLARED
from harness.engines.reference.truth import truth
from harness.engines.registry import check_effects, engine, missing_effects
from harness.engines.world import World
from harness.metrics.energy import energy_drift
from models import (
    Compliance,
    Effects,
    Horizon,
    PointMass,
    Pose,
    Restitution,
    RoundedRim,
    Scene,
    Shake,
    Slip,
    Tilt,
    Twist,
    contact_offset,
    load,
    names,
    quaternion,
)
from tests.support.absent_engines import absent_engines
from tests.support.declared_effects import declaring, effects_of
from tests.support.engines import DOUBLE, INSTALLED, stepping_engine

ENGINES = tuple(name for name in INSTALLED if name in DOUBLE)
EFFECTS = {
    "tilt": Effects(tilt=Tilt(angle=0.05, direction=0.3)),
    "shake": Effects(shake=Shake(frequency=15.0, horizontal=5e-4, vertical=3e-4, phase=0.4)),
    "point_mass": Effects(point_mass=PointMass(mass=0.004, x=0.02, y=0.005, z=-0.01)),
    "damping": effects_of("damping"),
    "frictionless": Effects(slip=Slip(mu=0.0)),
    "enough friction": Effects(slip=Slip(mu=0.6)),
    "rim": effects_of("rim"),
    "compliance": Effects(compliance=Compliance(stiffness=1e4, damping=10.0)),
}


def run(scene: Scene, name: str, timestep: float | None, **options: Value) -> Simulation:
    case = Case(scene=scene, engine=name, timestep=timestep, options=tuple(options.items()))
    return engine(name).simulate(case)


def honoured(effects: Iterable[str]) -> list[tuple[str, str]]:
    """Return each engine with each of these effects that it says it simulates."""
    return [(n, one) for n in ENGINES for one in effects if one in engine(n).capabilities.honours]


def miss(scene: Scene, name: str, timestep: float) -> float:
    """Return the largest distance of the can from its exact place, m."""
    path = run(scene, name, timestep).trajectory
    assert path is not None
    exact = truth(scene).at(path.time)
    return float(np.linalg.norm(path.position - exact.position, axis=1).max())


@pytest.mark.parametrize(("name", "effect"), honoured(EFFECTS))
def test_the_motion_converges_to_the_exact_one(gentle: Scene, name: str, effect: str) -> None:
    scene = replace(gentle, effects=EFFECTS[effect], horizon=Horizon(seconds=0.2))
    coarse, fine = miss(scene, name, 4e-4), miss(scene, name, 1e-4)
    # first order takes 1/4; a quarter again for the next order and for the start of a soft contact
    assert fine <= 0.32 * coarse
    assert fine <= 1e-4 * 0.5  # m: half a tenth of a millimetre, of the centimetres the can moves


@pytest.mark.parametrize(("name", "effect"), honoured(("drilling", "rolling_resistance", "slip")))
def test_friction_takes_what_the_exact_law_takes(gentle: Scene, name: str, effect: str) -> None:
    scene = replace(declaring(gentle, effect), horizon=Horizon(seconds=0.3))
    ideal = replace(scene, effects=Effects())
    times = np.linspace(0.0, 0.29, 30)
    taken = truth(scene).at(times).position - truth(ideal).at(times).position
    # mu is below what the bounce needs: PyBullet's sliding friction points 0.06 rad astray, and
    # MuJoCo's resistances share a cone and bring 1e-5 m of drilling, whatever the timestep
    assert miss(scene, name, 3e-5) <= 0.07 * float(np.linalg.norm(taken, axis=1).max())


@pytest.mark.parametrize(("name", "effect"), honoured(("tilt", "shake", "point_mass")))
def test_adaptive_steps_carry_effects_too(gentle: Scene, name: str, effect: str) -> None:
    scene = replace(gentle, effects=EFFECTS[effect], horizon=Horizon(seconds=0.2))
    path = engine(name).simulate(Case(scene=scene, engine=name, profile="adaptive")).trajectory
    assert path is not None
    exact = truth(scene).at(path.time)
    # steps of 3e-5 s at most: a third of what the finest fixed ones above may miss
    assert np.linalg.norm(path.position - exact.position, axis=1).max() <= 2e-5


def test_mujoco_gives_a_shaken_batch_the_bits_of_its_cases(gentle: Scene) -> None:
    scenes = [
        replace(gentle, effects=EFFECTS["shake"], release=replace(gentle.release, phi=phi))
        for phi in (0.4, 0.41, 0.42)
    ]
    cases = [Case(scene=scene, engine="mujoco", timestep=1e-3) for scene in scenes]
    together = stepping_engine("mujoco").simulate_many(cases)
    for case, one in zip(cases, together, strict=True):
        assert same_bits(one.trajectory, engine("mujoco").simulate(case).trajectory)


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("effect", ["tilt", "point_mass"])
def test_energy_on_a_slope_or_off_centre_drifts_no_more_than_at_home(
    gentle: Scene, name: str, effect: str
) -> None:
    scene = replace(gentle, effects=EFFECTS[effect], horizon=Horizon(seconds=0.2))
    path = run(scene, name, 1e-4).trajectory
    assert path is not None
    drift = energy_drift(path, scene)
    assert drift is not None
    # m g R: the level can drifts by 3e-4 at this timestep; with the wrong potential it were 0.1
    assert abs(drift) <= 1e-3


def balanced(scene: Scene, depth: float) -> Pose:
    """Return the can on its rim, its centre above the contact, at a depth, m."""
    phi = scene.can.balancing_angle
    height = -float(contact_offset(scene.can, phi, 0.0)[2])
    return Pose(position=np.array((0.0, 0.0, height - depth)), quaternion=quaternion(phi, 0.0, 0.0))


def world_of(scene: Scene, name: str, timestep: float) -> World:
    opened: World = stepping_engine(name).open(Case(scene=scene, engine=name, timestep=timestep))
    return opened


@pytest.mark.parametrize("damping", [0.0, 5.0])
@pytest.mark.parametrize(("name", "effect"), honoured(("compliance",)))
def test_a_compliant_contact_is_a_spring_and_a_damper(
    gentle: Scene, name: str, effect: str, damping: float
) -> None:
    assert effect == "compliance"
    k, timestep = 2e4, 1e-6
    scene = replace(gentle, effects=Effects(compliance=Compliance(stiffness=k, damping=damping)))
    m = scene.can.mass
    rest, amplitude = m * 9.81 / k, 0.3
    world, touching = world_of(scene, name, timestep), balanced(scene, 0.0).position[2]
    world.place(
        balanced(scene, (1.0 + amplitude) * rest),
        Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3)),
    )
    loss, rate = damping / (2.0 * m), math.sqrt(k / m - (damping / (2.0 * m)) ** 2)
    steps = round(2.0 * math.pi / rate / timestep)  # a period
    depths = []
    for _ in range(steps):
        world.step()
        depths.append(touching - world.pose().position[2])
    t = timestep * np.arange(1, steps + 1)
    swing = np.exp(-loss * t) * (np.cos(rate * t) + loss / rate * np.sin(rate * t))
    # first order: PyBullet's spring damps by k dt/(2 m) = 0.23/s besides, 2e-3 in this period
    np.testing.assert_allclose(
        np.array(depths) / rest, 1.0 + amplitude * swing, atol=5e-3 * amplitude
    )


@pytest.mark.parametrize("coefficient", [0.0, 0.4, 1.0])
@pytest.mark.parametrize(("name", "missed"), [("mujoco", 1.2e-3), ("pybullet", 0.0)])
def test_an_impact_gives_back_its_share(
    gentle: Scene, coefficient: float, name: str, missed: float
) -> None:
    scene = replace(gentle, effects=Effects(restitution=Restitution(coefficient=coefficient)))
    world = world_of(scene, name, 1e-5)
    world.place(balanced(scene, -2e-3), Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3)))
    speeds = []
    for _ in range(2400):
        world.step()
        speeds.append(float(world.twist().velocity[2]))
    falling = min(speeds)
    assert falling == pytest.approx(-math.sqrt(2.0 * 9.81 * 2e-3), rel=1e-3)  # within a step
    impact = speeds.index(falling) + 1
    # gravity takes g dt = 1e-4 m/s within the step
    assert speeds[impact] == pytest.approx(-coefficient * falling, abs=2e-4 - missed * falling)


@pytest.mark.parametrize(
    ("key", "effect", "able"),
    [
        ("rim", RoundedRim(radius=1e-3), {"pybullet", "reference"}),
        ("restitution.law", Restitution(coefficient=0.5, law="poisson"), {"reference"}),
    ],
)
def test_what_mujoco_has_no_law_for_is_refused_with_the_engines_that_do(
    gentle: Scene, key: str, effect: RoundedRim | Restitution, able: set[str]
) -> None:
    declared: dict[str, Any] = {key.partition(".")[0]: effect}
    scene = replace(gentle, effects=Effects(**declared))
    with pytest.raises(UnsupportedEffectError) as caught:
        check_effects("mujoco", scene)
    assert (caught.value.engine, caught.value.effect) == ("mujoco", key)
    assert set(caught.value.able) == able - set(absent_engines())


def same_bits(first: Trajectory | None, second: Trajectory | None) -> bool:
    """Whether two trajectories hold the same bits; NaN is NaN."""
    assert first is not None
    assert second is not None
    pairs = [(getattr(first, f.name), getattr(second, f.name)) for f in fields(Trajectory)]
    return all(
        a.shape == b.shape and (a.tobytes() == b.tobytes() or np.array_equal(a, b))
        for a, b in pairs
    )


@pytest.mark.parametrize(
    "scene", [name for name in names() if not missing_effects("mujoco", load(name))]
)
def test_the_stages_that_mujoco_leaves_out_change_no_bit(scene: str) -> None:
    brief = replace(load(scene), horizon=Horizon(seconds=0.1))
    lean = run(brief, "mujoco", 1e-3)
    shipped = run(brief, "mujoco", 1e-3, build="shipped")
    assert lean.settings["build"] == "lean"
    assert same_bits(lean.trajectory, shipped.trajectory)
    everything = run(brief, "mujoco", 1e-3, build="everything")
    assert everything.outcome is lean.outcome is Outcome.FINISHED
    assert lean.trajectory is not None
    assert everything.trajectory is not None
    # a damping of 1e-30 has MuJoCo solve for the velocities another way: round-off, as it grows
    # in a hundred steps
    np.testing.assert_allclose(
        everything.trajectory.position, lean.trajectory.position, rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("profile", ["default", "adaptive"])
@pytest.mark.parametrize(("name", "effect"), honoured(DECLARED))
def test_every_profile_runs_every_effect_that_is_honoured(
    gentle: Scene, name: str, effect: str, profile: str
) -> None:
    scene = replace(gentle, effects=DECLARED[effect], horizon=Horizon(seconds=0.02))
    found = engine(name).simulate(Case(scene=scene, engine=name, profile=profile))
    assert found.outcome is Outcome.FINISHED
