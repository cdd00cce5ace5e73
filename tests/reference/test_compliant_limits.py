"""Limits of a contact that gives way: the laws beside it, and its own compliance, vanish."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reference import PAPER_CAN, Compliance, Effects, Kind, Mass, Outcome, Problem, solve

RELEASE = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.2, theta_dot=0.3, duration=1.5)
LAW = Compliance(stiffness=1e3, damping=20.0)
TIMES = np.linspace(0.1, 1.5, 8)
# Sticks for 0.4, then slips.
LETS_GO = replace(
    RELEASE,
    phi=0.35,
    psi=0.2,
    psi_dot=0.4,
    theta_dot=-0.3,
    effects=Effects(mu=0.205, mu_static=0.21),
)


def motion(effects: Effects, release: Problem = RELEASE, law: Compliance = LAW) -> np.ndarray:
    """Return phi at some times on a contact that gives way."""
    found = solve(replace(release, effects=replace(effects, compliance=law)))
    assert found.outcome is Outcome.FINISHED
    return found.at(TIMES).phi


@pytest.mark.parametrize(
    "law",
    [
        "contour",
        "contour_damping",
        "film",
        "boundary_layer",
        "drilling",
        "rolling_resistance",
        "linear_damping",
        "angular_damping",
        "rim",
    ],
)
def test_a_weak_law_changes_a_soft_contact_in_proportion(law: str) -> None:
    none = motion(Effects())

    def change(strength: float) -> np.ndarray:
        effects = Effects(**{law: strength})  # type: ignore[arg-type] # by name
        return np.asarray(motion(effects) - none)

    one, half = change(2e-6), change(1e-6)
    # the second order is 2e-6 of the first, times some tens
    assert np.abs(one - 2 * half).max() < 1e-4 * np.abs(one).max()


def test_a_small_mass_changes_a_soft_contact_in_proportion() -> None:
    none = motion(Effects())
    one, half = (
        motion(Effects(mass=Mass(share=share, x=0.4, z=0.3))) - none for share in (2e-6, 1e-6)
    )
    assert np.abs(one - 2 * half).max() < 1e-4 * np.abs(one).max()


def test_a_small_patch_changes_a_point_that_sticks_in_proportion() -> None:
    point = motion(Effects(mu=0.5))
    one, half = (motion(Effects(mu=0.5, patch=radius)) - point for radius in (2e-4, 1e-4))
    assert np.abs(one - 2 * half).max() < 1e-3 * np.abs(one).max()


def test_static_friction_that_hardly_exceeds_the_kinetic_changes_it_by_its_square() -> None:
    """It lets go later in proportion, and for that time the force is larger in proportion."""
    kinetic = motion(replace(LETS_GO.effects, mu_static=None), LETS_GO)
    one, half = (
        motion(replace(LETS_GO.effects, mu_static=0.205 + more), LETS_GO) - kinetic
        for more in (2e-4, 1e-4)
    )
    assert one[-1] / half[-1] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize(
    ("laws", "within"),
    [
        (Effects(contour=0.01, film=2e-4), 1e-3),
        (Effects(mu=0.3, mu_static=0.35, contour_damping=1e-3, boundary_layer=1e-3), 1e-3),
        (Effects(drilling=1e-3, rolling_resistance=1e-3), 1e-3),
        # it creeps from the release on, which the vibrations of the contact do not leave alone
        (Effects(mu=0.5, patch=0.02), 0.1),
    ],
)
def test_the_rigid_can_with_the_same_laws_is_the_limit_of_a_stiff_contact(
    exponent: float, laws: Effects, within: float
) -> None:
    rigid = solve(replace(RELEASE, effects=laws))
    assert rigid.outcome is Outcome.FINISHED
    depths = np.array([1e-5, 1e-6, 1e-7])
    apart = []
    for depth in depths:
        stiffness = depth**-exponent
        damping = math.sqrt(exponent / depth) / (1 if exponent == 1 else depth**exponent)
        law = Compliance(stiffness=stiffness, damping=damping, exponent=exponent)
        apart.append(motion(laws, RELEASE, law)[-1] - rigid.at(TIMES).phi[-1])
    slopes = np.diff(np.log(np.abs(apart))) / np.diff(np.log(depths))
    assert slopes[-1] == pytest.approx(1.0, abs=within)


def test_a_release_sticks_up_to_the_static_limit_and_then_slips() -> None:
    found = solve(replace(LETS_GO, effects=replace(LETS_GO.effects, compliance=LAW)))
    assert [phase.kind for phase in found.phases][:2] == [Kind.STICK, Kind.SLIP]
