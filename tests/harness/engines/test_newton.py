"""Newton: its two solvers, single precision, what it ships with, and settings to paste."""

import inspect
import math
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.engines.can_mesh import prism
from harness.engines.description import Precision
from harness.engines.probes.rim_contact import Stance, collision
from harness.engines.registry import export_settings
from harness.engines.stepping.settling import AT_REST, above_origin, moving
from models import Scene, contact_point
from tests.support.engines import stepping_engine
from tests.support.evaluations import stepped, turn_error

pytestmark = pytest.mark.engine("newton")


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of Newton."""
    return Case(scene=scene, engine="newton", timestep=timestep, options=tuple(options.items()))


STEEL: dict[str, Value] = {}
XPBD: dict[str, Value] = {"solver": "SolverXPBD", "iterations": 20}


@pytest.mark.parametrize(
    ("options", "timestep", "error"),
    [
        (STEEL, 1e-3, -0.453),
        (STEEL, 1e-4, 0.0),
        pytest.param(STEEL, 1e-5, 0.0, marks=pytest.mark.slow),
        (XPBD, 1e-3, 0.25),  # 0.22 to 0.34 if phi changes by 2e-6; 0.15 elsewhere
        (XPBD, 1e-4, 0.157),
    ],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, options: dict[str, Value], timestep: float, error: float
) -> None:
    # a state rounded to 24 bits costs some tenths of a degree at shorter steps
    assert turn_error(case_of(gentle, timestep, **options)) == pytest.approx(error, abs=0.15)


@pytest.mark.parametrize(
    ("profile", "options", "timestep"),
    [
        ("default", STEEL, None),
        ("default", XPBD, None),
        ("matched", STEEL, None),
        ("matched", STEEL, 1e-5),
        ("matched", XPBD, None),
        ("matched", XPBD, 1e-5),
    ],
)
def test_exactly_the_rows_that_are_declared_deviate(
    gentle: Scene, profile: str, options: dict[str, Value], timestep: float | None
) -> None:
    case = replace(case_of(gentle, timestep, **options), profile=profile)
    rows = stepping_engine("newton").parity(case)
    deviating = {row.quantity: row.verdict for row in rows if row.verdict != "equal"}
    declared = stepping_engine("newton").imposed_in(case)
    has = {row.quantity for row in rows}  # a plane that is level has one row of gravity
    assert deviating == dict.fromkeys(declared.keys() & has, "imposed")


def test_parity_tells_the_rim_in_single_precision(gentle: Scene) -> None:
    rows = {row.quantity: row for row in stepping_engine("newton").parity(case_of(gentle, 1e-4))}
    rim = rows["rim deviation"]
    # R eps/phi at the smallest tilt that is probed, 0.02 rad
    assert 0.1 < rim.found / (gentle.can.radius * Precision.SINGLE.epsilon / 0.02) < 10.0


def test_from_rest_nothing_falls_by_short_steps_of_xpbd(gentle: Scene) -> None:
    for options, falls in ((XPBD, False), (STEEL, True)):
        world = stepping_engine("newton").open(case_of(gentle, 1e-5, **options))
        world.place(above_origin(1.0), moving())
        for _ in range(100):
            world.step()
        fallen = -float(world.twist().velocity[2]) / (gentle.gravity * 1e-3)
        assert fallen == pytest.approx(1.0 if falls else 0.0, rel=1e-4)


def test_the_contact_is_the_lowest_point_in_all_steps_but_few(gentle: Scene) -> None:
    off = {}
    for gate in (5e-8, None):
        path = stepped(case_of(gentle, 1e-4, contact_gap_gate=gate), 1800)
        low = contact_point(gentle.can, path.position, path.quaternion)
        away = np.linalg.norm((path.contact_point - low)[:, :2], axis=1) / gentle.can.radius
        off[gate] = int((away > 1e-4).sum())
    assert off[5e-8] <= 1 < off[None] < 5


def test_what_it_ships_with_is_what_is_stated() -> None:
    import newton  # noqa: PLC0415 - may not be installed

    shipped: dict[str, Any] = {}
    for solver in ("SolverXPBD", "SolverSteel"):
        solve = inspect.signature(getattr(newton.solvers, solver)).parameters
        shipped |= {name: value.default for name, value in solve.items()}
    stated = {each.name: each.default for each in stepping_engine("newton").settings}
    names = stated.keys() & shipped.keys() - {"iterations"}
    assert {name: stated[name] for name in names} == {name: shipped[name] for name in names}
    assert {"baumgarte", "cfm", "contact_gap_gate", "rigid_contact_relaxation"} <= names
    assert stated["gap"] == newton.ModelBuilder().rigid_gap


def test_nothing_is_printed_where_it_is_started() -> None:
    program = "import harness.engines.newton.world"
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("", "")


@pytest.mark.parametrize("solver", ["SolverSteel", "SolverXPBD"])
def test_a_step_is_taken_once_whatever_was_captured_before(gentle: Scene, solver: str) -> None:
    world = stepping_engine("newton").open(case_of(gentle, 1e-3, solver=solver))
    for timestep in (1e-3, 5e-4, 1e-3):
        world.set_timestep(timestep)
        world.place(above_origin(10.0), moving())
        world.step()
        fallen = float(world.twist().velocity[2])
        assert fallen == pytest.approx(-gentle.gravity * timestep, rel=1e-6)


@pytest.mark.parametrize("profile", ["default", "matched", "adaptive"])
@pytest.mark.parametrize("solver", ["SolverSteel", "SolverXPBD"])
def test_what_is_pasted_makes_the_solver_of_the_case(
    gentle: Scene, profile: str, solver: str
) -> None:
    import newton  # noqa: PLC0415 - may not be installed

    case = replace(case_of(gentle, 2.0**-12, solver=solver), profile=profile)
    builder = newton.ModelBuilder()
    newton.solvers.SolverSteel.register_custom_attributes(builder)
    builder.add_shape_cylinder(builder.add_body(mass=1.0), radius=1.0, half_height=1.0)
    names: dict[str, Any] = {"model": builder.finalize(device="cpu")}
    exec(compile(export_settings(case), "pasted", "exec"), names)  # noqa: S102 - a user would
    assert type(names["solver"]).__name__ == solver
    assert names["timestep"] == 2.0**-12
    chosen = stepping_engine("newton").resolve(case)
    assert names["model"].shape_gap.numpy() == pytest.approx(chosen["gap"])


HULL, MESH = "add_shape_convex_hull", "add_shape_mesh"

_DEEP = 3e-4
"""m: deeper than a side of the coarsest mesh below is short of the rim."""


@pytest.mark.parametrize(
    ("options", "sides", "round_"),
    [
        ({}, 32, True),
        ({"add_shape": HULL}, 32, False),
        ({"add_shape": MESH}, 32, False),
        ({"add_shape": HULL, "mesh": prism(24)}, 24, False),
        ({"add_shape": MESH, "mesh": prism(100)}, 100, False),
    ],
    ids=["cylinder", "hull", "mesh", "hull of 24", "mesh of 100"],
)
def test_a_mesh_has_its_corners_on_the_rim_and_its_sides_within(
    gentle: Scene, options: dict[str, Value], sides: int, *, round_: bool
) -> None:
    world = stepping_engine("newton").open(case_of(gentle, None, **options))
    found, distances = [], []
    for spin in (0.0, math.pi / sides):  # a corner lowest, and the middle of a side
        stance = Stance(tilt=0.5, heading=0.0, spin=spin, upside_down=False, depth=_DEEP)
        world.place(stance.put(gentle.can)[0], AT_REST)
        found.append(float(collision(world).depths.max()))
        distances.append(world.signed_distance())
    within = gentle.can.radius * (1.0 - math.cos(math.pi / sides)) * math.sin(0.5)
    expected = [_DEEP, _DEEP - (0.0 if round_ else within)]
    known = 2e-7  # m: heights of 0.1 m to 1e-8 m, and the search of a hull ends before that
    assert found == pytest.approx(expected, abs=known)
    # a hull is sought within a gap of 20 m
    assert [-each for each in distances] == pytest.approx(expected, abs=1e-5)


def test_what_is_found_far_off_is_no_contact_point(gentle: Scene) -> None:
    # a world asked with a gap of metres tells points where the can does not reach
    for shape in ("add_shape_cylinder", HULL, MESH):
        world = stepping_engine("newton").open(case_of(gentle, None, add_shape=shape))
        stance = Stance(tilt=0.5, heading=0.0, spin=0.0, upside_down=False, depth=-0.1)
        world.place(stance.put(gentle.can)[0], AT_REST)
        assert len(collision(world).depths) == 0
        assert world.signed_distance() == pytest.approx(0.1, abs=1e-5)


@pytest.mark.parametrize("shape", [HULL, MESH])
def test_the_parity_of_a_mesh_is_declared(gentle: Scene, shape: str) -> None:
    case = case_of(gentle, 1e-4, add_shape=shape)
    rows = {row.quantity: row for row in stepping_engine("newton").parity(case)}
    assert {row.verdict for row in rows.values()} == {"equal", "imposed"}
    declared = stepping_engine("newton").imposed_in(case)
    assert {name for name, row in rows.items() if row.verdict == "imposed"} <= declared.keys()
    assert rows["rim deviation"].verdict == "imposed"
