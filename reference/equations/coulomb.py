"""Rolling and slipping of an axisymmetric can with Coulomb friction.

Newton and Euler for the can of mass 1 about its centre, in frame B, the contact at p = (-1, 0, -h)
from it, with S = sin phi, C = cos phi, reach R = C - h S, height Z = S + h C and the force of the
plane (F1, F2, N) along (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical:

    a w1' = (a - c) w2 w3 + h F2
    a w2' = (c - a) w1 w3 + R N - Z F1          (' in space)
    c w3' = -F2

While the rim sticks its material rests at the contact and the force is whatever that takes
(eq01:n2l_rot, eq01:constraint: the four equations of rolling); it may stick while |F| <= mu N. Once
it slips with velocity u, F = -mu N u/|u|, and N is what keeps the rim on the plane:

    N (1 + R (R + mu u1 Z/|u|)/a) = 1 + R (a - c) w1 w3/a - z.(w x dp/dt),

six equations with those of the slip. Where the bracket is not positive rigid sliding has no
solution or more than one (Painleve). The paper's appendix on slipping treats mu = 0, where both
momenta are conserved; no equation of it is used here. Everything is times S, in the time of
`reference.equations.state_vector`.
"""

from dataclasses import dataclass

import numpy as np

from reference.equations.contact_laws import Contact, Mode
from reference.equations.frames import length
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    PSI,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
    Angles,
    Index,
    X,
    Y,
)
from reference.problem.can import Parameters
from reference.problem.states import Floats

STICKING = np.array([LEAN, W1, W2, W3])
SLIPPING = np.array([LEAN, W1, W2, W3, U1, U2])


@dataclass(frozen=True, slots=True, kw_only=True)
class CoulombEquations:
    """The two vector fields of one can.

    Attributes
    ----------
    parameters : Parameters
    mu : float
        Infinite for a rim that never slips.
    only_pushes : bool
        Whether the plane never pulls, also where the rim never slips.
    static : float or None
        Coefficient up to which the rim sticks; None is `mu`.
    """

    parameters: Parameters
    mu: float
    only_pushes: bool = False
    static: float | None = None

    @property
    def mu_static(self) -> float:
        """Coefficient of friction up to which the rim sticks."""
        return self.mu if self.static is None else self.static

    @property
    def patch(self) -> float:
        """A point: turning about the normal meets no friction."""
        return 0.0

    @property
    def contour(self) -> float:
        """No friction along the rim."""
        return 0.0

    @property
    def fluid(self) -> bool:
        """Nothing else opposes motion along the rim."""
        return False

    @property
    def drilling(self) -> float:
        """No arm: turning about the normal meets no friction."""
        return 0.0

    @property
    def resistance(self) -> float:
        """No arm: rolling meets no resistance."""
        return 0.0

    @property
    def bilateral_normal(self) -> bool:
        """Return whether the plane may pull: under a rim that never slips, the ideal can."""
        return bool(np.isinf(self.mu)) and not self.only_pushes

    def turning(self, y: Floats) -> Floats:
        """Return the angular velocity about the normal, shape (n,)."""
        at = Angles.of(y[LEAN])
        return np.asarray(at.S * y[W1] + at.C * y[W3])

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on; the others are quadratures."""
        return SLIPPING if mode.slips else STICKING

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return the force of the plane, times S, and the accelerations that it causes."""
        return self._slipping(y) if mode.slips else self._sticking(y)

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (13, n); zero without `along` of what nothing needs."""
        at, contact = Angles.of(y[LEAN]), self.contact(y, mode)
        w1, w2, w3 = y[W1], y[W2], y[W3]
        rotation = at.S * w3 - at.C * w1  # theta' S
        out = np.zeros_like(y)
        out[LEAN] = -w2
        out[W1] = contact.turning[0] - rotation * w2
        out[W2] = contact.turning[1] + rotation * w1
        out[W3] = contact.turning[2]
        out[PSI], out[TOTAL], out[TIME] = w1, at.S * (w3 + at.T * w1), at.S
        u1, u2 = y[U1], y[U2]
        if mode.slips:
            out[U1] = contact.slipping[0] + w1 * u2
            out[U2] = contact.slipping[1] - w1 * u1
        if not along:
            return out
        ahead, aside = np.zeros_like(w1), rotation
        if mode.slips:
            ahead, aside = at.S * u1, at.S * u2 + rotation
            out[DISSIPATED] = -(contact.force[0] * u1 + contact.force[1] * u2)
        cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
        out[X], out[Y] = ahead * cos - aside * sin, ahead * sin + aside * cos
        return out

    def _sticking(self, y: Floats) -> Contact:
        p, at = self.parameters, Angles.of(y[LEAN])
        w1, w2, w3 = y[W1], y[W2], y[W3]
        k1, k2, k3 = _inertial(p, at, w1, w2, w3)
        e1, e2, e3 = at.S * at.S - k1, -k2, at.S * at.C - k3
        b1 = at.S * (p.a - p.c) * w2 * w3 + p.h * e2
        b2 = at.S * (p.c - p.a) * w1 * w3 - p.h * e1 + e3
        b3 = -e2
        det = p.a_p * p.c_p - p.h * p.h
        a1, a2, a3 = (
            (p.c_p * b1 + p.h * b3) / det,
            b2 / p.pendulum_inertia,
            (p.h * b1 + p.a_p * b3) / det,
        )
        F1b, F2, F3b = p.h * a2 + e1, a3 - p.h * a1 + e2, e3 - a2
        force = np.array([at.C * F1b - at.S * F3b, F2, at.S * F1b + at.C * F3b])
        zero = np.zeros_like(w1)
        return Contact(
            force=force,
            moment=np.array([zero, zero, zero]),
            turning=np.array([a1, a2, a3]),
            slipping=np.array([zero, zero]),
            normal_mobility=zero + 1,
        )

    def _slipping(self, y: Floats) -> Contact:
        p, at = self.parameters, Angles.of(y[LEAN])
        w1, w2, w3 = y[W1], y[W2], y[W3]
        speed = length(y[U1], y[U2])
        n1, n2 = self.mu * y[U1] / speed, self.mu * y[U2] / speed
        reach, height = at.C - p.h * at.S, at.S + p.h * at.C
        k1, k2, k3 = _inertial(p, at, w1, w2, w3)
        own = at.S * (p.c - p.a) * w1 * w3 / p.a
        normal_mobility = 1 + reach * (reach + n1 * height) / p.a
        N = (at.S - reach * own - (at.S * k1 + at.C * k3)) / normal_mobility
        F1, F2 = -N * n1, -N * n2
        a1 = at.S * (p.a - p.c) * w2 * w3 / p.a + p.h * F2 / p.a
        a2 = own + (reach * N - height * F1) / p.a
        a3 = -F2 / p.c
        u1 = F1 - height * a2 + (at.C * k1 - at.S * k3)
        u2 = F2 - (a3 - p.h * a1) + k2
        zero = np.zeros_like(w1)
        return Contact(
            force=np.array([F1, F2, N]),
            moment=np.array([zero, zero, zero]),
            turning=np.array([a1, a2, a3]),
            slipping=np.array([u1, u2]),
            normal_mobility=normal_mobility,
        )


def _inertial(
    p: Parameters, at: Angles, w1: Floats, w2: Floats, w3: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return w x dp/dt times S in frame B: the part of the contact's motion through the body."""
    q1, q2, q3 = -at.S * p.h * w2, w1 * (p.h * at.S - at.C), at.S * w2
    return w2 * q3 - w3 * q2, w3 * q1 - w1 * q3, w1 * q2 - w2 * q1
