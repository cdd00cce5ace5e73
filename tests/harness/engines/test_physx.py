"""PhysX: single precision, anchors of friction, what it ships with, and a stage to paste."""

import math
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import HarnessError
from harness.engines.can_mesh import MESH_SETTING, prism
from harness.engines.parity.contact import Stand
from harness.engines.probes.rim_contact import Stance, collision
from harness.engines.registry import engine, export_settings
from harness.engines.stepping.settling import (
    AT_REST,
    above_origin,
    hovering_distance,
    lowered,
    moving,
)
from models import Effects, Scene, Slip, quaternion
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("physx")

CUSTOM_GEOMETRY = "COLLISION_CYLINDER_CUSTOM_GEOMETRY"
CONVEX_MESH: dict[str, Value] = {CUSTOM_GEOMETRY: False}

ANCHORS: dict[str, Value] = {
    "frictionOffsetThreshold": 0.04,
    "frictionCorrelationDistance": 0.025,
}


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of PhysX."""
    return Case(scene=scene, engine="physx", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "most"),
    [(1e-3, 1.0), (1e-4, 0.3), pytest.param(1e-5, 0.3, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_as_single_precision_allows(
    gentle: Scene, timestep: float, most: float
) -> None:
    # a state rounded to 24 bits costs 0.3 degrees; a step of a millisecond 0.7
    assert abs(turn_error(case_of(gentle, timestep))) < most


def test_anchors_as_shipped_leave_degrees_at_any_timestep(gentle: Scene) -> None:
    for timestep in (1e-3, 1e-4):
        assert turn_error(case_of(gentle, timestep, **ANCHORS)) < -5.0


@pytest.mark.parametrize("phi", [1e-4, 0.02, 0.4, 1.5])
def test_the_distance_is_that_of_an_ideal_rim_and_asking_changes_nothing(
    gentle: Scene, phi: float
) -> None:
    world = stepping_engine("physx").open(case_of(gentle, 1e-3))
    lift = 1e-3 * gentle.can.radius
    # heights of 0.1 m are known to 1e-8 m
    assert hovering_distance(world, gentle.can, phi, 0.3) == pytest.approx(lift, abs=3e-8)
    spun = moving(0.3 * np.array((1.0, 2.0, 3.0)), np.array((3.0, 2.0, 1.0)))
    world.place(above_origin(0.3, quaternion(phi, 0.1, 0.2)), spun)
    before = world.pose(), world.twist()
    world.signed_distance()
    for one, other in zip(before, (world.pose(), world.twist()), strict=True):
        assert repr(one) == repr(other)


def test_a_can_that_is_placed_forgets_where_it_was_held(gentle: Scene) -> None:
    case = case_of(gentle, 1e-3, **ANCHORS)
    found = []
    for held in (False, True):
        world = stepping_engine("physx").open(case)
        stand = Stand(world, gentle, 1e-3)
        pose = lowered(stand.touching, 1e-6)
        if held:
            world.place(pose, moving())
            for _ in range(5):
                world.step()
        world.place(pose, moving(np.array((0.1, 0.0, 0.0))))
        world.step()
        found.append(world.contact().force)
    np.testing.assert_array_equal(*found)


def test_what_it_ships_with_is_what_its_schema_says() -> None:
    from importlib.metadata import distribution  # noqa: PLC0415 - may not be installed

    folder = distribution("physx-usd-schemas").locate_file("physx_usd_schemas/PhysxSchema")
    schema = (Path(str(folder)) / "resources" / "generatedSchema.usda").read_text("utf-8")
    for setting in engine("physx").settings:
        # of the contact offset it says -inf: PhysX chooses
        if setting.name in {"eta", "contactOffset", CUSTOM_GEOMETRY, MESH_SETTING.name}:
            continue
        (said,) = set(re.findall(rf"physx(?:Scene|RigidBody):{setting.name} = (\S+)", schema))
        shipped = setting.default
        if isinstance(shipped, str):
            assert said == f'"{shipped}"'
        else:
            assert float(said) == float(shipped)  # type: ignore[arg-type] # a number or a truth


def test_the_stage_that_is_pasted_is_the_one_that_runs(gentle: Scene, tmp_path: Path) -> None:
    import ovstage  # noqa: PLC0415 - may not be installed

    for profile in ("default", "matched", "adaptive"):
        case = replace(case_of(gentle, 2.0**-12, angularDamping=0.125), profile=profile)
        stepping_engine("physx").open(case)  # which registers the schemas
        file = tmp_path / f"{profile}.usda"
        file.write_text(text := export_settings(case), encoding="utf-8")
        stage: Any = ovstage.Stage(profile)
        every = ovstage.PopulationDomain.ALL
        ovstage.population.open_usd(stage, str(file), ordinal=1, domains=every)
        stage.destroy()
        assert "float physxRigidBody:angularDamping = 0.125\n" in text
        assert f"step_sync({2.0**-12!r})" in text
        assert f"(ovphysx.GlobalConfigKey.{CUSTOM_GEOMETRY}, True)" in text


def test_nothing_is_printed(gentle: Scene, capfd: pytest.CaptureFixture[str]) -> None:
    world = stepping_engine("physx").open(case_of(gentle, 1e-3))
    world.place(above_origin(0.0645, quaternion(0.4, 0.0, 0.0)), moving())
    world.step()
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", "")


@pytest.mark.parametrize("angle", [0.0, 0.2, 0.7])
def test_a_scene_that_slips_has_a_cone_and_pgs_two_directions(gentle: Scene, angle: float) -> None:
    scene = replace(gentle, effects=Effects(slip=Slip(mu=0.3)))
    ratios = []
    for options in ({}, {"solverType": "PGS"}):
        case = case_of(scene, 1e-4, **options)
        stand = Stand(stepping_engine("physx").open(case), scene, 1e-4)
        way = np.array((math.cos(angle), math.sin(angle), 0.0))
        force = stand.press(1e-6, moving(10.0 * way)).force
        ratios.append(math.hypot(force[0], force[1]) / force[2])
    assert ratios[0] == pytest.approx(0.3, rel=1e-4)
    assert 0.3 * (1.0 - 1e-4) < ratios[1] < 0.3 * math.sqrt(2.0) * (1.0 + 1e-4)


def test_a_process_starts_with_exact_cylinders() -> None:
    program = f"""
import ovphysx
print(ovphysx.get_global_config(ovphysx.GlobalConfigKey.{CUSTOM_GEOMETRY}))
"""
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    (setting,) = (each for each in engine("physx").settings if each.name == CUSTOM_GEOMETRY)
    assert done.stdout.strip() == str(setting.default)


_DEEP = 3e-4
"""m: deeper than a side of the coarsest mesh below is short of the rim."""


def deepest(scene: Scene, spins: Sequence[float], **options: Value) -> list[float]:
    """Return the largest depth, m, of a can whose rim is `_DEEP`, at each turn about its axis."""
    world = stepping_engine("physx").open(case_of(scene, None, **options))
    found = []
    for spin in spins:
        stance = Stance(tilt=0.5, heading=0.0, spin=spin, upside_down=False, depth=_DEEP)
        world.place(stance.put(scene.can)[0], AT_REST)
        found.append(float(collision(world).depths.max()))
    return found


@pytest.mark.parametrize(
    ("options", "sides", "round_"),
    [
        ({}, 30, True),
        (CONVEX_MESH, 30, False),
        ({"mesh": prism(24)}, 24, False),
        ({"mesh": prism(31)}, 31, False),
    ],
    ids=["cylinder", "convex mesh", "24 sides", "31 sides"],
)
def test_a_mesh_has_its_corners_on_the_rim_and_its_sides_within(
    gentle: Scene, options: dict[str, Value], sides: int, *, round_: bool
) -> None:
    corner, middle = deepest(gentle, [0.0, math.pi / sides], **options)
    within = gentle.can.radius * (1.0 - math.cos(math.pi / sides)) * math.sin(0.5)
    known = 3e-8  # m: of heights of 0.1 m
    assert corner == pytest.approx(_DEEP, abs=known)
    assert middle == pytest.approx(_DEEP - (0.0 if round_ else within), abs=known)


def test_of_a_mesh_with_more_corners_another_hull_is_made(gentle: Scene) -> None:
    spins = [0.01 * math.tau * turn for turn in range(100)]
    found = {sides: deepest(gentle, spins, mesh=prism(sides)) for sides in (31, 32)}
    assert max(found[31]) < _DEEP + 3e-8
    assert max(found[32]) > _DEEP + 1e-4


def test_the_parity_of_a_mesh_is_declared(gentle: Scene) -> None:
    for options in (CONVEX_MESH, {"mesh": prism(24)}):
        case = case_of(gentle, 1e-4, **options)
        declared = stepping_engine("physx").imposed_in(case)
        rows = {row.quantity: row for row in stepping_engine("physx").parity(case)}
        assert {row.verdict for row in rows.values()} == {"equal", "imposed"}
        assert {name for name, row in rows.items() if row.verdict == "imposed"} <= declared.keys()
        assert rows["rim deviation"].verdict == "imposed"


def test_worlds_of_both_kinds_are_refused_at_once_and_made_in_turn(gentle: Scene) -> None:
    first, other = case_of(gentle, 1e-3), case_of(gentle, 1e-3, **CONVEX_MESH)
    world: Any = stepping_engine("physx").open(first)
    with pytest.raises(HarnessError, match="processes of their own"):
        stepping_engine("physx").open(other)
    nobody_reaches = [world]
    nobody_reaches.append(nobody_reaches)  # but the collector of rubbish
    del world, nobody_reaches
    stepping_engine("physx").open(other)


def test_asking_for_the_points_changes_nothing(gentle: Scene) -> None:
    worlds = [stepping_engine("physx").open(case_of(gentle, 1e-3)) for _ in range(2)]
    pose, twist = above_origin(0.0645, quaternion(0.4, 0.0, 0.0)), moving(np.array((0.1, 0.0, 0.0)))
    for world, asks in zip(worlds, (False, True), strict=True):
        world.place(pose, twist)
        if asks:
            collision(world)
        for _ in range(3):
            world.step()
    one, two = (repr((world.pose(), world.twist())) for world in worlds)
    assert one == two
