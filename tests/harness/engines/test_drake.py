"""Drake, discrete: what it ships with, its contact laws, its faults, and settings to paste."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome
from harness.engines.base import features_of
from harness.engines.parity.checks import parity
from harness.engines.parity.contact import Stand
from harness.engines.probes.rim_contact import Stance, answers, collision, turns
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import X, lowered, moving, touching_pose
from models import (
    Effects,
    InvalidValueError,
    PointMass,
    Release,
    Scene,
    Slip,
    load,
    quaternion,
    to_body,
)
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("drake")

HALF_SPACE = {"ground": "HalfSpace"}
AS_SHIPPED = {"point_stiffness": 1e6, "hunt_crossley_dissipation": 50.0}


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of Drake."""
    return Case(scene=scene, engine="drake", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "error"),
    [
        (1e-3, 0.1720),
        pytest.param(1e-4, -0.0109, marks=pytest.mark.slow),
        pytest.param(1e-5, -0.0014, marks=pytest.mark.slow),
    ],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, timestep: float, error: float
) -> None:
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, abs=6e-4)


@pytest.mark.slow
def test_the_paper_release_turns_with_adaptive_steps_and_not_on_a_half_space() -> None:
    case = replace(case_of(load("paper-release")), profile="adaptive")
    assert abs(turn_error(case)) < 0.03
    assert abs(turn_error(replace(case, options=tuple(HALF_SPACE.items())))) > 10.0


@pytest.mark.parametrize(("phi", "radii"), [(5e-4, 1.0), (4e-4, 0.0)])
def test_a_half_space_puts_the_contact_of_a_nearly_flat_can_in_the_middle(
    gentle: Scene, phi: float, radii: float
) -> None:
    for options, expected in ((HALF_SPACE, radii), ({}, 1.0)):
        world = stepping_engine("drake").open(case_of(gentle, 1e-4, **options))
        can = gentle.can
        height = can.radius * math.sin(phi) + can.half_height * math.cos(phi) - 20e-6
        pose = replace(touching_pose(world, can, 0.1), quaternion=quaternion(phi, 0.0, 0.0))
        world.place(replace(pose, position=np.array((0.0, 0.0, height))), moving())
        world.step()
        reach = float(np.hypot(*world.contact().point[:2])) / can.radius
        assert reach == pytest.approx(expected, abs=2e-3)


def test_what_it_ships_with_is_what_is_stated() -> None:
    from pydrake.geometry import SceneGraphConfig  # noqa: PLC0415 - may not be installed
    from pydrake.multibody.plant import MultibodyPlantConfig  # noqa: PLC0415

    stated = {setting.name: setting.default for setting in engine("drake").settings}
    plant, material = MultibodyPlantConfig(), SceneGraphConfig().default_proximity_properties
    for name in (
        "discrete_contact_approximation",
        "sap_near_rigid_threshold",
        "stiction_tolerance",
    ):
        assert getattr(plant, name) == stated[name]
    for name in (
        *("point_stiffness", "hunt_crossley_dissipation", "relaxation_time", "compliance_type"),
        *("hydroelastic_modulus", "resolution_hint"),
    ):
        assert getattr(material, name) == stated[name]
    shipped = Case(scene=load("gentle-rock"), engine="drake", profile="default")
    assert plant.time_step == engine("drake").timestep(shipped)


@pytest.mark.parametrize(
    "variant",
    ()
    if "drake" in not_installed()
    else (*variants("drake"), *features_of(engine("drake")).colliders),
    ids=lambda each: each.name,
)
def test_what_is_pasted_runs_and_means_the_case(variant: Any) -> None:
    case = replace(
        case_of(load("gentle-rock"), 2.0**-12), profile=variant.profile, options=variant.settings
    )
    chosen, names = stepping_engine("drake").resolve(case), dict[str, Any]()
    exec(compile(export_settings(case), "pasted", "exec"), names)  # noqa: S102 - a user would
    names["plant"].Finalize()
    assert names["plant"].time_step() == 2.0**-12
    approximation = names["plant"].get_discrete_contact_approximation().name.lower()
    assert approximation.removeprefix("k") == chosen["discrete_contact_approximation"]
    for name in ("sap_near_rigid_threshold", "stiction_tolerance"):
        assert getattr(names["config"], name) == chosen[name]
    assert type(names["ground"]).__name__ == chosen["ground"]
    by_surface = chosen["compliance_type"] == "compliant"
    assert names["config"].contact_model == ("hydroelastic" if by_surface else "point")
    if by_surface:
        modulus = names["of_can"].GetProperty("hydroelastic", "hydroelastic_modulus")
        assert modulus == chosen["hydroelastic_modulus"]
        hint = names["of_can"].GetProperty("hydroelastic", "resolution_hint")
        assert hint == chosen["resolution_hint"]
        assert names["of_ground"].HasProperty("hydroelastic", "compliance_type")
    properties = names["material"]()
    for name in ("point_contact_stiffness", "hunt_crossley_dissipation", "relaxation_time"):
        setting = name.replace("_contact", "")
        assert properties.GetProperty("material", name) == chosen[setting]


@pytest.mark.parametrize("tilt", [1e-4, 1e-2, 0.3])
def test_the_force_of_a_surface_acts_at_its_centre_of_pressure(gentle: Scene, tilt: float) -> None:
    timestep = 1e-6
    case = case_of(gentle, timestep, compliance_type="compliant", resolution_hint=2e-3)
    world, can = stepping_engine("drake").open(case), gentle.can
    stance = Stance(tilt=tilt, heading=0.3, spin=1.3, upside_down=False, depth=1e-3 * can.radius)
    pose, lowest = stance.put(can)
    world.place(pose, moving())
    world.step()
    contact, turned = world.contact(), world.twist()
    assert contact.count == 1
    assert contact.penetration == pytest.approx(1e-3 * can.radius, rel=1e-9)
    solved = 1e-6 * float(contact.force[2])  # SAP stops at a relative tolerance of 1e-6
    gained = turned.velocity / timestep + gentle.gravity * np.array((0.0, 0.0, 1.0))
    np.testing.assert_allclose(can.mass * gained, contact.force, atol=solved)
    R_WB = to_body(pose.quaternion, np.eye(3))
    inertia = R_WB @ np.diag(world.inertia) @ R_WB.T
    moment = np.cross(contact.point - pose.position, contact.force)
    level = (inertia @ turned.angular_velocity / timestep)[:2]  # a surface drills as well
    np.testing.assert_allclose(level, moment[:2], atol=solved * can.radius)
    # of a surface: half a side of the polygon off, and of a can that is nearly flat the whole base
    off = can.radius if math.sin(tilt) < 2e-2 else 0.1 * can.radius
    assert np.hypot(*(contact.point - lowest)[:2]) < 1.1 * off


def test_a_can_of_surfaces_is_a_prism_and_parity_says_so(gentle: Scene) -> None:
    case = case_of(gentle, 1e-3, compliance_type="compliant")
    world, touched = stepping_engine("drake").open(case), set()
    for stance in turns(0.3, [2e-3 * gentle.can.radius]):
        world.place(stance.put(gentle.can)[0], moving())
        touched.add(touches := len(collision(world).points) > 0)
        assert touches == (world.signed_distance() < 0.0)
    assert touched == {True, False}
    rows = {row.quantity: row for row in stepping_engine("drake").parity(case)}
    assert rows["rim deviation"].verdict == "imposed"
    assert rows["rim deviation"].found > 1e-4


def test_a_mesh_that_is_too_fine_is_refused(gentle: Scene) -> None:
    with pytest.raises(InvalidSettingError, match=r"3\.7e-05 m or more"):
        stepping_engine("drake").open(
            case_of(gentle, compliance_type="compliant", resolution_hint=1e-6)
        )


def test_a_finer_polygon_touches_where_a_coarse_one_is_above_the_ground(gentle: Scene) -> None:
    def touches(hint: float) -> list[int]:
        chosen: dict[str, Value] = {"compliance_type": "compliant", "resolution_hint": hint}
        world = stepping_engine("drake").open(case_of(gentle, 1e-3, **chosen))
        stances = turns(0.3, [1e-3 * gentle.can.radius])
        return [answer.count for answer in answers(world, gentle.can, list(stances))]

    assert 0 in touches(0.02)
    assert set(touches(2e-3)) == {1}


SLIPPERY = Effects(slip=Slip(mu=0.3))


def slide(scene: Scene, timestep: float, **options: Value) -> tuple[float, float]:
    """Return force ratio and rise (m/s) after the first step in which a sliding can is borne."""
    case = case_of(replace(scene, effects=SLIPPERY), timestep, **options)
    world = stepping_engine("drake").open(case)
    stand = Stand(world, case.scene, timestep)
    for contact in stand.pressed(0.0, moving(5.0 * X)):
        if contact.force[2] > 0.0:
            after = world.twist()
            rise = (after.velocity + np.cross(after.angular_velocity, stand.offset))[2]
            return math.hypot(contact.force[0], contact.force[1]) / contact.force[2], float(rise)
    raise AssertionError


def test_lagged_takes_friction_from_the_load_of_the_step_before(gentle: Scene) -> None:
    ratios = {
        each: slide(gentle, 1e-3, discrete_contact_approximation=each, point_stiffness=1e6)[0]
        for each in ("lagged", "sap", "similar")
    }
    assert abs(ratios["lagged"] / 0.3 - 1.0) > 0.5  # the load before was that of round-off
    assert ratios["sap"] == pytest.approx(0.3, rel=1e-6)
    assert ratios["similar"] == pytest.approx(0.3, rel=1e-6)


def test_sap_lifts_what_slides_at_any_timestep(gentle: Scene) -> None:
    def rise(timestep: float, approximation: str, stiffness: float) -> float:
        chosen: dict[str, Value] = {"discrete_contact_approximation": approximation}
        return slide(gentle, timestep, **chosen, point_stiffness=stiffness)[1]

    coarse, fine = rise(1e-4, "sap", 1e15), rise(1e-5, "sap", 1e15)
    # of mu times the speed, the share that this can takes where it is balanced
    assert coarse == pytest.approx(0.65 * 0.3 * 5.0, rel=0.01)
    assert fine == pytest.approx(coarse, rel=0.01)
    # `similar` does so where the timestep is long for the spring
    assert rise(1e-3, "similar", 1e6) == pytest.approx(coarse, rel=0.05)
    assert rise(1e-5, "similar", 1e6) < 0.15 * fine
    assert rise(1e-5, "lagged", 1e6) < 0.0


def test_friction_that_lags_passes_where_it_is_right_and_no_other(gentle: Scene) -> None:
    lagged: dict[str, Value] = {"discrete_contact_approximation": "lagged", **AS_SHIPPED}
    scene = replace(gentle, effects=SLIPPERY)
    for declared, verdict in ((0.3, "equal"), (0.31, "mismatch")):
        case = case_of(scene, 1e-3, **lagged)
        world = stepping_engine("drake").open(case)
        asked = replace(scene, effects=Effects(slip=Slip(mu=declared)))
        rows = {row.quantity: row for row in parity(world, asked, 1e-3, {})}
        assert rows["friction of the pair"].verdict == verdict


def test_damping_and_a_point_mass_are_carried_together(gentle: Scene) -> None:
    effects = replace(load("gentle-rock").effects, point_mass=PointMass(mass=4e-3, x=0.02))
    rows = stepping_engine("drake").parity(case_of(replace(gentle, effects=effects), 1e-4))
    assert {row.verdict for row in rows} == {"equal"}


def test_the_state_goes_from_one_timestep_to_the_next(gentle: Scene) -> None:
    world = stepping_engine("drake").open(case_of(gentle, 1e-3))
    pose = lowered(Stand(world, gentle, 1e-3).touching, 1e-9)
    world.place(pose, moving(X))
    world.set_timestep(2.0**-20)
    assert world.timestep == 2.0**-20
    assert world.pose().position.tolist() == pose.position.tolist()
    assert world.twist().velocity.tolist() == X.tolist()


def test_numbers_that_break_end_a_run_and_print_nothing(
    gentle: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    violent = Release(phi=1.0, theta_dot=1e150, psi_dot=1e150)
    found = engine("drake").simulate(case_of(replace(gentle, release=violent), 1e-3, **HALF_SPACE))
    assert found.outcome in {Outcome.DIVERGED, Outcome.OVERTURNED}
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", "")


def test_a_first_step_that_fails_leaves_no_contact_and_no_numbers(gentle: Scene) -> None:
    world = stepping_engine("drake").open(case_of(gentle, 1e-3))
    pose = lowered(Stand(world, gentle, 1e-3).touching, 1e-3)
    world.place(pose, moving(velocity=1e200 * X))
    world.step()
    assert world.contact().count == 0
    with pytest.raises(InvalidValueError):
        world.pose()
