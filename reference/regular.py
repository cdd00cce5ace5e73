"""The rolling equations without their singularity.

With T = tan(phi/2), Phi = phi', b = S^2 Psi, the spin s = Psi + Theta, and the time sigma defined
by dt = sin(phi) dsigma, the full equations (eq01:non_dimensionalised_eom) are, with S = sin phi,
m = 1 - cos phi = T S and the precession per unit of sigma q = b/S,

    T'   = T Phi
    Phi' = (q (q G - s Q) + S Z)/(a_p + 1)
    b'   = Phi (k c_p S^2 s - b M)
    s'   = Phi (s M + q W)
    d'   = -S Phi
    psi' = q,    t' = S,    (psi + theta)' = S s

    G = a_p + (c_p - a_p) m - h T + 2 h S         Q = c_p S + h - h m
    W = 2 (1 - c_p k) T + k (c_p - a_p) S - 2 h k m             M = k c_p m + h k S
    Z = h S - cos phi = -sqrt(h^2 + 1) sin(D + d)

Gravity is what is left of two terms beside the balancing angle phi*. It is therefore taken from the
drop d = r - phi below the release r and from D = phi* - r, which is exact for the doubles given
(`reference.balance`): a can released a picometre off balance falls when it should.

Nothing is left that grows as phi goes to 0: a bounce is the passage T = T_min cosh, Phi = v tanh,
q = (v/kappa) sech with b and s at rest, which takes the same few units of sigma however hard it
is, and the approach to it takes log(1/T_min). The equivalence is checked in
tests/reference/test_regular.py.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from reference.balance import short_of_balance
from reference.parameters import Parameters
from reference.states import Floats

TANGENT, NUTATION_RATE, SWEEP, SPIN, DROP = range(5)


@dataclass(frozen=True, slots=True, kw_only=True)
class RegularEquations:
    """The vector field of one can.

    Attributes
    ----------
    forms : ndarray, shape (4, 4)
        G and Q over a_p + 1, M and W, as linear forms in (T, S, m, 1).
    short : float
        D, how far the release is below the balancing angle.
    pull : float
        sqrt(h^2 + 1)/(a_p + 1), of which gravity is the sine of D + d.
    axial : float
        k c_p.
    swing : float
        a_p/(a_p + 1), the square of the paper's kappa: in the bounce phi'^2 + swing q^2 is
        constant.
    """

    forms: Floats
    short: float
    pull: float
    axial: float
    swing: float


def regular_equations(parameters: Parameters, release: float) -> RegularEquations:
    """Return the vector field of a can for drops below the nutation `release`."""
    p = parameters
    h, k, a_p, c_p = p.h, p.k, p.a_p, p.c_p
    kc, hk, inertia = k * c_p, h * k, p.pendulum_inertia
    forms = np.array(
        [
            [-h / inertia, 2 * h / inertia, (c_p - a_p) / inertia, a_p / inertia],
            [0.0, c_p / inertia, -h / inertia, h / inertia],
            [0.0, hk, kc, 0.0],
            [2 - 2 * kc, kc - k * a_p, -2 * hk, 0.0],
        ]
    )
    return RegularEquations(
        forms=forms,
        short=float(short_of_balance(np.asarray(h), np.asarray(release))),
        pull=sqrt(h * h + 1) / inertia,
        axial=kc,
        swing=a_p / inertia,
    )


def sine_of(tangent: Floats) -> Floats:
    """Return sin phi from tan(phi/2)."""
    return 2 * tangent / (1 + tangent * tangent)


def field(equations: RegularEquations, y: Floats) -> Floats:
    """Rates of (T, Phi, b, s, d) in sigma.

    Parameters
    ----------
    equations : RegularEquations
    y : ndarray, shape (5, n)

    Returns
    -------
    ndarray, shape (5, n)
    """
    T, Phi, b, s, drop = y
    basis = np.empty((4, y.shape[1]))
    basis[0] = T
    S = T * T
    S += 1
    np.divide(T, S, out=S)
    S *= 2
    basis[1] = S
    np.multiply(T, S, out=basis[2])
    basis[3] = 1.0
    G, Q, M, W = equations.forms @ basis
    q = b / S
    out = np.empty_like(y)
    np.multiply(T, Phi, out=out[0])
    np.multiply(S, Phi, out=out[4])
    np.negative(out[4], out=out[4])
    G *= q
    Q *= s
    G -= Q
    G *= q
    drop = drop + equations.short
    np.sin(drop, out=drop)
    drop *= S
    drop *= equations.pull
    np.subtract(G, drop, out=out[1])
    W *= q
    S *= S
    S *= s
    S *= equations.axial
    S -= b * M
    np.multiply(S, Phi, out=out[2])
    M *= s
    M += W
    np.multiply(M, Phi, out=out[3])
    return out
