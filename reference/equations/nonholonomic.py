"""Rolling without slipping: the full nonholonomic equations.

Equations (eq01:non_dimensionalised_eom) of Collins, Hall and Hogan, arXiv:2302.08335, with S = sin
phi, C = cos phi, Phi = phi', Psi = psi', Theta = theta':

    Psi' S           = k c_p Phi Theta + ((k c_p - 2) C - h k S) Phi Psi
    Theta' S         = (-k c_p C + h k S) Phi Theta
                       + (-k c_p C^2 - k a_p S^2 + 2 h k S C + 2) Phi Psi
    Phi' (a_p + 1)   = ((a_p - c_p) S C - h cos 2 phi) Psi^2 - (c_p S + h C) Theta Psi + h S - C

They are right as printed: they are rederived from Newton-Euler in
tests/reference/test_derivation.py.

Singular at phi = 0, where the can stands flat: there Psi and Theta are of order 1/phi^2 and
opposite. The terms are therefore gathered with the spin s = Psi + Theta, which stays finite, so
that nothing cancels; the equations are the same.
"""

from math import sin

import numpy as np

from reference.problem.can import Parameters
from reference.problem.problem import Problem
from reference.problem.states import Floats, States

# The force on phi is a sum of some ten rounded terms.
ROUND_OFFS = 16
EPS = float(np.finfo(float).eps)


def nutation_acceleration(
    phi: Floats | float, psi_dot: Floats | float, spin: Floats | float, parameters: Parameters
) -> Floats:
    """Phi'' from eq01:Phi, written with the spin.

    Parameters
    ----------
    phi, psi_dot, spin : ndarray, shape (n,) or float
        Nutation, precession rate, and psi' + theta'.
    parameters : Parameters

    Returns
    -------
    ndarray, shape (n,)
    """
    trigonometry = np.sin(phi), np.cos(phi), 2 * np.sin(phi / 2) ** 2
    return pulled(trigonometry, psi_dot, spin, parameters)


def pulled(
    trigonometry: tuple[Floats, Floats, Floats],
    psi_dot: Floats | float,
    spin: Floats | float,
    parameters: Parameters,
) -> Floats:
    """Phi'' as `nutation_acceleration`, from sin phi, cos phi and 1 - cos phi."""
    p = parameters
    S, C, one_minus_C = trigonometry
    square = p.a_p * S * C + (p.c_p * S + p.h * (1 + 2 * C)) * one_minus_C
    drive = square * (psi_dot * psi_dot) - (p.c_p * S + p.h * C) * spin * psi_dot + p.h * S - C
    return np.asarray(drive / p.pendulum_inertia, dtype=float)


def stands_still(problem: Problem, fall: float) -> bool:
    """Return whether a release of given phi'' rests and nothing but round-off makes phi move."""
    if problem.phi_dot != 0:
        return False
    p, S = problem.parameters, sin(problem.phi)
    spin = problem.psi_dot + problem.theta_dot
    force = p.pendulum_inertia * fall
    q = S * problem.psi_dot
    terms = 1 + (q * q * (1 + p.a_p) + abs(q * spin)) / S
    return bool(abs(force) <= ROUND_OFFS * EPS * terms)


def accelerations(states: States, parameters: Parameters) -> tuple[Floats, Floats, Floats]:
    """Second derivatives of the three angles.

    Parameters
    ----------
    states : States
        Fields of shape (n,).
    parameters : Parameters

    Returns
    -------
    phi'', psi'', theta'' : ndarray, shape (n,)
    """
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    Psi, s = states.psi_dot, states.spin
    rate = states.phi_dot / S
    one_minus_C = 2 * np.sin(states.phi / 2) ** 2
    psi_ddot = rate * (p.k * p.c_p * s - Psi * (2 * C + p.k * p.c_p * one_minus_C + p.h * p.k * S))
    spin_ddot = rate * (
        s * p.k * (p.c_p * one_minus_C + p.h * S)
        + Psi * one_minus_C * (2 - p.k * (p.c_p * one_minus_C + 2 * p.h * S + p.a_p * (1 + C)))
    )
    return (
        nutation_acceleration(states.phi, Psi, s, p),
        psi_ddot,
        spin_ddot - psi_ddot,
    )


def angular_velocity(states: States) -> Floats:
    """Angular velocity in the body-aligned frame B (without the rotation theta), shape (n, 3).

    (Psi sin phi, -Phi, Psi cos phi + Theta): the axes of the text under eq01:n2l_rot.
    """
    axial = states.spin - states.psi_dot * 2 * np.sin(states.phi / 2) ** 2
    return np.stack([states.psi_dot * np.sin(states.phi), -states.phi_dot, axial], axis=-1)
