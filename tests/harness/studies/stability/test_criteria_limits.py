"""Numbers that the stability page cites of its verdicts, just inside and just outside each.

They are written out here as the docstrings have them, and not imported: whoever changes one in the
code is told which sentence no longer holds.
"""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.trajectory import Trajectory
from harness.engines.reference.truth import truth
from harness.metrics.energy import energy
from harness.metrics.motion import Motion, motion
from harness.studies.stability.failure_criteria import StabilityStatus, classify, stuck_flat
from models import Horizon, Scene, quaternion
from models.kinematics import angles
from tests.support.changed_motions import (
    SCENE,
    Change,
    changed,
    exact_trajectory,
    lean_further,
    run_of,
    turn_further,
)
from tests.support.trajectories import make_trajectory

CAN = SCENE.can


def verdict(exact: Trajectory, change: Change, scene: Scene = SCENE) -> tuple[StabilityStatus, str]:
    """Return the verdict on the exact motion with something changed, and what it rests on."""
    found = classify(run_of(changed(exact, change), scene))
    return found.verdict, found.symptom.words


@pytest.mark.parametrize(("share", "tunnels"), [(0.0999, False), (0.1001, True)])
def test_a_can_tunnels_from_a_tenth_of_its_radius_on(
    exact: Trajectory, share: float, *, tunnels: bool
) -> None:
    def sink(fields: dict[str, np.ndarray]) -> None:
        fields["position"][:, 2] -= share * CAN.radius

    assert (verdict(exact, sink)[0] is StabilityStatus.TUNNELS) is tunnels


@pytest.mark.parametrize(
    ("sign", "name"), [(1.0, StabilityStatus.GAINS), (-1.0, StabilityStatus.DISSIPATES)]
)
@pytest.mark.parametrize(("share", "seen"), [(0.0499, False), (0.0501, True)])
def test_a_twentieth_of_what_there_is_to_spend_is_seen(
    exact: Trajectory, sign: float, name: StabilityStatus, share: float, *, seen: bool
) -> None:
    # over the can that lies flat: it is released nearer to that than to its side
    weight = CAN.mass * SCENE.gravity
    spendable = float(energy(exact, SCENE)[0]) - weight * CAN.half_height

    def lift(fields: dict[str, np.ndarray]) -> None:
        fields["position"][-1, 2] += sign * share * spendable / weight

    assert (verdict(exact, lift)[0] is name) is seen


@pytest.mark.parametrize(("share", "accurate"), [(0.0099, True), (0.0101, False)])
def test_phi_is_accurate_to_a_hundredth_of_its_largest(
    exact: Trajectory, share: float, *, accurate: bool
) -> None:
    found, words = verdict(exact, lean_further(exact, share))
    assert (found is StabilityStatus.ACCURATE) is accurate
    assert "phi" in words


@pytest.mark.parametrize(("degrees", "accurate"), [(1.98, True), (2.02, False)])
def test_a_turn_is_accurate_to_two_degrees(
    exact: Trajectory, degrees: float, *, accurate: bool
) -> None:
    found, words = verdict(exact, turn_further(exact, degrees))
    assert (found is StabilityStatus.ACCURATE) is accurate
    assert "turn" in words


@pytest.mark.parametrize(("share", "missing"), [(0.979, True), (0.981, False)])
def test_a_bounce_is_missing_that_ends_before_98_percent_of_the_motion(
    share: float, *, missing: bool
) -> None:
    end = truth(SCENE).bounces[0].end
    scene = replace(SCENE, horizon=Horizon(seconds=end / share))
    exact = exact_trajectory(scene)

    def stay(fields: dict[str, np.ndarray]) -> None:
        # it goes on to rise where the maximum would end the bounce, by a millionth of a radian
        last = int(np.flatnonzero(exact.time < end)[-1])
        for name in set(fields) - {"time"}:
            fields[name][last:] = fields[name][last]
        phi, psi, theta = angles(fields["quaternion"])
        rising = np.clip(np.linspace(-last, len(phi) - last, len(phi)), 0.0, None)
        fields["quaternion"] = quaternion(phi + 1e-6 * rising / len(phi), psi, theta)

    found, words = verdict(exact, stay, scene)
    assert (found is StabilityStatus.ACCURATE) is not missing
    assert ("bounces missing" in words) is missing


def leaning(*phi: float, last: float = 1.0) -> Motion:
    """Return a motion that leans so far at even times from 0 on."""
    tilts = np.array(phi)
    zero = np.zeros(len(tilts))
    record = make_trajectory(
        len(tilts),
        time=np.linspace(0.0, last, len(tilts)),
        quaternion=quaternion(tilts, zero, zero),
    )
    return motion(record, SCENE)


def flat(own: Motion, true: Motion | None, scene: Scene = SCENE) -> bool:
    case = Case(scene=scene, engine="mujoco")
    run = SimpleNamespace(motion=own, simulation=SimpleNamespace(case=case))
    return stuck_flat(run, true) is not None  # type: ignore[arg-type]


@pytest.mark.parametrize(("share", "lies"), [(0.0499, True), (0.0501, False)])
def test_below_a_twentieth_of_the_largest_phi_a_can_is_flat(share: float, *, lies: bool) -> None:
    own = leaning(0.4, 0.4 * share, 0.4 * share)
    assert flat(own, leaning(0.4, 0.01, 0.4)) is lies


@pytest.mark.parametrize(("share", "rises"), [(0.499, False), (0.501, True)])
def test_above_half_of_the_largest_phi_the_exact_motion_is_not_flat(
    share: float, *, rises: bool
) -> None:
    own = leaning(0.4, 0.001, 0.001)
    assert flat(own, leaning(0.4, 0.01, 0.4 * share)) is rises


@pytest.mark.parametrize(("share", "lies"), [(0.99, False), (1.01, True)])
def test_without_an_exact_motion_a_can_is_flat_after_a_natural_time(
    share: float, *, lies: bool
) -> None:
    lasting = share * math.sqrt(CAN.radius / SCENE.gravity)
    own = leaning(0.4, 0.001, 0.001, last=2.0 * lasting)
    assert flat(own, None) is lies
