"""The probes of real engines against the closed forms of their own laws."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.probes import PROBES, measure
from harness.engines.probes.flight import DURATION, SPIN
from harness.engines.registry import engine
from harness.execution.isolated_pool import local_executor
from models import Scene, load
from tests.support.engines import stepping_engine

Values = dict[str, float]


@pytest.fixture(scope="module")
def probe() -> Callable[..., Values]:
    """Return a function that runs one probe of an engine and returns its findings by quantity."""
    known: dict[tuple[str, Case], Values] = {}

    def run(
        effect: str, name: str, profile: str = "matched", timestep: float = 1e-3, **options: Value
    ) -> Values:
        case = Case(
            scene=load("gentle-rock"),
            engine=name,
            profile=profile,
            timestep=timestep,
            options=tuple(options.items()),
        )
        if (effect, case) not in known:
            found = PROBES[effect](stepping_engine(name), case)
            known[effect, case] = {quantity: value for quantity, _, value, _, _ in found}
        return known[effect, case]

    return run


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Return the scene whose can is probed."""
    return load("gentle-rock")


@pytest.mark.parametrize("timestep", [1e-3, 1e-4])
def test_mujoco_sinks_by_its_own_law(
    probe: Callable[..., Values], scene: Scene, timestep: float
) -> None:
    found = probe("compliance", "mujoco", timestep=timestep)
    # constant impedance d: the contact bears the weight at a depth of (1 - d) tc^2 g, tc = 2 dt
    depth = (1.0 - 0.9) * (2.0 * timestep) ** 2 * scene.gravity
    can = scene.can
    # the depth is searched to 1e-6 of a bracket four times as wide; the law neglects the square of
    # the rotation within a step
    assert found["static penetration under its weight"] == pytest.approx(depth, rel=1e-3)
    per_load = depth / (can.mass * scene.gravity)
    assert found["depth for a load"] == pytest.approx(per_load, rel=1e-3)
    assert found["mean load borne over the weight"] == pytest.approx(1.0, rel=1e-3)


def test_mujoco_as_it_ships_sinks_by_millimetres(probe: Callable[..., Values]) -> None:
    found = probe("compliance", "mujoco", "default", timestep=0.002)
    # (1 - d) tc^2 g/d^2.. with tc = 20 ms is 0.4 mm at least, and impedance falls at small depths
    assert 4e-4 < found["static penetration under its weight"] < 4e-3


def test_creep_goes_with_the_inverse_of_impratio(probe: Callable[..., Values]) -> None:
    # ten times the hardness of friction is a tenth of the creep, but for a floor of the first order
    # that does not depend on impratio: 2 % of the harder one
    soft, hard = (
        probe("friction compliance", "mujoco", impratio=ratio)["creep over the force"]
        for ratio in (1.0, 10.0)
    )
    assert soft / hard == pytest.approx(10.0, rel=0.05)


def test_pybullet_does_not_creep(probe: Callable[..., Values]) -> None:
    # up to the residual at which its solver stops, 1e-7 m/s
    assert probe("friction compliance", "pybullet")["creep of the rim"] < 1e-7


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_the_friction_is_that_of_a_pendulum(probe: Callable[..., Values], name: str) -> None:
    # the error of the first order at 1e-4 s, of a motion that takes 60 ms
    found = probe("friction compliance", name, timestep=1e-4)
    assert abs(found["error of the friction over the closed form"]) < 1e-4


@pytest.mark.parametrize("margin", [0.001, 0.003])
def test_a_margin_is_the_fillet_of_the_rim(probe: Callable[..., Values], margin: float) -> None:
    found = probe("rim", "pybullet", collisionMargin=margin)
    assert found["fillet radius"] == pytest.approx(margin, rel=1e-9)
    assert abs(found["swell beyond the declared size"]) < 1e-12
    assert found["sides of the rim; 0 is round"] == 0.0


@pytest.mark.parametrize("rate", [0.04, 0.5])
def test_damping_is_what_was_set(probe: Callable[..., Values], rate: float) -> None:
    found = probe("damping", "pybullet", linearDamping=rate, angularDamping=rate)
    for quantity in ("linear damping of velocity", "linear damping of spin"):
        # a rate is known to 1e-13 1/s at 1e-3 s, and the fit takes the difference of four
        assert found[quantity] == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize("clamp", [100.0, 700.0])
def test_the_clamp_is_what_was_set(probe: Callable[..., Values], clamp: float) -> None:
    found = probe("velocity clamp", "pybullet", maxJointVelocity=clamp)
    assert found["greatest velocity left by a step"] == clamp
    assert found["greatest spin left by a step"] == clamp


def test_pybullet_turns_exactly_up_to_an_eighth(probe: Callable[..., Values]) -> None:
    found = probe("orientation update", "pybullet")
    # past pi/4 the half angle is cut but its axis is not: 2 atan(x tan(pi/8)/(pi/4)) for x rad
    cut = 2.0 * math.atan(3.0 * math.tan(math.pi / 8.0) / (math.pi / 4.0))
    assert found["turn of the orientation in a step"] == pytest.approx(cut, rel=1e-9)
    assert found["largest turn in a step that is exact"] == pytest.approx(0.7, rel=1e-12, abs=0)


def test_mujoco_turns_exactly(probe: Callable[..., Values]) -> None:
    found = probe("orientation update", "mujoco")
    assert found["largest turn in a step that is exact"] == pytest.approx(3.0, rel=1e-9)


def gained(scene: Scene, timestep: float) -> float:
    """Return what an explicit gyroscopic term gains: |w|^2 grows at the rate k^2 dt."""
    can, T = scene.can, math.sqrt(scene.can.radius / scene.gravity)
    A, C = can.transverse_inertia, can.axial_inertia
    wobble, spin = SPIN[0] / T, SPIN[2] / T
    k = spin * (A - C) / A
    growth = math.exp(k**2 * timestep * DURATION * T) - 1.0
    share: float = A * wobble**2 / (A * wobble**2 + C * spin**2)
    return share * growth


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "quantity", "sign"),
    [
        ("mujoco", "energy gained", 1.0),
        ("mujoco", "energy gained with integrator=implicit", -1.0),
        ("mujoco", "energy gained with integrator=implicitfast", -1.0),
        ("pybullet", "energy gained", 1.0),
        ("pybullet", "energy gained with useMaximalCoordinates=True", -1.0),
    ],
)
def test_explicit_gyroscopic_terms_gain_and_implicit_ones_lose(
    probe: Callable[..., Values], scene: Scene, name: str, quantity: str, sign: float
) -> None:
    found = probe("gyroscopic term", name, timestep=1e-4)[quantity]
    # next in the series is (k dt)^2, 2e-7; the spin feeds back on the wobble's rate with their
    # ratio squared, 0.02
    assert found == pytest.approx(sign * gained(scene, 1e-4), rel=0.03)


@pytest.mark.slow
def test_runge_kutta_keeps_the_energy(probe: Callable[..., Values]) -> None:
    # fourth order: (k dt)^4 a radian, 1e-15 at 1e-4 s
    found = probe("gyroscopic term", "mujoco", timestep=1e-4)
    assert abs(found["energy gained with integrator=RK4"]) < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_the_gain_goes_with_the_timestep(probe: Callable[..., Values], name: str) -> None:
    coarse, fine = (
        probe("gyroscopic term", name, timestep=dt)["energy gained"] for dt in (2e-4, 1e-4)
    )
    assert coarse / fine == pytest.approx(2.0, rel=0.01)  # the growth itself is half a percent


@pytest.mark.slow
def test_damping_does_not_pass_for_the_gyroscopic_term(probe: Callable[..., Values]) -> None:
    plain = probe("gyroscopic term", "pybullet", timestep=1e-4)["energy gained"]
    damped = probe("gyroscopic term", "pybullet", timestep=1e-4, angularDamping=0.005)
    # 0.005 (1 + |omega|) a second takes a fifth of the spin within the flight and a third of the
    # energy, and of the term as much as goes with the square of the spin on the way
    assert 0.6 * plain < damped["energy gained"] < plain


@pytest.mark.parametrize("erp", [0.2, 0.8])
def test_an_overlap_leaves_at_the_speed_that_erp_says(
    probe: Callable[..., Values], scene: Scene, erp: float
) -> None:
    found = probe("stabilisation", "pybullet", contactERP=erp)
    # the touching point gets erp overlap/dt, and the balanced can does so as a whole
    speed = erp * 1e-3 * scene.can.radius / 1e-3
    assert found["speed from an overlap of 0.001 R"] == pytest.approx(speed, rel=1e-6)


def test_mujoco_touches_in_several_points_by_the_depth_of_its_contact(
    probe: Callable[..., Values], scene: Scene
) -> None:
    found = probe("contact points", "mujoco", timestep=1e-4)
    depth = 0.1 * 4e-8 * scene.gravity  # at most: the can bears a part of its weight when it tips
    threshold = found["tilt below which several points bear the load"]
    # three points once those 120 degrees off are inside: tilt (3/2) R < depth
    assert 0.2 * depth / (1.5 * scene.can.radius) < threshold
    assert threshold < 1.2 * depth / (1.5 * scene.can.radius)


@pytest.mark.slow
def test_a_round_rim_in_pybullet_touches_in_one_point(probe: Callable[..., Values]) -> None:
    found = probe("contact points", "pybullet", timestep=1e-3)
    assert found["tilt below which several points bear the load"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_a_measurement_travels_and_repeats(scene: Scene, name: str) -> None:
    case = Case(scene=scene, engine=name, timestep=1e-3)
    here = measure(case)
    with local_executor(2) as executor:
        there = executor.submit(measure, case).result()
    assert there.findings == here.findings
    assert there.engine_version == engine(name).version


@pytest.mark.slow
def test_every_effect_has_a_finding(scene: Scene) -> None:
    measurement = measure(Case(scene=scene, engine="mujoco", timestep=1e-3))
    # the declared softness is asked for where a scene declares one
    asked = [name for name in PROBES if name != "declared compliance"]
    assert asked == list(dict.fromkeys(f.effect for f in measurement.findings))
    quantities = [(f.effect, f.quantity) for f in measurement.findings]
    assert len(set(quantities)) == len(quantities)


@pytest.mark.slow
def test_adaptive_is_probed_at_its_largest_timestep(scene: Scene) -> None:
    adaptive = measure(Case(scene=scene, engine="mujoco", profile="adaptive"))
    matched = measure(Case(scene=scene, engine="mujoco", timestep=adaptive.timestep))
    # the settings of both profiles are the same ones, and so is every number but that of a run
    one, other = (
        [f for f in each.findings if f.effect != "heading"] for each in (adaptive, matched)
    )
    assert one == other


def test_without_gravity_there_is_no_load(scene: Scene) -> None:
    case = Case(scene=replace(scene, gravity=0.0), engine="mujoco")
    with pytest.raises(InvalidSettingError) as caught:
        measure(case)
    assert (caught.value.name, caught.value.value) == ("gravity", 0.0)
