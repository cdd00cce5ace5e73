"""The first correction to the outer solution: the integrals J.

phi_1'' (eq01:order1_outer) is a sum of (1 - T^2)^-i log^j(1 - T^2), T = t/sqrt(I), integrated twice
from 0. With L = log(1 - T^2), A = artanh T and P = integral of L/(1 - T^2) from 0,

    P    = (log^2(1 + T) - log^2(1 - T))/4 + log(2) A + (Li2((1 - T)/2) - Li2((1 + T)/2))/2,

    J_0  = T^2/2       J_1 = T A + L/2       J_2 = T A/2       J_3 = T^2/(8 (1 - T^2)) + 3 T A/8
    J_l0 = ((1 + T^2) L - 3 T^2 + 4 T A)/2
    J_l1 = T P + L^2/4
    J_l2 = (T P - L - T A)/2
    J_ll = T^2 L^2 + 4 T P - 4 T^2 L + 8 T^2 - 8 T A + (1 - T^2) (L^2 - 2 L + 2)/2 - 1

secA:integrals prints J_3 with the sign of its first term wrong. The logarithmic ones are derived
anew here and held to double quadrature in the tests.
"""

import numpy as np
from scipy.special import spence

from reference.reduced import Reduced
from reference.states import Floats


def integrals(T: Floats) -> dict[str, Floats]:
    """Return J_0 ... J_3, J_l0 ... J_l2 and J_ll at T in [0, 1), each of the shape of T."""
    T = np.asarray(T, dtype=float)
    L, A, T2 = np.log1p(-(T**2)), np.arctanh(T), T**2
    # Li2(z) = spence(1 - z)
    dilogarithms = spence((1 + T) / 2) - spence((1 - T) / 2)
    P = (np.log1p(T) ** 2 - np.log1p(-T) ** 2) / 4 + np.log(2) * A + dilogarithms / 2
    return {
        "J_0": T2 / 2,
        "J_1": T * A + L / 2,
        "J_2": T * A / 2,
        "J_3": T2 / (8 * (1 - T2)) + 3 * T * A / 8,
        "J_l0": ((1 + T2) * L - 3 * T2 + 4 * T * A) / 2,
        "J_l1": T * P + L**2 / 4,
        "J_l2": (T * P - L - T * A) / 2,
        "J_ll": T2 * L**2
        + 4 * T * P
        - 4 * T2 * L
        + 8 * T2
        - 8 * T * A
        + (1 - T2) * (L**2 - 2 * L + 2) / 2
        - 1,
    }


def outer_coefficients(reduced: Reduced, height: float) -> dict[str, float]:
    """Return b_0 ... b_3, b_l0 ... b_l2 and b_ll (app:b_coefficients), epsilon included.

    Parameters
    ----------
    reduced : Reduced
    height : float
        I, twice the nutation at release.
    """
    r, log = reduced, np.log(height / 2)
    return {
        "J_3": 8 * r.a_3 / height**2,
        "J_l2": 4 * r.a_l2 / height,
        "J_2": 4 * (r.a_2 + r.a_l2 * log) / height,
        "J_l1": 2 * r.a_l1,
        "J_1": 2 * (r.a_1 + r.a_l1 * log),
        "J_ll": r.a_ll * height,
        "J_l0": (r.a_l0 + 2 * r.a_ll * log) * height,
        "J_0": (r.a_0 + r.a_l0 * log + r.a_ll * log**2) * height,
    }


def outer_correction(reduced: Reduced, height: float, t: Floats) -> Floats:
    """Epsilon phi_1(t) of eq01:outer_sol, shape of `t`; t in [0, sqrt(I)) of the reduced time."""
    parts = integrals(np.asarray(t) / np.sqrt(height))
    weights = outer_coefficients(reduced, height)
    return np.asarray(sum(weights[name] * part for name, part in parts.items()))
