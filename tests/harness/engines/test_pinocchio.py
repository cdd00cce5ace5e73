"""Pinocchio: what it ships with, its own laws, and settings to paste."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Outcome
from harness.engines.parity.contact import Stand
from harness.engines.probes import PROBES
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import X, Y, above_origin, lowered, moving
from models import (
    Damping,
    Effects,
    Horizon,
    PointMass,
    Scene,
    Slip,
    contact_offset,
    load,
    quaternion,
)
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("pinocchio")


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of Pinocchio."""
    return Case(scene=scene, engine="pinocchio", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "error"),
    [(1e-3, -0.0087), (1e-4, -0.0120), pytest.param(1e-5, -0.0013, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, timestep: float, error: float
) -> None:
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, abs=6e-4)


def test_the_paper_release_turns_with_adaptive_steps() -> None:
    case = replace(case_of(load("paper-release")), profile="adaptive")
    assert turn_error(case) == pytest.approx(0.0002, abs=3e-4)


def test_both_solvers_find_one_motion(gentle: Scene) -> None:
    found = [turn_error(case_of(gentle, 1e-3, solver=solver)) for solver in ("PGS", "ADMM")]
    assert found[0] == pytest.approx(found[1], abs=1e-6)


@pytest.mark.parametrize("solver", ["PGS", "ADMM"])
@pytest.mark.parametrize("angle", [0.0, 0.2, math.pi / 4.0])
def test_friction_is_a_cone(gentle: Scene, angle: float, solver: str) -> None:
    scene = replace(gentle, effects=Effects(slip=Slip(mu=0.3)))
    stand = Stand(
        stepping_engine("pinocchio").open(case_of(scene, 1e-4, solver=solver)), scene, 1e-4
    )
    way = math.cos(angle) * X + math.sin(angle) * Y
    force = stand.press(1e-6, moving(10.0 * way)).force
    assert math.hypot(force[0], force[1]) / force[2] == pytest.approx(0.3, rel=1e-6)
    assert float(force @ way) == pytest.approx(-0.3 * force[2], rel=1e-6)


@pytest.mark.parametrize("phi", [1e-2, 1e-4, 1e-6, 1e-8])
def test_the_contact_is_the_lowest_point_of_the_rim_however_flat_the_can(
    gentle: Scene, phi: float
) -> None:
    can = gentle.can
    height = can.radius * math.sin(phi) + can.half_height * math.cos(phi)
    pose = lowered(above_origin(height, quaternion(phi, 0.7, 0.0)), 1e-7)
    world = stepping_engine("pinocchio").open(case_of(gentle, 1e-5))
    world.place(pose, moving())
    # an ulp of the size of the can
    assert world.signed_distance() == pytest.approx(-1e-7, abs=1e-16)
    world.step()
    lowest = contact_offset(can, phi, 0.7)[:2]
    assert world.contact().count == 1
    assert np.abs(world.contact().point[:2] - lowest).max() < 1e-12 * can.radius / phi


@pytest.mark.parametrize("share", [0.2, 1.0])
def test_a_share_of_an_overlap_is_taken_away_in_a_step(gentle: Scene, share: float) -> None:
    case = case_of(gentle, 1e-4, correction=share)
    probed = PROBES["stabilisation"](stepping_engine("pinocchio"), case)
    found = {quantity: value for quantity, _, value, _, _ in probed}
    for overlap in (1e-5, 1e-4, 1e-3):
        law = share * overlap * gentle.can.radius / 1e-4
        assert found[f"speed from an overlap of {overlap:g} R"] == pytest.approx(law, rel=1e-6)


def test_a_rim_that_falls_stops_at_the_plane_and_not_within_it(gentle: Scene) -> None:
    world = stepping_engine("pinocchio").open(case_of(gentle, 1e-3))
    stand = Stand(world, gentle, 1e-3)
    world.place(lowered(stand.touching, -1e-3), moving(-2.0 * np.eye(3)[2]))
    for _ in range(3):
        world.step()
        assert world.signed_distance() > -1e-5  # of the turn in a step


def test_what_it_ships_with_is_what_is_stated() -> None:
    import coal  # noqa: PLC0415 - may not be installed
    import pinocchio  # noqa: PLC0415

    stated = {setting.name: setting.default for setting in engine("pinocchio").settings}
    for settings in (pinocchio.PGSSolverSettings(), pinocchio.ADMMSolverSettings()):
        assert settings.max_iterations == stated["max_iterations"]
        assert settings.solve_ncp
        for kind in ("absolute", "relative"):
            for what in ("feasibility", "complementarity"):
                assert getattr(settings, f"{kind}_{what}_tol") == stated["tolerance"]
    assert coal.CollisionRequest().security_margin == stated["security_margin"]


@pytest.mark.parametrize(
    "variant",
    () if "pinocchio" in not_installed() else variants("pinocchio"),
    ids=lambda variant: variant.name,
)
def test_what_is_pasted_runs_and_means_the_case(variant: Any) -> None:
    case = case_of(load("gentle-rock"), 2.0**-12)
    case = replace(case, profile=variant.profile, options=variant.settings)
    chosen, names = stepping_engine("pinocchio").resolve(case), dict[str, Any]()
    exec(compile(export_settings(case), "pasted", "exec"), names)  # noqa: S102 - a user would
    assert names["timestep"] == 2.0**-12
    assert names["request"].security_margin == chosen["security_margin"]
    assert names["correction"] == chosen["correction"]
    assert type(names["solver"]).__name__ == f"{chosen['solver']}ConstraintSolver"
    assert names["settings"].max_iterations == chosen["max_iterations"]
    assert names["settings"].relative_complementarity_tol == chosen["tolerance"]


def test_damping_and_a_point_mass_are_carried_together(gentle: Scene) -> None:
    effects = Effects(
        point_mass=PointMass(mass=4e-3, x=0.02), damping=Damping(linear=0.5, angular=0.3)
    )
    rows = stepping_engine("pinocchio").parity(case_of(replace(gentle, effects=effects), 1e-4))
    assert {row.verdict for row in rows} == {"equal"}


def test_iterations_are_counted_where_there_is_a_contact(gentle: Scene) -> None:
    chosen: Any = stepping_engine("pinocchio")
    world = chosen.open(case_of(gentle, 1e-4))
    stand = Stand(world, gentle, 1e-4)
    world.place(lowered(stand.touching, 1e-6), moving(0.1 * X, np.array((1.0, 2.0, 0.3))))
    assert chosen.counted_step(world) > 0
    world.place(above_origin(1.0), moving())
    assert chosen.counted_step(world) == 0


def test_numbers_that_break_end_a_run(gentle: Scene) -> None:
    violent = replace(gentle.release, phi=1.0, theta_dot=1e12, psi_dot=1e12)
    scene = replace(gentle, release=violent, horizon=Horizon(seconds=0.05))
    found = engine("pinocchio").simulate(case_of(scene, 1e-3))
    assert found.outcome in {Outcome.DIVERGED, Outcome.OVERTURNED}
