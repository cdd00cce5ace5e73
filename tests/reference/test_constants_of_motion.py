"""The two constants of a bounce: the hypergeometric solution, expansions, momenta."""

import math

import mpmath as mp
import numpy as np
import pytest

from reference import PAPER_CAN, Parameters, Problem, solve
from reference.asymptotic.expansions import expansions, leading_constants, paper_constants
from reference.asymptotic.hypergeometric import gauss, hypergeometric_pair
from reference.equations.frictionless import axial_momentum, vertical_momentum
from reference.integrable.frobenius import can_constants, precession_and_spin, series_of
from reference.problem.states import States, initial_states

CANS = [
    PAPER_CAN,
    Parameters(a=0.25, c=0.5, h=0.05),
    Parameters(a=5.6, c=0.5, h=4.0),
    Parameters(a=0.6, c=1.0, h=0.5),
]
UNIT = math.sqrt(0.037 / 9.81)
PAPER = Problem(
    parameters=PAPER_CAN,
    phi=math.pi / 100,
    psi_dot=0.1001 * UNIT,
    theta_dot=-0.1 * UNIT,
    bounces=2,
)


def one_state(phi: float, psi_dot: float, theta_dot: float, can: Parameters) -> States:
    return initial_states(
        Problem(parameters=can, phi=phi, psi_dot=psi_dot, theta_dot=theta_dot, bounces=1)
    )


@pytest.mark.parametrize("can", CANS)
def test_hypergeometric_solution_is_the_series(can: Parameters) -> None:
    """Two constants fitted at two nutations hold at all others."""
    phi = np.array([0.05, 0.1, 0.3, 0.6, 1.0, 1.5])
    pairs = np.array([hypergeometric_pair(can, x) for x in phi.tolist()])
    Psi, _ = precession_and_spin(
        can_constants(can), series_of(can), phi, np.array([0.3]), np.array([0.2])
    )
    constants = np.linalg.solve(pairs[[2, 4]], Psi[[2, 4]].astype(complex))
    # sixty Taylor terms and some thirty steps
    assert np.abs(pairs @ constants / Psi - 1).max() < 1e-11


def test_gauss_function() -> None:
    a, b, c, z = 0.3 + 0.4j, 1.7 - 0.2j, 1.1 + 0.9j, 0.5 - 3j
    assert gauss(a, b, c, z) == pytest.approx(complex(mp.hyp2f1(a, b, c, z)), rel=1e-13)


def test_printed_rho_solves_nothing() -> None:
    """eq01:hyper_geom with rho = (9 + 4 gamma + 4 i beta)/16 leaves a residual like Psi itself."""
    k, h = PAPER_CAN.k, PAPER_CAN.h
    for gamma_sign, solves in ((1, False), (-1, True)):
        rho = (9 + gamma_sign * (4 * (2 + k) + 4j * k * h)) / 16
        r = complex(np.sqrt(rho))
        q = -r.conjugate()

        def term(x: mp.mpf, r: complex = r, q: complex = q) -> mp.mpc:
            cot = mp.cot(x)
            F = mp.hyp2f1(r - 0.5 + q, r + 1.5 + q, 1 + 2 * q, 0.5 - 0.5j * cot)
            return mp.sin(x) ** -1.5 * (cot + 1j) ** q * (cot - 1j) ** r * F

        with mp.workdps(30):
            x = mp.mpf("0.7")
            left = mp.diff(term, x, 2) + 3 * mp.cot(x) * mp.diff(term, x)
            left -= (2 + k + k * h * mp.cot(x)) * term(x)
            assert (abs(left / term(x)) < 1e-12) is solves


def test_printed_expansions() -> None:
    """eq01:psi_orig as printed; the appendix has the sign of its logarithm wrong."""
    p = PAPER_CAN
    kh, k, cp = p.k * p.h, p.k, p.c_p
    known = expansions(p)
    zero = [known.psi_zero.coefficient(n) for n in range(4)]
    gamma = 2 + k
    printed = [1, kh / 3, (kh**2 + 3 * gamma) / 24, kh * (kh**2 + 11 * gamma) / 360]
    assert zero == pytest.approx(printed, rel=1e-13, abs=0)
    two = known.psi_minus_two
    assert two.coefficient(-1) == pytest.approx(-kh, rel=1e-13, abs=0)
    assert two.coefficient(1) == pytest.approx(-kh * (4 + 5 * k - 2 * kh**2) / 9, rel=1e-12, abs=0)
    assert two.coefficient(0, 1) == pytest.approx(-(kh**2 - k) / 2, rel=1e-13, abs=0)
    assert two.coefficient(1, 1) == pytest.approx(-kh * (kh**2 - k) / 6, rel=1e-12, abs=0)
    theta_00 = known.spin_minus_two.coefficient(0) - two.coefficient(0)
    appendix = (3 * k * (cp + 1) - 4 - 9 * kh**2) / (6 * k * cp)
    in_text = (k * (4 * cp + 3) - 4 - 9 * kh**2) / (6 * k * cp)
    assert theta_00 == pytest.approx(appendix, rel=1e-12)
    assert abs(theta_00 - in_text) > 0.1


def test_constants_are_constant_where_their_expansions_are_not() -> None:
    """fig01:conserved: the ripples belong to the truncation, not to the motion."""
    solution = solve(PAPER, model="rolling")
    states = solution.at(solution.grid())
    B_0, B = paper_constants(states, PAPER_CAN)
    assert np.ptp(B) < 1e-12 * np.abs(B).max()
    assert np.ptp(B_0) < 1e-11 * np.abs(B_0).max()
    rough_0, rough = leading_constants(states, PAPER_CAN)
    assert np.ptp(rough) > 1e-3 * np.abs(B).max()
    assert np.ptp(rough_0) > 1e-1 * np.abs(B_0).max()


@pytest.mark.parametrize("can", CANS)
def test_axial_momentum_is_the_first_constant_of_a_flat_can(can: Parameters) -> None:
    """At finite rates B_0 tends to k c_p H_B/(2 c), linearly in phi."""
    errors = []
    for phi in SHRINKING:
        state = one_state(phi, 0.3, 0.4, can)
        B_0, _ = paper_constants(state, can)
        limit = can.k * can.c_p / (2 * can.c) * axial_momentum(state, can)
        errors.append(abs(B_0[0] - limit[0]))
    assert_linear(errors)


@pytest.mark.parametrize("can", CANS)
def test_the_momenta_differ_by_the_second_constant_of_a_flat_can(can: Parameters) -> None:
    """Where the precession grows as phi^-2, B_{-2} tends to (H_G - H_B)/a, linearly in phi."""
    errors = []
    for phi in SHRINKING:
        psi_dot = 0.3 / phi**2
        state = one_state(phi, psi_dot, 0.4 - psi_dot * math.cos(phi), can)
        _, B = paper_constants(state, can)
        limit = (vertical_momentum(state, can) - axial_momentum(state, can)) / can.a
        # B itself stays at 0.3: what vanishes is the difference of the two
        assert limit[0] == pytest.approx(0.3, rel=1e-3)
        errors.append(abs(B[0] - limit[0]))
    assert_linear(errors)


SHRINKING = (1e-3, 1e-4, 1e-5)
"""Nutations, rad, each a tenth of the one before."""


def assert_linear(errors: list[float]) -> None:
    """Hold errors at `SHRINKING` to a tenth of the one before, but for terms of higher order."""
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.1)
    assert errors[2] == pytest.approx(errors[1] / 10, rel=0.01)
