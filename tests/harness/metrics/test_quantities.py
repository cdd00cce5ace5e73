"""Each quantity reads its own number of a run, in its own unit, and none where there is none."""

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pytest

from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.metrics.error import Errors
from harness.metrics.motion import ContactQuality, Motion, motion
from harness.metrics.quantities import QUANTITIES, finite, turn_error
from models import Horizon, Scene, angular_velocity, quaternion
from tests.support.trajectories import make_trajectory

BOUNCE = Bounce(
    start=0.5,
    time=1.25,
    end=2.75,
    phi_min=0.01,
    angle_of_turn=math.pi,
    rotation_turn=-math.pi / 2.0,
    peak_psi_dot=-40.0,
    peak_friction_ratio=0.75,
)
TRUE_BOUNCE = replace(
    BOUNCE, start=0.25, end=2.25, time=1.0, phi_min=0.02, angle_of_turn=3.0, peak_friction_ratio=0.5
)
_NUMBERED: dict[str, Any] = {
    one.name: (float(number), 99.0) if "tuple" in str(one.type) else float(number)
    for number, one in enumerate(fields(Errors), start=1)
}
ERRORS = Errors(**_NUMBERED)
PLACE = {one.name: float(number) for number, one in enumerate(fields(Errors), start=1)}
CONTACT = ContactQuality(
    max_penetration=0.1, max_slip=0.2, lift_off_fraction=0.3, multi_contact_fraction=0.4
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What a quantity is read from."""

    simulation: Simulation
    motion: Motion | None = None
    bounces: tuple[Bounce, ...] = ()
    energy_drift: float | None = None
    contact: ContactQuality | None = None
    truth: Motion | None = None
    true_bounces: tuple[Bounce, ...] = ()
    errors: Errors | None = None


@pytest.fixture
def empty(gentle: Scene) -> Run:
    """Return a run of two seconds of which nothing was measured."""
    scene = replace(gentle, horizon=Horizon(seconds=2.0))
    return Run(
        simulation=Simulation(
            case=Case(scene=scene, engine="mujoco", timestep=1e-3),
            outcome=Outcome.FINISHED,
            trajectory=None,
            engine_version="1",
            model="mujoco",
            steps=7,
            constraint_rows=70,
            setup_s=0.25,
            compile_s=0.125,
            wall_s=0.5,
            cpu_s=0.75,
        )
    )


def rolled(scene: Scene, end: float, psi: float = 1.0) -> Motion:
    """Return five samples of a can, the last 0.1 s after the one before, alone at 1 and 5 rad/s."""
    time = end - np.array((0.7, 0.5, 0.3, 0.1, 0.0))
    phi = np.array((0.1, 0.1, 0.2, 0.3, 0.4))
    psi_now = psi + np.array((-1.5, -1.0, -0.5, 0.0, 0.5))
    return motion(
        make_trajectory(
            5,
            time=time,
            position=np.outer((0.0, 0.0, 0.0, 0.0, 1.0), (0.7, 0.8, 0.0)),
            quaternion=quaternion(phi, psi_now, np.zeros(5)),
            angular_velocity=angular_velocity(
                phi, psi_now, np.array((9, 9, 9, 9, 1)), np.array((9, 9, 9, 9, 5)), np.zeros(5)
            ),
        ),
        replace(scene, release=replace(scene.release, psi=psi - 1.5, theta=0.0)),
    )


@pytest.fixture
def full(empty: Run, gentle: Scene) -> Run:
    """Return a run of which everything was measured."""
    return replace(
        empty,
        motion=rolled(gentle, 1.95),
        truth=rolled(gentle, 2.0, psi=1.25),
        bounces=(BOUNCE, TRUE_BOUNCE),
        true_bounces=(TRUE_BOUNCE, BOUNCE),
        energy_drift=-0.125,
        contact=CONTACT,
        errors=ERRORS,
    )


OF_RUN = {
    "turn_deg": 180.0,
    "angle_of_turn_deg": 180.0,
    "rotation_turn_deg": -90.0,
    "period_s": 2.25,
    "bounce_time_s": 1.25,
    "phi_min_rad": 0.01,
    "peak_psi_dot_rad_s": -40.0,
    "peak_friction_ratio": 0.75,
    # carried on by 0.05 s at 1 and 5 rad/s
    "phi_end_deg": math.degrees(0.45),
    "psi_end_deg": math.degrees(1.75),
    "phi_end_rad": 0.4,
    "x_end_m": 0.7,
    "y_end_m": 0.8,
    "turn_error_deg": math.degrees(PLACE["angle_of_turn"]),
    "angle_of_turn_error_deg": math.degrees(PLACE["angle_of_turn"]),
    "bounce_time_error_s": PLACE["time_of_bounce"],
    "peak_friction_ratio_error": PLACE["peak_friction_ratio"],
    "phi_min_error_rad": PLACE["phi_min"],
    "period_error_s": 0.25,
    "phi_rms_rad": PLACE["phi_rms"],
    "phi_rms_before_rad": PLACE["phi_rms_before"],
    "phi_rms_after_rad": PLACE["phi_rms_after"],
    "phi_max_rad": PLACE["phi_max"],
    "rotation_rms_rad": PLACE["rotation_rms"],
    "rotation_rms_deg": math.degrees(PLACE["rotation_rms"]),
    "psi_rms_rad": PLACE["psi_rms"],
    "theta_rms_rad": PLACE["theta_rms"],
    "contact_locus_rms_m": PLACE["contact_locus_rms"],
    "contact_locus_hausdorff_m": PLACE["contact_locus_hausdorff"],
    "energy_drift": -0.125,
    "max_penetration_m": 0.1,
    "max_slip_m_s": 0.2,
    "lift_off_fraction": 0.3,
    "multi_contact_fraction": 0.4,
}
OF_SIMULATION = {
    "steps": 7,
    "constraint_rows": 70,
    "setup_s": 0.25,
    "compile_s": 0.125,
    "wall_s": 0.5,
    "cpu_s": 0.75,
}
OF_TRUTH = {
    "turn_deg": math.degrees(3.0),
    "angle_of_turn_deg": math.degrees(3.0),
    "rotation_turn_deg": -90.0,
    "period_s": 2.0,
    "bounce_time_s": 1.0,
    "phi_min_rad": 0.02,
    "peak_psi_dot_rad_s": -40.0,
    "peak_friction_ratio": 0.5,
    "phi_end_deg": math.degrees(0.4),
    "psi_end_deg": math.degrees(1.75),
    "phi_end_rad": 0.4,
    "x_end_m": 0.7,
    "y_end_m": 0.8,
}


def test_each_quantity_reads_its_own_number(full: Run) -> None:
    found = {key: one.of_run(full) for key, one in QUANTITIES.items()}
    assert found == pytest.approx(OF_RUN | OF_SIMULATION, rel=1e-12, abs=0)


def test_of_the_exact_motion_the_same_number_and_no_error(full: Run) -> None:
    found = {key: one.of_truth(full) for key, one in QUANTITIES.items()}
    assert {key: value for key, value in found.items() if value is not None} == pytest.approx(
        OF_TRUTH, rel=1e-12, abs=0
    )


def test_where_nothing_was_measured_there_is_no_number(empty: Run) -> None:
    for key, one in QUANTITIES.items():
        assert one.of_run(empty) == OF_SIMULATION.get(key)
        assert one.of_truth(empty) is None


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_none(full: Run, broken: float) -> None:
    assert finite(broken) is None
    assert finite(0.0) == 0.0
    run = replace(
        full,
        bounces=(replace(BOUNCE, peak_friction_ratio=broken),),
        errors=replace(ERRORS, phi_rms=broken, peak_friction_ratio=(broken,)),
        contact=replace(CONTACT, max_slip=broken),
        energy_drift=broken,
    )
    lost = {key for key, one in QUANTITIES.items() if one.of_run(run) is None}
    assert lost == {
        *("peak_friction_ratio", "peak_friction_ratio_error", "phi_rms_rad"),
        *("max_slip_m_s", "energy_drift"),
    }


def test_a_turn_that_was_not_counted_is_told_as_recorded_only(full: Run) -> None:
    run = replace(full, bounces=(replace(BOUNCE, resolved=False),))
    lost = {key for key, one in QUANTITIES.items() if one.of_run(run) is None}
    assert lost == {"turn_deg", "turn_error_deg"}
    assert QUANTITIES["turn_deg"].of_bounce(run.bounces[0]) is None
    assert QUANTITIES["angle_of_turn_deg"].of_bounce(run.bounces[0]) == 180.0
    assert QUANTITIES["phi_rms_rad"].of_bounce(run.bounces[0]) is None


def test_a_turn_has_an_error_where_both_completed_it(full: Run) -> None:
    assert turn_error(full, 1) == math.degrees(99.0)
    assert turn_error(full, 2) is None
    errors = replace(ERRORS, angle_of_turn=(0.0,))
    assert turn_error(replace(full, errors=errors), 1) is None
    assert turn_error(replace(full, errors=None)) is None
    assert QUANTITIES["period_error_s"].of_run(replace(full, true_bounces=())) is None


@pytest.mark.parametrize(
    ("end", "known"), [(1.901, True), (1.899, False), (2.099, True), (2.101, False)]
)
def test_an_angle_is_carried_on_by_one_interval_at_most(
    full: Run, gentle: Scene, end: float, *, known: bool
) -> None:
    run = replace(full, motion=rolled(gentle, end))
    assert (QUANTITIES["psi_end_deg"].of_run(run) is not None) is known


def test_without_a_time_to_end_at_no_angle_is_one_at_the_end(full: Run, gentle: Scene) -> None:
    simulation = replace(
        full.simulation, case=replace(full.simulation.case, scene=gentle)
    )  # a bounce long
    run = replace(full, simulation=simulation)
    lost = {key for key, one in QUANTITIES.items() if one.of_run(run) is None}
    assert lost == {"phi_end_deg", "psi_end_deg", "phi_end_rad"}


def test_an_axis_has_the_unit_in_brackets() -> None:
    assert QUANTITIES["turn_deg"].axis == "angle of turn [deg]"
    assert QUANTITIES["period_s"].axis == "period [s]"
    assert QUANTITIES["steps"].axis == "steps"


@pytest.mark.parametrize("key", list(QUANTITIES))
def test_a_key_ends_with_its_unit(key: str) -> None:
    suffixes = {
        "degrees": "_deg",
        "m/s": "_m_s",
        "rad/s": "_rad_s",
        "of the time": "_fraction",
    }
    unit = QUANTITIES[key].unit
    if unit not in {"", "m g R"}:
        assert key.endswith(suffixes.get(unit, f"_{unit}"))
