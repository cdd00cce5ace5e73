"""DART: what it ships with, its own laws, its faults, and settings to paste."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome, Simulation
from harness.engines.can_mesh import mesh_points, prism
from harness.engines.parity.contact import Stand
from harness.engines.probes import PROBES
from harness.engines.probes.rim_contact import collision, turns
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import UP, X, Y, lowered, moving
from models import Effects, Horizon, PointMass, Release, Restitution, Scene, Slip, load, quaternion
from models.kinematics import to_world
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("dart")

DANTZIG = {"boxedLcpSolver": "DantzigBoxedLcpSolver"}
FCL = {"collisionDetector": "FCLCollisionDetector"}
MESH = {**FCL, "primitiveShapeType": "MESH"}


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of DART."""
    return Case(scene=scene, engine="dart", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "error"),
    [(1e-3, -0.259), (1e-4, 0.025), pytest.param(1e-5, -0.0002, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, timestep: float, error: float
) -> None:
    # the same to every digit that was written down, whatever the machine
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, abs=6e-4)


def test_the_paper_release_turns_with_adaptive_steps_and_not_with_contacts_of_fcl() -> None:
    case = replace(case_of(load("paper-release")), profile="adaptive")
    assert abs(turn_error(case)) < 0.03
    # below 4.5e-4 rad FCL puts the contact at the middle of the base, and there the can turns
    assert abs(turn_error(replace(case, options=tuple(FCL.items())))) > 10.0


@pytest.mark.parametrize(("phi", "radii"), [(1e-3, 1.0), (1e-5, 0.0)])
def test_fcl_puts_the_contact_of_a_nearly_flat_can_in_the_middle(
    gentle: Scene, phi: float, radii: float
) -> None:
    scene = replace(gentle, release=Release(phi=phi))
    for options, expected in ((FCL, radii), ({}, 1.0)):
        world = stepping_engine("dart").open(case_of(scene, 1e-4, **options))
        stand = Stand(world, scene, 1e-4)
        height = scene.can.radius * math.sin(phi) + scene.can.half_height * math.cos(phi)
        pose = lowered(stand.touching, stand.touching.position[2] - height + 2e-6)
        world.place(replace(pose, quaternion=quaternion(phi, 0.0, 0.0)), moving())
        world.step()
        reach = float(np.hypot(*world.contact().point[:2])) / scene.can.radius
        assert reach == pytest.approx(expected, abs=2e-3)


def test_what_it_ships_with_is_what_is_stated() -> None:
    import dartpy  # noqa: PLC0415 - may not be installed

    world = dartpy.simulation.World()
    solver, cone = world.getConstraintSolver(), dartpy.constraint.NsgsFrictionSolver().getOptions()
    stated = {setting.name: setting.default for setting in engine("dart").settings}
    assert type(solver.getCollisionDetector()).__name__ == stated["collisionDetector"]
    assert type(solver.getBoxedLcpSolver()).__name__ == stated["boxedLcpSolver"]
    assert solver.isSplitImpulseEnabled() is stated["splitImpulseEnabled"]
    assert world.getDeactivationOptions().mEnabled is stated["deactivation"]
    assert (cone.tolerance, cone.maxSweeps) == (stated["tolerance"], stated["maxSweeps"])
    assert cone.law.name == stated["law"]
    fbf = dartpy.constraint.FbfFrictionSolver().getOptions()
    assert (fbf.tolerance, fbf.maxOuterIterations) == (stated["tolerance"], stated["maxSweeps"])
    shipped = Case(scene=load("gentle-rock"), engine="dart", profile="default")
    assert world.getTimeStep() == engine("dart").timestep(shipped)


@pytest.mark.parametrize(
    "variant",
    () if "dart" in not_installed() else (*variants("dart"), "Fbf", "mesh"),
    ids=lambda variant: getattr(variant, "name", variant),
)
def test_what_is_pasted_runs_and_means_the_case(variant: Any) -> None:
    import dartpy  # noqa: PLC0415 - may not be installed

    named = {"Fbf": (("boxedLcpSolver", "FbfFrictionSolver"),), "mesh": tuple(MESH.items())}
    profile, settings = "matched", named.get(variant)
    if settings is None:
        profile, settings = variant.profile, variant.settings
    case = replace(case_of(load("gentle-rock"), 2.0**-12), profile=profile, options=settings)
    chosen = stepping_engine("dart").resolve(case)
    world = dartpy.simulation.World()
    exec(compile(export_settings(case), "pasted", "exec"), {"world": world})  # noqa: S102 - a user would
    solver = world.getConstraintSolver()
    assert world.getTimeStep() == 2.0**-12
    assert type(solver.getCollisionDetector()).__name__ == chosen["collisionDetector"]
    if chosen["collisionDetector"] in FCL.values():
        kind = solver.getCollisionDetector().getPrimitiveShapeType()
        assert kind.name == chosen["primitiveShapeType"]
    assert type(solver.getBoxedLcpSolver()).__name__ == chosen["boxedLcpSolver"]
    assert solver.isSplitImpulseEnabled() is chosen["splitImpulseEnabled"]
    assert world.getDeactivationOptions().mEnabled is chosen["deactivation"]
    if chosen["boxedLcpSolver"] != DANTZIG["boxedLcpSolver"]:
        options = solver.getBoxedLcpSolver().getOptions()
        assert options.tolerance == chosen["tolerance"]
        most = getattr(options, "maxSweeps", None) or options.maxOuterIterations
        assert most == chosen["maxSweeps"]


def test_the_mesh_of_fcl_is_a_prism_of_16_sides_and_parity_says_so(gentle: Scene) -> None:
    case, can = case_of(gentle, 1e-3, **MESH), gentle.can
    world, corners = stepping_engine("dart").open(case), mesh_points(prism(16), can)
    counts = set()
    for stance in turns(0.3, [2e-3 * can.radius]):
        pose, _ = stance.put(can)
        world.place(pose, moving())
        lowest = (pose.position + to_world(pose.quaternion, corners))[:, 2].min()
        found = collision(world)
        counts.add(len(found.depths))
        assert found.depths.max(initial=0.0) == pytest.approx(max(-lowest, 0.0), abs=1e-9)
    assert counts >= {0, 1}
    rows = {row.quantity: row for row in stepping_engine("dart").parity(case)}
    assert rows["rim deviation"].verdict == "imposed"


def test_a_mesh_of_another_detector_is_refused(
    gentle: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(InvalidSettingError, match="PRIMITIVE with OdeCollisionDetector"):
        stepping_engine("dart").open(
            case_of(gentle, None, **(MESH | {"collisionDetector": "OdeCollisionDetector"}))
        )
    stepping_engine("dart").open(case_of(gentle, None, **MESH))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("timestep", [1e-3, 1e-4])
def test_a_hundredth_of_an_overlap_is_taken_away_in_a_step_at_a_millimetre_a_second(
    gentle: Scene, timestep: float
) -> None:
    found = {
        quantity: value
        for quantity, _, value, _, _ in PROBES["stabilisation"](
            stepping_engine("dart"),
            case_of(gentle, timestep),
        )
    }
    for share in (1e-5, 1e-4, 1e-3):
        law = min(0.01 * share * gentle.can.radius / timestep, 1e-3)
        speed = found[f"speed from an overlap of {share:g} R"]
        assert speed == pytest.approx(law, rel=1e-4)  # yields by 1e-5 of its mobility


def test_the_contact_sinks_until_both_of_its_constants_balance(gentle: Scene) -> None:
    for timestep in (1e-3, 1e-4):
        probed = PROBES["compliance"](stepping_engine("dart"), case_of(gentle, timestep))
        found = {quantity: value for quantity, _, value, _, _ in probed}
        # 0.01 d/dt out of the plane, 1e-5 g dt into it
        law = 1e-3 * gentle.gravity * timestep**2
        assert found["static penetration under its weight"] == pytest.approx(law, rel=1e-3)


def slid(scene: Scene, angle: float, **options: Value) -> tuple[float, float]:
    """Return the friction over the normal force of a sliding can, and how far it is astray, rad."""
    case = case_of(replace(scene, effects=Effects(slip=Slip(mu=0.3))), 1e-4, **options)
    stand = Stand(stepping_engine("dart").open(case), case.scene, 1e-4)
    way = math.cos(angle) * X + math.sin(angle) * Y
    force = stand.press(1e-6, moving(10.0 * way)).force
    across = float(np.hypot(force[0], force[1]))
    return across / float(force[2]), math.acos(-float(force @ way) / across)


def test_friction_is_a_cone_when_matched_and_two_directions_as_shipped(gentle: Scene) -> None:
    for angle in (0.2, 0.4, math.pi / 4.0):
        ratio, astray = slid(gentle, angle)
        assert ratio == pytest.approx(0.3, rel=1e-9)
        assert astray < 1e-5  # an arc cosine near 1
    ratio, astray = slid(gentle, 0.2, **DANTZIG)
    assert ratio == pytest.approx(0.3 * math.sqrt(2.0), rel=1e-6)
    assert math.degrees(astray) == pytest.approx(45.0 - math.degrees(0.2), abs=0.1)


@pytest.mark.parametrize(("speed", "share"), [(0.1, 0.0), (0.19, 0.0), (0.21, 0.5), (10.0, 0.5)])
def test_an_impact_that_would_give_back_less_than_a_tenth_gives_back_nothing(
    gentle: Scene, speed: float, share: float
) -> None:
    declared = Effects(restitution=Restitution(coefficient=0.5))
    case = case_of(replace(gentle, effects=declared, gravity=0.0), 1e-4)
    world = stepping_engine("dart").open(case)
    stand = Stand(world, case.scene, 1e-4)
    world.place(lowered(stand.touching, -2.5e-4 * speed), moving(-speed * UP))
    for _ in range(4):
        world.step()
    rebound = float(world.twist().velocity[2])
    # what is not given back leaves an overlap, which a hundredth of a step takes away
    assert rebound / speed == pytest.approx(share, abs=0.01)


def test_damping_and_a_point_mass_are_carried_together(gentle: Scene) -> None:
    effects = Effects(
        point_mass=PointMass(mass=4e-3, x=0.02), damping=load("gentle-rock").effects.damping
    )
    scene = replace(gentle, effects=effects)
    rows = stepping_engine("dart").parity(case_of(scene, 1e-4))
    assert {row.verdict for row in rows} == {"equal"}


def run(scene: Scene, profile: str, seconds: float, **options: Value) -> Simulation:
    """Return a run of some seconds."""
    timed = replace(scene, horizon=Horizon(seconds=seconds))
    return engine("dart").simulate(replace(case_of(timed, 1e-3, **options), profile=profile))


def test_a_can_at_rest_falls_asleep_as_shipped_and_wakes_where_it_is_placed(gentle: Scene) -> None:
    balanced = replace(gentle, release=Release(phi=gentle.can.balancing_angle + 1e-9))
    for profile, still in (("default", True), ("matched", False)):
        path = run(balanced, profile, 1.0).trajectory
        assert path is not None
        assert bool((path.position[-1] == path.position[-20]).all()) is still
    assert run(gentle, "default", 0.02).outcome is Outcome.FINISHED


def test_numbers_that_break_end_a_run_and_print_nothing(
    gentle: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    violent = replace(gentle.release, phi=1.0, theta_dot=1e12, psi_dot=1e12)
    found = run(replace(gentle, release=violent), "matched", 0.05)
    assert found.outcome in {Outcome.DIVERGED, Outcome.OVERTURNED}
    world = stepping_engine("dart").open(case_of(gentle, 1e-3))
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", "")
    assert world.timestep == 1e-3


def test_iterations_are_counted_by_solvers_of_the_cone_alone(gentle: Scene) -> None:
    chosen: Any = stepping_engine("dart")
    for options, counted in (({}, True), (DANTZIG, False)):
        case = case_of(gentle, 1e-4, **options)
        world = chosen.open(case)
        stand = Stand(world, gentle, 1e-4)
        world.place(lowered(stand.touching, 1e-6), moving())
        assert (chosen.counted_step(world) > 0) is counted
