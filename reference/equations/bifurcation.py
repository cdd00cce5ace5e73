"""Steady motions at given first integrals: the effective potential, its critical points, its folds.

Rolling conserves the two linear constants (K, B) of `reference.integrable.frobenius` and the energy
E. On a level of (K, B) precession and spin are functions of nutation, and energy leaves a motion in
one dimension,

    (a_p + 1)/2 phi'^2 + V(phi; K, B) = E,
    V = (a q^2 + c w^2 + (w - h q)^2)/2 + S + h C,    q = Psi S,  w = Psi C + Theta,

the *effective potential* V. A steady motion (eq01:equilibrium) is a critical point of it, since the
derivative of V along a level is -(a_p + 1) phi''; it is a centre at a minimum and a saddle at a
maximum, as the square of its eigenvalue (eq01:eigenvalues) is -V''/(a_p + 1).

All steady motions form a surface over (phi, Psi), for Theta follows from eq01:equilibrium:

    Theta = alpha Psi + beta/Psi,    alpha = ((a_p - c_p) S C - h cos 2 phi)/(c_p S + h C),
                                     beta  = (h S - C)/(c_p S + h C).

Its map to the constants (K, B) *folds* where V'' = 0 as well: there a centre and a saddle meet, and
on one side of the fold there are two steady motions more, that is a second well, than on the other.
V'' is a quadratic form in (Psi, Theta) plus gravity, so that with the above

    Psi^2 V'' = P Psi^4 + Q Psi^2 + R,

a quadratic equation in Psi^2 at each nutation: all folds are known without a search. The paper
finds the steady motions and their eigenvalues, and neither the folds nor the second well.

Changing the sign of Psi and Theta together reflects a motion, and the signs of K and B with it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.equations.steady_motion import eigenvalue_form, steady_rotation_form
from reference.integrable.effective_potential import nutation_force
from reference.integrable.frobenius import (
    can_constants,
    first_integrals,
    precession_and_spin,
    series_of,
)
from reference.numerics.rootfinding import bracketed_roots
from reference.problem.can import Parameters
from reference.problem.states import Floats

# Where critical points are looked for: so many nutations, evenly and by their logarithm.
SAMPLES = 1024
UPRIGHT = np.pi / 2
# Next to the flat state (a_p + 1) phi'' = a_p B^2/phi^3 - 1 to leading order: below this share of
# where it vanishes nothing does.
BELOW = 1e-3
FLATTEST = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadyMotions:
    """Steady motions of a can, each field of shape (n,); NaN where there is none.

    Attributes
    ----------
    phi, psi_dot, theta_dot : ndarray
        rad and sqrt(g/R).
    K, B : ndarray
        First integrals.
    energy : ndarray
        Over m g R.
    squared_eigenvalue : ndarray
        Negative of a centre, positive of a saddle, zero of a fold.
    """

    phi: Floats
    psi_dot: Floats
    theta_dot: Floats
    K: Floats
    B: Floats
    energy: Floats
    squared_eigenvalue: Floats

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Where the motion is a centre, at the bottom of a well."""
        return np.asarray(self.squared_eigenvalue < 0)


def states_at(
    parameters: Parameters, phi: Floats, psi_dot: Floats, theta_dot: Floats
) -> SteadyMotions:
    """Return the level and the eigenvalue of states at rest in phi, shapes (n,)."""
    spin = psi_dot + theta_dot
    K, B = first_integrals(can_constants(parameters), series_of(parameters), phi, psi_dot, spin)
    return SteadyMotions(
        phi=phi,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        K=K,
        B=B,
        energy=_potential(parameters, phi, psi_dot, spin),
        squared_eigenvalue=_form(parameters, phi, psi_dot, theta_dot) / parameters.pendulum_inertia,
    )


def effective_potential(parameters: Parameters, phi: Floats, K: float, B: float) -> Floats:
    """Return V over m g R on a level of the first integrals (K, B), shape of `phi`."""
    psi_dot, spin = _rates(parameters, phi, K, B)
    return _potential(parameters, phi, psi_dot, spin)


def steady_motions(parameters: Parameters, K: float, B: float) -> SteadyMotions:
    """Return all steady motions on a level of the first integrals, by increasing nutation.

    Between two roots of V'' there is one root of V' at most: with those of V'' among the samples
    two critical points are distinguished however near to each other they are.
    """
    can = parameters
    flat = max(BELOW * (can.a_p * B * B) ** (1 / 3), FLATTEST)
    log = np.geomspace(min(flat, UPRIGHT / 2), UPRIGHT, SAMPLES)
    phi = np.union1d(log, np.linspace(log[0], UPRIGHT, SAMPLES))

    def force(x: Floats) -> Floats:
        return _force(can, x, K, B)

    def bend(x: Floats) -> Floats:
        psi_dot, spin = _rates(can, x, K, B)
        return _form(can, x, psi_dot, spin - psi_dot)

    phi = np.union1d(phi, _roots(bend, phi))
    at = _roots(force, phi)
    psi_dot, spin = _rates(can, at, K, B)
    return states_at(can, at, psi_dot, spin - psi_dot)


def folds(parameters: Parameters, phi: Floats) -> tuple[SteadyMotions, SteadyMotions]:
    """Return the folds at given nutations: the slower and the faster, shapes (n,).

    Both have Psi > 0 but for the slower one below the balancing angle: at that angle it is the can
    that rolls straight ahead at the critical rate, with Psi = 0, and so it is continuous there.
    """
    square, cross, rotation, gravity = eigenvalue_form(parameters, phi)
    alpha, beta = steady_rotation_form(parameters, phi)
    P = square + cross * alpha + rotation * alpha**2
    Q = (cross + 2 * rotation * alpha) * beta + gravity
    R = rotation * beta**2
    root = np.sqrt(np.where((inside := Q**2 - 4 * P * R) >= 0, inside, np.nan))
    with np.errstate(divide="ignore", invalid="ignore"):
        # no difference of near numbers: one root from the sum, the other from the product
        q = -(Q + np.copysign(root, Q)) / 2
        pair = np.sort(np.where((both := np.stack((q / P, R / q))) > 0, both, np.nan), 0)
        slow, fast = np.sqrt(pair)
        slow = np.copysign(slow, phi - parameters.balancing_angle)
        pair_of_folds = [
            states_at(parameters, phi, rate, alpha * rate + beta / rate) for rate in (slow, fast)
        ]
    return pair_of_folds[0], pair_of_folds[1]


def folds_at(parameters: Parameters, K: float) -> SteadyMotions:
    """Return the folds with a given first integral K, shape (n,): where its branches turn back."""
    phi, folds_met = np.linspace(0.0, UPRIGHT, SAMPLES + 1)[1:], []
    for number in (0, 1):
        for sign in (1.0, -1.0):

            def excess(x: Floats, number: int = number, sign: float = sign) -> Floats:
                return sign * folds(parameters, x)[number].K - K

            at = _roots(excess, phi)
            fold = folds(parameters, at)[number]
            folds_met.append(states_at(parameters, at, sign * fold.psi_dot, sign * fold.theta_dot))
    return SteadyMotions(
        **{
            name: np.concatenate([getattr(fold, name) for fold in folds_met])
            for name in SteadyMotions.__slots__
        }
    )


def force_form(parameters: Parameters, phi: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the coefficients of K^2, K B, B^2 and 1 in minus the slope of V, shapes of `phi`."""
    gravity = _force(parameters, phi, 0.0, 0.0)
    own, other = (_force(parameters, phi, *pair) - gravity for pair in ((1.0, 0.0), (0.0, 1.0)))
    mixed = _force(parameters, phi, 1.0, 1.0) - gravity - own - other
    return own, mixed, other, gravity


def branches(parameters: Parameters, phi: Floats, K: float) -> tuple[SteadyMotions, SteadyMotions]:
    """Return the steady motions at given nutations with one first integral fixed.

    The force on phi is a quadratic form in (K, B) plus gravity: at each nutation two values of B
    make it vanish, or none. Along a branch B turns back at the folds.

    Returns
    -------
    tuple of SteadyMotions
        Of the smaller and of the larger B, shapes (n,); NaN where there is none.
    """
    own, mixed, other, gravity = force_form(parameters, phi)
    inside = (mixed * K) ** 2 - 4 * other * (own * K**2 + gravity)
    root = np.sqrt(np.where(inside >= 0, inside, np.nan))
    pair = np.sort(np.stack([(-mixed * K + sign * root) / (2 * other) for sign in (-1, 1)]), 0)
    branch_pair = []
    for B in pair:
        psi_dot, spin = _rates(parameters, phi, K, B)
        branch_pair.append(states_at(parameters, phi, psi_dot, spin - psi_dot))
    return branch_pair[0], branch_pair[1]


def _rates(
    parameters: Parameters, phi: Floats, K: float, B: float | Floats
) -> tuple[Floats, Floats]:
    return precession_and_spin(
        can_constants(parameters), series_of(parameters), phi, np.asarray(K), np.asarray(B)
    )


def _force(parameters: Parameters, phi: Floats, K: float, B: float) -> Floats:
    """Return (a_p + 1) phi'', minus the derivative of V."""
    psi_dot, spin = _rates(parameters, phi, K, B)
    return nutation_force(can_constants(parameters), np.sin(phi) ** 2 * psi_dot, spin, phi)


def _form(parameters: Parameters, phi: Floats, psi_dot: Floats, theta_dot: Floats) -> Floats:
    """Return minus the second derivative of V."""
    square, cross, rotation, gravity = eigenvalue_form(parameters, phi)
    form = square * psi_dot**2 + cross * psi_dot * theta_dot + rotation * theta_dot**2 + gravity
    return np.asarray(form)


def _potential(parameters: Parameters, phi: Floats, psi_dot: Floats, spin: Floats) -> Floats:
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    q, w = psi_dot * S, spin - 2 * np.sin(phi / 2) ** 2 * psi_dot
    return np.asarray((p.a * q**2 + p.c * w**2 + (w - p.h * q) ** 2) / 2 + S + p.h * C)


def _roots(f: Callable[[Floats], Floats], at: Floats) -> Floats:
    """Return the roots of a function between samples of different sign; NaN has none."""
    values = f(at)
    change = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    exact: Floats = at[values == 0]
    if not change.size:
        return exact
    return np.asarray(np.union1d(exact, bracketed_roots(f, at[change], at[change + 1])))
