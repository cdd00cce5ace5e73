"""Settings of PyBullet that change what is read, or what is printed."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Simulation
from harness.engines.registry import engine
from models import Compliance, PointMass, Scene, load
from models.rim import released
from tests.support.engines import stepping_engine

DANTZIG = "CONSTRAINT_SOLVER_LCP_DANTZIG"


def _run(scene: Scene, timestep: float, **options: Value) -> Simulation:
    case = Case(scene=scene, engine="pybullet", timestep=timestep, options=tuple(options.items()))
    return engine("pybullet").simulate(case)


def test_of_a_timestep_in_parts_the_force_is_that_of_its_last_part(gentle: Scene) -> None:
    whole = _run(gentle, 4e-4, numSubSteps=4).trajectory
    parts = _run(gentle, 1e-4).trajectory
    assert whole is not None
    assert parts is not None
    weight = gentle.can.mass * gentle.gravity
    times = whole.time[(whole.time > 0.01) & (whole.time < 0.2)]
    for axis in range(3):
        mine = np.interp(times, whole.time, whole.contact_force[:, axis])
        fine = np.interp(times + 3e-4, parts.time, parts.contact_force[:, axis])
        np.testing.assert_allclose(mine, fine, atol=0.005 * weight)


@pytest.mark.parametrize("profile", ["default", "matched"])
@pytest.mark.parametrize("scene", ["gentle-rock", "dropped-can", "soft-rock"])
# by its own clock PyBullet takes one part fewer in an early step of all but the first of these
@pytest.mark.parametrize(("timestep", "parts"), [(1e-3, 4), (1e-5, 10), (1e-4, 37), (1e-6, 15)])
def test_a_timestep_in_parts_is_so_many_steps(
    scene: str, profile: str, timestep: float, parts: int
) -> None:
    opens = stepping_engine("pybullet").open
    case = Case(scene=load(scene), engine="pybullet", profile=profile, timestep=timestep)
    whole = opens(replace(case, options=(("numSubSteps", parts),)))
    single = opens(replace(case, options=(("numSubSteps", parts),)))
    single.take_parts()
    assert single.timestep == pytest.approx(timestep / parts, rel=1e-14)
    for world, steps in ((whole, 20), (single, 20 * parts)):
        world.place(*released(case.scene))
        for _ in range(steps):
            world.step()
    for mine, other in zip(whole.state(), single.state(), strict=True):
        assert mine == other


@pytest.mark.parametrize("profile", ["default", "matched", "adaptive"])
@pytest.mark.parametrize("scene", ["gentle-rock", "dropped-can", "soft-rock", "tilted-plane"])
def test_a_timestep_in_parts_has_the_can_of_the_scene(scene: str, profile: str) -> None:
    for timestep, parts in ((1e-3, 2), (1e-4, 4), (1e-4, 49)):
        case = Case(
            scene=load(scene),
            engine="pybullet",
            profile=profile,
            timestep=timestep,
            options=(("numSubSteps", parts),),
        )
        chosen = stepping_engine("pybullet")
        rows = {row.quantity: row for row in chosen.parity(case)}
        assert "mismatch" not in {row.verdict for row in rows.values()}
        part = chosen.timestep(case) / parts
        assert rows["timestep"].declared == pytest.approx(part, rel=1e-12)
        assert rows["timestep"].found == pytest.approx(part, rel=1e-9)


@pytest.mark.parametrize(
    ("stiffness", "slop", "verdicts"),
    [
        (1e4, None, ["imposed", "equal"]),
        (1e4, 2e-5, ["imposed", "equal"]),
        (1e4, 0.0, ["equal", "equal"]),
        (50.0, None, ["imposed", "equal"]),  # bears the weight at no depth that a can has
        (1e6, None, ["imposed", "imposed"]),  # would bear it within the slop
    ],
)
@pytest.mark.parametrize("point_mass", [None, PointMass(mass=0.1, x=0.002, y=0.0, z=0.0)])
def test_as_it_ships_a_spring_begins_below_the_slop(
    stiffness: float, slop: float | None, verdicts: list[str], point_mass: PointMass | None
) -> None:
    soft = load("soft-rock")
    law = Compliance(stiffness=stiffness, damping=1e-4 * stiffness)
    scene = replace(soft, effects=replace(soft.effects, compliance=law, point_mass=point_mass))
    options = (("contactSlop", slop),) if slop is not None else ()
    case = Case(scene=scene, engine="pybullet", profile="default", timestep=1e-5, options=options)
    rows = {row.quantity: row for row in stepping_engine("pybullet").parity(case)}
    assert [rows[f"contact {name}"].verdict for name in ("stiffness", "damping")] == verdicts


def test_another_solver_finds_the_same_motion_and_says_nothing(
    gentle: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    shipped, other = _run(gentle, 1e-3), _run(gentle, 1e-3, constraintSolverType=DANTZIG)
    assert shipped.trajectory is not None
    assert other.trajectory is not None
    apart = np.abs(other.trajectory.position - shipped.trajectory.position).max()
    assert 0.0 < apart < 1e-6 * gentle.can.radius
    assert capfd.readouterr() == ("", "")
