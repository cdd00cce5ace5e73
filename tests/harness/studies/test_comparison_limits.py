"""Numbers that the scorecard cites of what agrees, just inside and just outside each.

They are written out here as the docstrings have them, and not imported: whoever changes one in the
code is told which sentence no longer holds.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.trajectory import Trajectory
from harness.core.verdict import Status
from harness.engines.reference.assumption_checks import Divergence
from harness.engines.reference.truth import truth
from harness.evaluation.evaluation import Evaluation
from harness.metrics.energy import energy
from harness.studies.comparison.fidelity import fidelity, scorecard_verdict
from harness.studies.comparison.selection import followed_best
from models import quaternion
from models.kinematics import angles
from tests.support.changed_motions import (
    SCENE,
    Change,
    changed,
    lean_further,
    run_of,
    turn_further,
)

CAN = SCENE.can


def evaluated(exact: Trajectory, change: Change = lambda _: None) -> Evaluation:
    """Return the exact motion, with something changed, as an engine's run."""
    return run_of(changed(exact, change))


@pytest.mark.parametrize(("degrees", "agrees"), [(0.099, True), (0.101, False)])
def test_a_tenth_of_a_degree_agrees(exact: Trajectory, degrees: float, *, agrees: bool) -> None:
    assert (
        scorecard_verdict(evaluated(exact, turn_further(exact, degrees))).status is Status.AGREES
    ) is agrees


@pytest.mark.parametrize(("share", "agrees"), [(0.0099, True), (0.0101, False)])
def test_a_hundredth_of_the_largest_phi_agrees(
    exact: Trajectory, share: float, *, agrees: bool
) -> None:
    assert (
        scorecard_verdict(evaluated(exact, lean_further(exact, share))).status is Status.AGREES
    ) is agrees


def test_what_is_allowed_of_each_quantity(exact: Trajectory) -> None:
    """A tenth of a degree, a hundredth of what there is, and the height of the far rim."""
    run = evaluated(exact)
    (bounce,) = truth(SCENE).bounces
    weight = CAN.mass * SCENE.gravity
    spendable = float(energy(exact, SCENE)[0]) - weight * CAN.half_height
    table = fidelity([run]).frame
    allowed = dict(zip(table["quantity"], table["allowed"], strict=True))
    assert allowed == pytest.approx(
        {
            "turn_error_deg": 0.1,
            "contact_locus_m": 0.01 * CAN.radius,
            "friction_ratio_error": 0.01 * bounce.peak_friction_ratio,
            "slip_m_s": 0.01 * float(np.linalg.norm(exact.velocity, axis=1).max()),
            "penetration_m": 2.0 * CAN.radius * math.sin(bounce.phi_min),
            "lift_off_fraction": 0.01,
            "energy_drift": 0.01 * spendable / (weight * CAN.radius),
        },
        rel=1e-3,  # the record has samples beside the extremum, and not at it
    )


def test_a_chaotic_run_can_be_compared_until_an_error_of_1e_5_is_a_tenth_of_a_radian(
    exact: Trajectory,
) -> None:
    chaos = Divergence(growth=1e9, lyapunov_time=2.0, parted=3.0, chaotic=True)
    assert chaos.decidable_until(1e-5) == pytest.approx(2.0 * math.log(1e4))
    assert chaos.decidable_until(0.11) == 0.0
    said = followed_best([replace(evaluated(exact), divergence=chaos, parts_at=1.5)])
    assert f"one of 1e-05 is as large as the motion after {2.0 * math.log(1e4):.2g} s" in said


@pytest.mark.parametrize(("angle", "parts"), [(0.0999, False), (0.1001, True)])
def test_motions_part_at_a_tenth_of_a_radian(
    exact: Trajectory, angle: float, *, parts: bool
) -> None:
    phi, psi, theta = angles(exact.quaternion)
    later = exact.time > 0.2

    def turn(fields: dict[str, np.ndarray]) -> None:
        fields["quaternion"] = quaternion(phi, psi, theta + angle * later)

    when = evaluated(exact, turn).parts_at
    assert when == (pytest.approx(exact.time[later][0]) if parts else None)
