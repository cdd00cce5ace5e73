"""Steady motions are critical points of the effective potential; at folds two of them meet."""

import mpmath as mp
import numpy as np
import pytest

from reference import PAPER_CAN, Parameters
from reference.equations.bifurcation import (
    SteadyMotions,
    branches,
    effective_potential,
    folds,
    folds_at,
    states_at,
    steady_motions,
)
from reference.equations.energy import energy
from reference.equations.nonholonomic import nutation_acceleration
from reference.equations.steady_motion import (
    critical_rolling_rate,
    squared_eigenvalue,
    steady_rotation,
)
from reference.problem.states import Floats, States

UPPER = Parameters(a=0.2919, c=0.3791, h=0.5575)
K, B = -0.0559, 0.4719
"""A level of two wells."""


def some_cans(count: int) -> list[Parameters]:
    random = np.random.default_rng(7)
    made = []
    for _ in range(count):
        a, h = 10.0 ** random.uniform(-1.0, 0.7), 10.0 ** random.uniform(-1.0, 0.6)
        made.append(Parameters(a=a, c=a * random.uniform(0.1, 1.9), h=h))
    return [*made, PAPER_CAN, UPPER]


CANS = some_cans(6)


def potential(can: Parameters, phi: Floats, level: SteadyMotions, index: int) -> Floats:
    return effective_potential(can, phi, float(level.K[index]), float(level.B[index]))


def extrema(can: Parameters, K: float, B: float, ends: tuple[float, float]) -> int:
    V = effective_potential(can, np.linspace(*ends, 20001), K, B)
    return int((np.diff(np.sign(np.diff(V))) != 0).sum())


def test_the_level_of_two_wells() -> None:
    found = steady_motions(UPPER, K, B)
    assert found.stable.tolist() == [True, False, True]
    assert found.phi == pytest.approx([0.81989893, 1.44103924, 1.48636441], abs=1e-8)
    assert extrema(UPPER, K, B, (0.3, np.pi / 2)) == 3


@pytest.mark.parametrize("can", CANS)
def test_the_potential_is_the_energy_at_rest_in_phi(can: Parameters) -> None:
    phi, psi_dot, theta_dot = np.array([0.2, 0.7, 1.2]), np.array([2.0, -0.3, 0.4]), np.ones(3)
    level = states_at(can, phi, psi_dot, theta_dot)
    zero = np.zeros(3)
    states = States(
        phi=phi,
        phi_dot=zero,
        psi=zero,
        psi_dot=psi_dot,
        theta=zero,
        theta_dot=theta_dot,
        spin=psi_dot + theta_dot,
    )
    # round-off of the sum of a few terms
    assert level.energy == pytest.approx(energy(states, can), rel=1e-14, abs=0)
    for i in range(3):
        assert potential(can, phi[i : i + 1], level, i) == pytest.approx(level.energy[i], rel=1e-12)


@pytest.mark.parametrize("can", CANS)
def test_steady_motions_are_critical_points(can: Parameters) -> None:
    """By finite differences of V at fixed constants; its curvature is minus the eigenvalue."""
    phi = np.array([0.3, 0.8, 1.3])
    psi_dot = np.array([1.1, 0.6, -0.8])
    theta_dot = np.array([steady_rotation(can, *pair) for pair in zip(phi, psi_dot, strict=True)])
    level = states_at(can, phi, psi_dot, theta_dot)
    force = nutation_acceleration(phi, psi_dot, psi_dot + theta_dot, can)
    size = 1 + psi_dot**2 + np.abs(psi_dot * theta_dot)
    assert np.abs(force).max() < 1e-13 * size.max()
    step = 1e-4
    for i in range(3):
        below, at, above = potential(can, phi[i] + step * np.array([-1.0, 0.0, 1.0]), level, i)
        scale = np.abs(level.energy[i])
        # truncation: step^2 times the third derivative over six; round-off: eps over step
        assert abs(above - below) / (2 * step) < 1e-5 * scale * (1 + psi_dot[i] ** 2)
        curvature = (above - 2 * at + below) / step**2 / can.pendulum_inertia
        known = -level.squared_eigenvalue[i]
        assert curvature == pytest.approx(known, rel=1e-4, abs=1e-6 * scale)
        own = squared_eigenvalue(can, phi[i], psi_dot[i], theta_dot[i])
        assert level.squared_eigenvalue[i] == own
        near = steady_motions(can, float(level.K[i]), float(level.B[i])).phi
        assert np.abs(near - phi[i]).min() < 1e-9


@pytest.mark.parametrize("can", CANS)
def test_at_folds_two_steady_motions_meet(can: Parameters) -> None:
    """Zero eigenvalue; on one side of a fold V has two extrema more beside it than on the other."""
    phi = np.array([0.25, 0.5, 0.9, 1.2])
    seen = 0
    for sheet in folds(can, phi):
        for i in np.flatnonzero(np.isfinite(sheet.B)):
            size = 1 + sheet.psi_dot[i] ** 2 + sheet.theta_dot[i] ** 2
            assert abs(sheet.squared_eigenvalue[i]) < 1e-12 * size
            spin = sheet.psi_dot[i] + sheet.theta_dot[i]
            at, psi_dot, total = (np.array([x]) for x in (phi[i], sheet.psi_dot[i], spin))
            assert abs(nutation_acceleration(at, psi_dot, total, can)[0]) < 1e-12 * size
            # beside the fold, as far as two steady motions part by the square root of the way
            ends = (phi[i] - 0.15, phi[i] + 0.15)
            counts = [
                extrema(can, sheet.K[i], sheet.B[i] * (1 + way), ends) for way in (-1e-4, 1e-4)
            ]
            assert abs(counts[0] - counts[1]) == 2
            seen += 1
    assert seen > 0 or can.h > 2  # of tall cans folds lie below 0.25


@pytest.mark.slow
def test_a_fold_in_forty_digits() -> None:
    """V' and V'' vanish with mpmath's derivatives of V along the subsystem, without our series."""
    fold = folds(UPPER, np.array([1.45]))[0]
    with mp.workdps(40):
        a, c, h = (mp.mpf(x) for x in (UPPER.a, UPPER.c, UPPER.h))
        k = c / (a + c * (a + h * h))

        def rates(phi: mp.mpf, y: list[mp.mpf]) -> list[mp.mpf]:
            b, s = y
            T = mp.tan(phi / 2)
            M = (
                (1 + T**2)
                / 2
                * ((1 + T**2) / T - k * (c + 1) * T - 2 * h * k - k * (a + h * h) / T)
            )
            g = k * (c + 1) * T + h * k
            return [k * (c + 1) * mp.sin(phi) * s - g * b, g * s + M * b]

        start = mp.mpf(1.45)
        psi, theta = mp.mpf(float(fold.psi_dot[0])), mp.mpf(float(fold.theta_dot[0]))
        known = [mp.sin(start) ** 2 * psi, psi + theta]
        ahead = mp.odefun(rates, start, known)
        behind = mp.odefun(lambda x, y: [-d for d in rates(2 * start - x, y)], start, known)

        def V(phi: mp.mpf) -> mp.mpf:
            b, s = ahead(phi) if phi >= start else behind(2 * start - phi)
            q, w = b / mp.sin(phi), s - b / (1 + mp.cos(phi))
            return (a * q**2 + c * w**2 + (w - h * q) ** 2) / 2 + mp.sin(phi) + h * mp.cos(phi)

        step = mp.mpf("1e-6")
        above, at, below = V(start + step), V(start), V(start - step)
        # truncation: step^2 times the fourth derivative; the rates are doubles
        assert abs((above - below) / (2 * step)) < 1e-11
        assert abs((above - 2 * at + below) / step**2) < 1e-10


def test_branches_turn_back_at_folds() -> None:
    turning = folds_at(UPPER, K)
    assert np.abs(turning.K - K).max() < 1e-12
    (upper,) = np.flatnonzero((turning.phi > 1.4) & (turning.B > 0))
    phi = np.linspace(1.44, 1.49, 5001)
    low, high = branches(UPPER, phi, K)
    sheet = low if np.nanmin(np.abs(low.B - B)) < np.nanmin(np.abs(high.B - B)) else high
    furthest = np.abs(sheet.B - turning.B[upper]).argmin()
    assert phi[furthest] == pytest.approx(turning.phi[upper], abs=2e-3)
    assert sheet.B.max() == pytest.approx(turning.B[upper], abs=1e-9)
    assert (sheet.stable == (phi > turning.phi[upper])).mean() > 0.999


@pytest.mark.parametrize("can", CANS)
def test_the_slower_fold_passes_through_critical_rolling(can: Parameters) -> None:
    """At the balancing angle with Psi = 0, from one side as from the other."""
    if not can.balancing_angle < np.pi / 2 - 0.01:
        return
    near = can.balancing_angle + np.array([-1e-6, 1e-6])
    slower = folds(can, near)[0]
    assert np.sign(slower.psi_dot).tolist() == [-1.0, 1.0]
    assert np.abs(slower.theta_dot) == pytest.approx(critical_rolling_rate(can), rel=1e-4)
    assert slower.theta_dot[0] == pytest.approx(slower.theta_dot[1], rel=1e-4)


def test_the_papers_release_has_one_well() -> None:
    level = states_at(
        PAPER_CAN, np.array([np.pi / 100]), np.array([6.147e-3]), np.array([-6.141e-3])
    )
    found = steady_motions(PAPER_CAN, float(level.K[0]), float(level.B[0]))
    assert found.stable.tolist() == [True, False]
    assert found.phi[1] == pytest.approx(PAPER_CAN.balancing_angle, abs=1e-3)
