"""Steady motions and their stability.

On a steady motion phi stays (eq01:equilibrium):

    ((a_p - c_p) S C - h cos 2 phi) Psi^2 - (c_p S + h C) Theta Psi + h S - C = 0.

Psi and Theta follow phi through the closed subsystem, so of the four eigenvalues two are zero (the
two first integrals) and two are +- sqrt(d phi''/d phi), the derivative taken along that subsystem.

Where the paper is in error (each with a test):

- eq01:eigenvalues and the critical rate: h k (h + c_p) must read k (h^2 + c_p); they agree for h =
1 only;
- below eq01:bal_eqm, and for Theta_e: c Theta must read (c_p + h^2) Theta;
- below S_rest: the denominator is a S C - c h S^2, not a S C + c h S^2; and with it rest is
possible beyond the balancing angle too, where tan phi > max(1/h, a/(c h)).
"""

import numpy as np

from reference.problem.can import ParameterError, Parameters
from reference.problem.states import Floats


def steady_rotation(parameters: Parameters, phi: float, psi_dot: float) -> float:
    """Return Theta of the steady motion with given phi and Psi, not 0 (eq01:equilibrium)."""
    alpha, beta = steady_rotation_form(parameters, phi)
    return float(alpha * psi_dot + beta / psi_dot)


def steady_rotation_form(parameters: Parameters, phi: float | Floats) -> tuple[Floats, Floats]:
    """Return alpha and beta of Theta = alpha Psi + beta/Psi (eq01:equilibrium), shapes of `phi`."""
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    cross = p.c_p * S + p.h * C
    square = (p.a_p - p.c_p) * S * C - p.h * np.cos(2 * phi)
    return np.asarray(square / cross), np.asarray((p.h * S - C) / cross)


def squared_eigenvalue(
    parameters: Parameters, phi: float, psi_dot: float, theta_dot: float
) -> float:
    """Return the square of the two eigenvalues of a steady motion that are not zero.

    Positive for a saddle, negative for a centre; minus the square of the frequency of small
    oscillations. On S_bal with Psi = 0 it is that of eq01:eigenvalues, mended.
    """
    square, cross, rotation, gravity = eigenvalue_form(parameters, phi)
    form = square * psi_dot**2 + cross * psi_dot * theta_dot + rotation * theta_dot**2 + gravity
    return float(form / parameters.pendulum_inertia)


def eigenvalue_form(
    parameters: Parameters, phi: float | Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the squared eigenvalue as a form in the rates, over 1/(a_p + 1), shapes of `phi`.

    Returns
    -------
    square, cross, rotation, gravity : ndarray
        What multiplies Psi^2, Psi Theta, Theta^2 and 1. Of any state, on a steady motion or not,
        the form is (a_p + 1) d phi''/d phi along the closed subsystem (eq01:closed_subsystem).
    """
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    h, k, kc = p.h, p.k, p.k * p.c_p
    # dPsi/dphi and dTheta/dphi along the subsystem
    psi_psi, psi_theta = ((kc - 2) * C - h * k * S) / S, kc / S
    theta_psi = (2 - kc * C**2 - k * p.a_p * S**2 + 2 * h * k * S * C) / S
    theta_theta = (h * k * S - kc * C) / S
    squared, crossed = (p.a_p - p.c_p) * S * C - h * np.cos(2 * phi), p.c_p * S + h * C
    own = (p.a_p - p.c_p) * np.cos(2 * phi) + 2 * h * np.sin(2 * phi)
    return (
        np.asarray(own + 2 * squared * psi_psi - crossed * theta_psi),
        np.asarray(h * S - p.c_p * C + 2 * squared * psi_theta - crossed * (psi_psi + theta_theta)),
        np.asarray(-crossed * psi_theta),
        np.asarray(h * C + S),
    )


def critical_rolling_rate(parameters: Parameters) -> float:
    """Return |Theta| above which the balanced can rolls straight ahead without falling.

    There the eigenvalues of S_bal with Psi = 0 vanish (eq01:eigenvalues, mended).
    """
    p = parameters
    return float(np.sqrt(np.sqrt(1 + p.h**2) / (p.k * p.c_p * (p.h**2 + p.c_p))))


def balanced_rotation(parameters: Parameters, psi_dot: float) -> float:
    """Return Theta of S_bal (eq01:bal_eqm, mended): (a - c) C Psi/(c_p + h^2)."""
    p = parameters
    cosine = p.h / np.sqrt(1 + p.h**2)
    return float((p.a - p.c) * cosine * psi_dot / (p.c_p + p.h**2))


def circle_radius(parameters: Parameters, phi: float, psi_dot: float, theta_dot: float) -> float:
    """Return the radius of the circle of the centre of mass (below eq01:comcoords), in R."""
    reach = np.cos(phi) - parameters.h * np.sin(phi)
    return float(abs(reach + theta_dot / psi_dot))


def rest_rates(parameters: Parameters, phi: float) -> tuple[float, float]:
    """Return Psi > 0 and Theta of S_rest (below eq01:comrest, mended): the centre of mass rests.

    Raises
    ------
    ParameterError
        If there is no such motion at this nutation.
    """
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    reach = C - p.h * S
    square = reach / (p.a * S * C - p.c * p.h * S**2)
    if not (np.isfinite(square) and square > 0):
        sentence = f"no motion about a centre at rest at phi = {phi!r}"
        raise ParameterError("phi", phi, "where the centre can rest", sentence)
    Psi = float(np.sqrt(square))
    return Psi, float(-Psi * reach)
