"""The series of precession and spin: an identity, an integration, and the printed coefficients."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from reference.integrable.frobenius import (
    can_constants,
    first_integrals,
    horner,
    precession_and_spin,
    series_of,
)
from reference.problem.can import PAPER_CAN, Parameters
from tests.support.examples import examples

CANS = [
    PAPER_CAN,
    Parameters(a=0.25, c=0.5, h=0.05),
    Parameters(a=5.6, c=0.5, h=4.0),
    Parameters(a=0.6, c=1.0, h=0.3),
]


@pytest.mark.parametrize("can", CANS)
def test_wronskian_is_one(can: Parameters) -> None:
    """The system is traceless: b2 s1 - b1 s2 = 1 up to pi/2, where 72 terms still suffice."""
    series, phi = series_of(can), np.linspace(1e-9, np.pi / 2, 50)
    b1, s1 = horner(series.b1, phi), horner(series.s1, phi)
    log = float(can_constants(can).residue) * np.log(phi)
    b2, s2 = horner(series.b2, phi) + log * b1, horner(series.s2, phi) + log * s1
    # products of series that grow like the second power of the height
    scale = np.abs(b2 * s1) + np.abs(b1 * s2)
    assert (np.abs(b2 * s1 - b1 * s2 - 1) <= 20 * np.finfo(float).eps * scale).all()


@pytest.mark.parametrize("can", CANS)
def test_series_solves_the_closed_subsystem(can: Parameters) -> None:
    """eq01:closed_subsystem as printed, integrated from pi/2 nearly down to the flat state."""
    k, h, kc = can.k, can.h, can.k * can.c_p

    def rate(phi: float, y: np.ndarray) -> list[float]:
        Psi, Theta = y
        S, C = np.sin(phi), np.cos(phi)
        return [
            (kc * Theta + ((kc - 2) * C - h * k * S) * Psi) / S,
            (
                (h * k * S - kc * C) * Theta
                + (2 - kc * C**2 - k * can.a_p * S**2 + 2 * h * k * S * C) * Psi
            )
            / S,
        ]

    run = solve_ivp(rate, (1.5, 0.01), [0.7, -0.4], method="DOP853", rtol=1e-13, atol=1e-15)
    K, B = first_integrals(
        can_constants(can), series_of(can), np.array([1.5]), np.array([0.7]), np.array([0.3])
    )
    Psi, spin = precession_and_spin(can_constants(can), series_of(can), np.array([0.01]), K, B)
    # 13 digits a step, some hundred steps
    assert Psi[0] == pytest.approx(run.y[0, -1], rel=2e-11)
    assert spin[0] - Psi[0] == pytest.approx(run.y[1, -1], rel=2e-11)


@settings(max_examples=examples(1 / 2))
@given(
    phi=st.floats(1e-3, 1.5),
    psi_dot=st.floats(-1, 1),
    spin=st.floats(-1, 1),
    other=st.floats(1e-3, 1.5),
)
def test_first_integrals_return_the_state(
    phi: float, psi_dot: float, spin: float, other: float
) -> None:
    """From any state to its constants, to another nutation, and back."""
    can, series = can_constants(PAPER_CAN), series_of(PAPER_CAN)
    here = (np.array([psi_dot]), np.array([spin]))
    constants = first_integrals(can, series, np.array([phi]), *here)
    there = precession_and_spin(can, series, np.array([other]), *constants)
    again = first_integrals(can, series, np.array([other]), *there)
    # B is a difference of terms of the size of b; K of the spin and of B times a logarithm
    size = abs(psi_dot) + abs(spin) + abs(float(there[1][0])) + abs(float(there[0][0])) * other**2
    for before, after in zip(constants, again, strict=True):
        assert abs(before[0] - after[0]) <= 200 * np.finfo(float).eps * (size + 1e-300)
