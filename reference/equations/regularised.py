"""The rolling equations without their singularity.

With T = tan(phi/2), Phi = phi', b = S^2 Psi, the spin s = Psi + Theta, and the time sigma defined
by dt = sin(phi) dsigma, the full equations (eq01:non_dimensionalised_eom) are, with S = sin phi,
m = 1 - cos phi = T S and the precession per unit of sigma q = b/S,

    T'   = T Phi
    Phi' = (q (q G - s Q) + S Z)/(a_p + 1)
    b'   = Phi (k c_p S^2 s - b M)
    s'   = Phi (s M + q W)
    d'   = S Phi
    psi' = q,    t' = S,    (psi + theta)' = S s

    G = a_p + (c_p - a_p) m - h T + 2 h S         Q = c_p S + h - h m
    W = 2 (1 - c_p k) T + k (c_p - a_p) S - 2 h k m             M = k c_p m + h k S
    Z = h S - cos phi = -sqrt(h^2 + 1) sin(D - d)

Near the balancing angle phi* gravity is a small difference of two terms. It is therefore taken from
the rise d = phi - r over the release r and from D = phi* - r, which is exact for the doubles given
(`reference.equations.balancing_angle`): a can released a picometre off balance falls when it
should.

Nothing is left that grows as phi goes to 0: a bounce is the passage T = T_min cosh, Phi = v tanh,
q = (v/kappa) sech with b and s at rest, which takes the same few units of sigma however hard it
is, and the approach to it takes log(1/T_min). The equivalence is checked in
tests/reference/test_regular.py.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt

import numpy as np

from reference.equations.balancing_angle import short_of_one
from reference.problem.can import Parameters
from reference.problem.states import Floats

TANGENT, NUTATION_RATE, SWEEP, SPIN, RISE = range(5)


@dataclass(frozen=True, slots=True, kw_only=True)
class RegularEquations:
    """The vector field of one can.

    Attributes
    ----------
    forms : ndarray, shape (7, 4)
        G/(a_p + 1), W, -Q/(a_p + 1), M and M again, the weight sqrt(h^2 + 1)/(a_p + 1) S and
        k c_p S, as linear forms in (T, S, m, 1).
    short : float
        D, how far the release is below the balancing angle.
    swing : float
        a_p/(a_p + 1), the square of the paper's kappa: in the bounce phi'^2 + swing q^2 is
        constant.
    compiled : bool
        Whether steps of these equations are taken by compiled code.
    """

    forms: Floats
    short: float
    swing: float
    compiled: bool = False


def regular_equations(
    parameters: Parameters, release: float, *, compiled: bool = False
) -> RegularEquations:
    """Return the vector field of a can for rises over the nutation `release`."""
    p = parameters
    return RegularEquations(
        forms=_forms(p),
        short=short_of_one(p.h, release),
        swing=p.a_p / p.pendulum_inertia,
        compiled=compiled,
    )


@lru_cache(maxsize=256)
def _forms(p: Parameters) -> Floats:
    """Return the linear forms of a can, which nobody writes to, shape (7, 4)."""
    h, k, a_p, c_p = p.h, p.k, p.a_p, p.c_p
    kc, hk, inertia = k * c_p, h * k, p.pendulum_inertia
    return np.array(
        [
            [-h / inertia, 2 * h / inertia, (c_p - a_p) / inertia, a_p / inertia],
            [2 - 2 * kc, kc - k * a_p, -2 * hk, 0.0],
            [0.0, -c_p / inertia, h / inertia, -h / inertia],
            [0.0, hk, kc, 0.0],
            [0.0, hk, kc, 0.0],
            [0.0, sqrt(h * h + 1) / inertia, 0.0, 0.0],
            [0.0, kc, 0.0, 0.0],
        ]
    )


def sine_of(tangent: Floats) -> Floats:
    """Return sin phi from tan(phi/2)."""
    return 2 * tangent / (1 + tangent * tangent)


def vector_field(equations: RegularEquations, y: Floats) -> Floats:
    """Rates of (T, Phi, b, s, d) in sigma.

    Parameters
    ----------
    equations : RegularEquations
    y : ndarray, shape (5, n)

    Returns
    -------
    ndarray, shape (5, n)
    """
    T, Phi, b, s, rise = y
    # as few operations on as large arrays as there can be: they cost the same up to a hundred nodes
    basis = np.empty((4, y.shape[1]))
    basis[0] = T
    S = T * T
    S += 1
    np.divide(T, S, out=S)
    S *= 2
    basis[1] = S
    np.multiply(T, S, out=basis[2])
    basis[3] = 1.0
    forms = equations.forms @ basis
    q = b / S
    out = np.empty_like(y)
    # T' and d'
    np.multiply(basis[:2], Phi, out=out[::4])
    # q G - s Q, and q W + s M
    forms[:2] *= q
    forms[2:4] *= s
    forms[:2] += forms[2:4]
    weight = equations.short - rise
    np.sin(weight, out=weight)
    weight *= forms[5]
    forms[0] *= q
    np.subtract(forms[0], weight, out=out[1])
    # k c_p S^2 s - b M
    S *= s
    S *= forms[6]
    forms[4] *= b
    np.subtract(S, forms[4], out=forms[2])
    # s' and b'
    np.multiply(forms[1:3], Phi, out=out[3:1:-1])
    return out
