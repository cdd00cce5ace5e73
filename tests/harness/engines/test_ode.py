"""ODE: the library that it needs, what it ships with, its faults, and settings to paste."""

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.engines.parity.contact import Stand
from harness.engines.probes import PROBES
from harness.engines.probes.impact import rebound
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import UP, X, Y, above_origin, lowered, moving
from models import (
    Compliance,
    Damping,
    Effects,
    Horizon,
    PointMass,
    Release,
    Restitution,
    Scene,
    Slip,
    contact_offset,
    load,
    quaternion,
)
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

needs_ode = pytest.mark.engine("ode")

RIM = {"contacts": "rim"}
QUICK = {"step": "dWorldQuickStep"}


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of ODE."""
    return Case(scene=scene, engine="ode", timestep=timestep, options=tuple(options.items()))


NO_LIBRARY = "class OdePyError(Exception): pass\nraise OdePyError('ODE library not found.')\n"
SINGLE = """\
import os
os.environ["LD_LIBRARY_PATH"] = "/somewhere/else"
print("dSomething is not available for the installed ODE")


def loadOde(name, *kinds):
    return lambda: b"ODE ODE_EXT_trimesh ODE_single_precision"
"""


@pytest.mark.parametrize(
    ("binding", "reason"),
    [(NO_LIBRARY, "ODE library not found."), (SINGLE, "ODE_single_precision")],
    ids=["no library", "single precision"],
)
def test_a_library_that_is_not_there_is_one_sentence_that_says_what_to_install(
    tmp_path: Path, binding: str, reason: str
) -> None:
    (tmp_path / "odepy.py").write_text(binding, encoding="utf-8")

    def said(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(  # noqa: S603 - our own program
            [sys.executable, "-m", "rockingcan", *words],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
        )

    (answer,) = json.loads(said("engines", "ode", "--json").stdout)["engines"]
    assert answer["installed"] is False
    refused = said("run", "gentle-rock", "--engine", "ode")
    assert refused.returncode == 2
    assert refused.stdout == ""
    for text in (answer["message"], " ".join(refused.stderr.split())):
        assert reason in text
        assert "install it with: apt install libode8" in text
        assert "Traceback" not in text


@needs_ode
def test_the_binding_leaves_the_environment_as_it_was() -> None:
    program = (
        "import os; kept = dict(os.environ); import harness.engines.ode.world; "
        "assert dict(os.environ) == kept"
    )
    subprocess.run([sys.executable, "-c", program], check=True)  # noqa: S603 - our own


@needs_ode
def test_the_version_is_that_of_the_library() -> None:
    digits = engine("ode").version.split(".")
    assert len(digits) == 3
    assert all(digit.isdigit() for digit in digits)


@needs_ode
@pytest.mark.parametrize(
    ("timestep", "error"),
    [(1e-3, 0.2079), (1e-4, -0.0088), pytest.param(1e-5, -0.0012, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, timestep: float, error: float
) -> None:
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, abs=6e-4)


@needs_ode
@pytest.mark.slow
def test_the_paper_release_turns_only_with_the_rim_point_given() -> None:
    paper = case_of(load("paper-release"), 1e-6)
    assert abs(turn_error(replace(paper, options=tuple(RIM.items())))) < 0.01
    assert abs(turn_error(paper)) > 5.0


@needs_ode
def test_a_can_that_slides_converges_to_another_motion() -> None:
    slipping = load("slipping-rock")
    coarse, fine = (turn_error(case_of(slipping, timestep)) for timestep in (1e-4, 5e-5))
    assert coarse > 2.0
    assert fine == pytest.approx(coarse, abs=0.02)


def touching(phi: float, depth: float, **options: Value) -> tuple[int, float]:
    """Return how many points bear a can pressed in so deep, and the largest distance of one, R."""
    scene = load("gentle-rock")
    world = stepping_engine("ode").open(case_of(scene, 1e-4, **options))
    can = scene.can
    height = can.radius * math.sin(phi) + can.half_height * math.cos(phi)
    world.place(lowered(above_origin(height, quaternion(phi, 0.7, 0.0)), depth), moving())
    world.step()
    contact = world.contact()
    lowest = contact_offset(can, phi, 0.7)
    return contact.count, float(np.hypot(*(contact.point - lowest)[:2])) / can.radius


@needs_ode
def test_a_nearly_flat_can_is_not_touched_where_its_rim_is_lowest() -> None:
    count, off = touching(4.5e-4, 1e-6)
    assert count == 1
    assert off < 1e-6
    # the middle of the base is 16 micrometres above the lowest point of the rim
    assert touching(4.4e-4, 1.5e-5)[0] == 0
    count, off = touching(4.4e-4, 1.7e-5)
    assert count > 1
    assert off > 0.05
    for depth in (1e-6, 1.7e-5):
        count, off = touching(4.4e-4, depth, **RIM)
        assert count == 1
        assert off < 1e-12


@needs_ode
def test_what_it_ships_with_is_what_is_stated() -> None:
    from harness.engines.ode.library import ode  # noqa: PLC0415 - may not be installed

    world = ode.dWorldCreate()
    body = ode.dBodyCreate(world)
    stated = {setting.name: setting.default for setting in engine("ode").settings}
    for name in ("ERP", "CFM", "ContactSurfaceLayer", "QuickStepNumIterations", "QuickStepW"):
        assert getattr(ode, f"dWorldGet{name}")(world) == pytest.approx(stated[name], rel=1e-15)
    assert ode.dWorldGetContactMaxCorrectingVel(world) == math.inf
    assert stated["ContactMaxCorrectingVel"] is None
    for name in ("GyroscopicMode", "FiniteRotationMode"):
        assert bool(getattr(ode, f"dBodyGet{name}")(body)) is stated[name]
    ode.dWorldDestroy(world)


@needs_ode
@pytest.mark.parametrize(
    "variant",
    () if "ode" in not_installed() else variants("ode"),
    ids=lambda variant: variant.name,
)
def test_what_is_pasted_runs_and_means_the_case(variant: Any) -> None:
    from harness.engines.ode.library import ode  # noqa: PLC0415 - may not be installed

    timestep, options = 2.0**-12, (*variant.settings, ("ContactMaxCorrectingVel", 0.5))
    case = replace(case_of(load("gentle-rock"), timestep), profile=variant.profile, options=options)
    chosen = stepping_engine("ode").resolve(case)
    world = ode.dWorldCreate()
    body, contact = ode.dBodyCreate(world), ode.dContact()
    names: dict[str, Any] = {"world": world, "body": body, "contact": contact}
    exec(compile(export_settings(case), "pasted", "exec"), names)  # noqa: S102 - a user would
    for name in ("ERP", "CFM", "ContactSurfaceLayer", "ContactMaxCorrectingVel"):
        assert getattr(ode, f"dWorldGet{name}")(world) == chosen[name]
    if chosen["step"] == "dWorldQuickStep":
        assert ode.dWorldGetQuickStepNumIterations(world) == chosen["QuickStepNumIterations"]
        assert ode.dWorldGetQuickStepW(world) == chosen["QuickStepW"]
    for name in ("GyroscopicMode", "FiniteRotationMode"):
        assert bool(getattr(ode, f"dBodyGet{name}")(body)) is chosen[name]
    assert contact.surface.mode == (0x7000 if chosen["friction"] == "dContactApprox1" else 0)
    ode.dBodySetLinearVel(body, 1.0, 0.0, 0.0)
    names["step"]()
    assert ode.dBodyGetPosition(body)[0] == pytest.approx(timestep, rel=1e-12)
    ode.dWorldDestroy(world)


def slid(scene: Scene, angle: float, **options: Value) -> tuple[float, float]:
    """Return the friction over the normal force of a sliding can, and how far it is astray, deg."""
    case = case_of(replace(scene, effects=Effects(slip=Slip(mu=0.3))), 1e-4, **options)
    stand = Stand(stepping_engine("ode").open(case), case.scene, 1e-4)
    way = math.cos(angle) * X + math.sin(angle) * Y
    force = stand.press(1e-6, moving(10.0 * way)).force
    across = float(np.hypot(force[0], force[1]))
    return across / float(force[2]), math.degrees(math.acos(min(1.0, -float(force @ way) / across)))


@needs_ode
@pytest.mark.parametrize("options", [{}, QUICK], ids=["direct", "relaxation"])
def test_friction_is_of_two_directions(gentle: Scene, options: dict[str, Value]) -> None:
    ratio, astray = slid(gentle, 0.0, **options)
    assert (ratio, astray) == pytest.approx((0.3, 0.0), abs=1e-6)
    ratio, astray = slid(gentle, 0.2, **options)
    assert ratio == pytest.approx(0.3 * math.sqrt(2.0), rel=1e-6)
    assert astray == pytest.approx(45.0 - math.degrees(0.2), abs=0.1)


@needs_ode
def test_as_shipped_friction_is_a_force(gentle: Scene) -> None:
    for depth in (1e-6, 1e-5):
        case = case_of(gentle, 1e-4, friction="dContactApprox0", ContactSurfaceLayer=0.0)
        stand = Stand(stepping_engine("ode").open(case), gentle, 1e-4)
        force = stand.press(depth, moving(100.0 * X)).force
        assert math.hypot(force[0], force[1]) == pytest.approx(2.0, rel=1e-9)  # N, for a mu of 2


@needs_ode
@pytest.mark.parametrize("timestep", [1e-3, 1e-4])
def test_a_fifth_of_an_overlap_is_taken_away_in_a_step(gentle: Scene, timestep: float) -> None:
    case = case_of(gentle, timestep, ContactSurfaceLayer=0.0)
    probed = PROBES["stabilisation"](stepping_engine("ode"), case)
    found = {quantity: value for quantity, _, value, _, _ in probed}
    for share in (1e-5, 1e-4, 1e-3):
        law = 0.2 * share * gentle.can.radius / timestep
        assert found[f"speed from an overlap of {share:g} R"] == pytest.approx(law, rel=1e-6)


@needs_ode
@pytest.mark.parametrize("speed", [1e-3, 0.1, 10.0])
def test_an_impact_gives_back_what_is_declared(gentle: Scene, speed: float) -> None:
    declared = Effects(restitution=Restitution(coefficient=0.5))
    case = case_of(replace(gentle, effects=declared, gravity=0.0), 1e-4)
    world = stepping_engine("ode").open(case)
    stand = Stand(world, case.scene, 1e-4)
    world.place(lowered(stand.touching, -2.5e-4 * speed), moving(-speed * UP))
    for _ in range(4):
        world.step()
    assert float(world.twist().velocity[2]) / speed == pytest.approx(0.5, rel=1e-6)


@needs_ode
@pytest.mark.parametrize("coefficient", [0.0, 0.1])
def test_a_small_restitution_is_what_the_overlap_of_a_step_gives_back(
    gentle: Scene, coefficient: float
) -> None:
    scene = replace(gentle, effects=Effects(restitution=Restitution(coefficient=coefficient)))
    case = case_of(scene, 1e-4)
    assert stepping_engine("ode").imposed_in(case)["restitution"] * (
        coefficient or 1.0
    ) == pytest.approx(0.2 - coefficient, rel=1e-12)
    world = stepping_engine("ode").open(case)
    # the whole step of the impact is below the plane but a tenth, of which ERP takes a fifth away
    found = rebound(world, gentle.can, 0.4, (1.0, 0.0, 0.1))
    assert 0.15 < found < 0.2


@needs_ode
def test_a_spring_has_no_slack(gentle: Scene) -> None:
    scene = replace(gentle, effects=Effects(compliance=Compliance(stiffness=1e5, damping=5.0)))
    assert stepping_engine("ode").resolve(case_of(scene))["ContactSurfaceLayer"] == 0.0
    rows = {row.quantity: row for row in stepping_engine("ode").parity(case_of(scene, 1e-5))}
    assert rows["contact stiffness"].found == pytest.approx(1e5, rel=1e-3)


@needs_ode
def test_damping_and_a_point_mass_are_carried_together(gentle: Scene) -> None:
    effects = Effects(
        point_mass=PointMass(mass=4e-3, x=0.02), damping=Damping(linear=0.5, angular=0.3)
    )
    rows = stepping_engine("ode").parity(case_of(replace(gentle, effects=effects), 1e-4))
    differing = {row.quantity for row in rows if row.verdict != "equal"}
    assert differing == {"friction between the axes"}


@needs_ode
def test_sweeps_are_counted_where_there_are_any(gentle: Scene) -> None:
    chosen: Any = stepping_engine("ode")
    for options, counted in (({}, 0), (QUICK | {"QuickStepNumIterations": 7}, 7)):
        world = chosen.open(case_of(gentle, 1e-4, **options))
        stand = Stand(world, gentle, 1e-4)
        world.place(lowered(stand.touching, 1e-6), moving())
        assert chosen.counted_step(world) == counted
        world.place(above_origin(1.0), moving())
        assert chosen.counted_step(world) == 0


@needs_ode
def test_worlds_that_take_turns_do_not_share_the_order_of_the_sweeps() -> None:
    # several points, so that the order matters; ODE has one generator for a process
    scene = replace(load("gentle-rock"), release=Release(phi=1e-5), horizon=Horizon(seconds=0.01))
    case = case_of(scene, 1e-4, **QUICK, QuickStepNumIterations=3)

    def placed() -> Any:
        world = stepping_engine("ode").open(case)
        can = scene.can
        world.place(above_origin(can.half_height - 1e-5, quaternion(1e-5, 0.3, 0.0)), moving())
        return world

    def ending(world: Any, between: Callable[[], object]) -> bytes:
        for _ in range(50):
            world.step()
            between()
        pose, twist = world.pose(), world.twist()
        state = (pose.position, pose.quaternion, twist.velocity, twist.angular_velocity)
        return np.concatenate(state).tobytes()

    other = placed()
    assert ending(placed(), lambda: None) == ending(placed(), other.step)


@needs_ode
def test_what_ode_says_of_numbers_that_break_is_not_printed(
    capfd: pytest.CaptureFixture[str],
) -> None:
    from harness.engines.ode import library as ode_library  # noqa: PLC0415 - may not be installed

    ode = ode_library.ode
    say = ode.loadOde("dMessage", None)
    say(3, b"LCP internal error")
    assert capfd.readouterr() == ("", "")
    ode.loadOde("dSetMessageHandler", None)(None)  # its own
    say(3, b"LCP internal error")
    said = capfd.readouterr().err
    ode.loadOde("dSetMessageHandler", None)(ode_library.unsaid)
    assert "LCP internal error" in said
