"""Newton and Euler for a can on a contact that gives way.

The rim's lowest point is d deep in the plane, and the normal force over m g is

    N = max(0, k d + b d')          n = 1, a linear spring and damper (Kelvin and Voigt)
    N = max(0, d^n (k + b d'))      1 < n <= 2, Hertz's contact for n = 3/2, its damping after
                                    K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440

The lowest point of the rim is a minimum over the rim, so that its height changes with the velocity
of the material that is there: d' = -u_z, exactly, however fast the contact runs round the rim. The
equations are those of `reference.equations.newton_euler` with two rows more, d and u_z; N follows
from the state where it was the reaction that holds u_z, and u_z' from N:

    (w', u') = (w', u')_free + D (Q, F)

Friction acts at the point of the rim that the plane pushes: it holds the two components of u in the
plane, or opposes them with mu N. D is positive definite, and N no longer depends on the friction:
Painleve's paradox, a property of rigid contacts, cannot occur.

Modelling choices. The plane pushes one point of the rim, the deepest, also where the far rim is in
the plane. Its surface follows the rim at once and without a force of its own once the rim leaves:
the elastic energy that is in the contact where N falls to zero at a depth is lost. Without declared
slip a rim that lands sticks at once: a tangential impulse stops the material where it touches.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.equations.contact_laws import Contact, Mode
from reference.equations.frames import to_body, to_level
from reference.equations.newton_euler import (
    NORMAL,
    ROLLING_1,
    SLIP_1,
    SLIP_2,
    GeneralEquations,
)
from reference.equations.rigid_body import Setting
from reference.equations.state_vector import DISSIPATED, SLIP, TURN, U1, U2, W1, W3, Index
from reference.equations.state_vector import ROWS as RIGID_ROWS
from reference.problem.effects import LINEAR, Compliance
from reference.problem.states import Floats

ROWS = RIGID_ROWS + 2
DEPTH, RISE = RIGID_ROWS, RIGID_ROWS + 1


@dataclass(frozen=True, slots=True, kw_only=True)
class CompliantContact(Contact):
    """Force of the plane and the accelerations of a contact that gives way; all times sin(phi).

    Attributes
    ----------
    rising : ndarray, shape (n,)
        Acceleration of the rim's material along the normal.
    """

    rising: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class CompliantEquations(GeneralEquations):
    """The vector fields of one can and its effects on one contact that gives way.

    Attributes
    ----------
    law : Compliance
    """

    law: Compliance

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on, the depth and its rate the last."""
        return np.append(GeneralEquations.core(self, mode), [DEPTH, RISE])

    def elastic_force(self, depth: Floats) -> Floats:
        """Return the force over m g of a contact at rest; odd in the depth, shape (n,)."""
        n, k = self.law.exponent, self.law.stiffness
        return np.asarray(k * depth if n == LINEAR else k * _odd_power(depth, n))

    def pressing(self, y: Floats) -> Floats:
        """Return the normal force over m g by the law, of either sign, shape (n,)."""
        depth, rise = y[DEPTH], y[RISE]
        if self.law.exponent == LINEAR:
            return np.asarray(self.law.stiffness * depth - self.law.damping * rise)
        yielding = self.law.stiffness - self.law.damping * rise
        return np.asarray(_odd_power(depth, self.law.exponent) * yielding)

    def touching(self, y: Floats) -> Floats:
        """Return a margin that is positive where the rim is in the plane and pushed, shape (n,).

        Of the factors of the law, for a power of the depth is too flat at zero to find its root.
        """
        if self.law.exponent == LINEAR:
            return np.asarray(np.minimum(self.elastic_force(y[DEPTH]), self.pressing(y)))
        yielding = 1 - self.law.damping / self.law.stiffness * y[RISE]
        return np.asarray(np.minimum(y[DEPTH] / self.law.depth_under(1.0), yielding))

    def stored(self, depth: Floats) -> Floats:
        """Return the elastic energy over m g R of a contact at a depth, shape (n,)."""
        power = self.law.exponent + 1
        return np.asarray(self.law.stiffness / power * np.maximum(depth, 0.0) ** power)

    def contact(self, y: Floats, mode: Mode) -> CompliantContact:
        """Return force and accelerations at the contact, from states of shape (15, n)."""
        return self._yielding(y, mode, self._setting(y, mode))

    def begun(self, y: Floats, mode: Mode, motion: Floats) -> CompliantContact:
        """Return the same of a patch at rest that begins to move, as on a rigid contact."""
        here = self._setting(y, replace(mode, slips=False))
        return self._yielding(y, mode, here, motion)

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (15, n); zero without `along` of what nothing needs."""
        here = self._setting(y, mode)
        contact = self._yielding(y, mode, here)
        out = self._rates(y, mode, here, contact, along=along)
        out[DEPTH], out[RISE] = -here.at.S * y[RISE], contact.rising
        if along and not mode.flies:
            damped = contact.force[2] - here.at.S * self.elastic_force(y[DEPTH])
            out[DISSIPATED] -= damped * y[RISE]
        return out

    def energy(self, y: Floats, mode: Mode) -> Floats:
        """Kinetic, potential and elastic energy, without the shaking, over m g R, shape (n,)."""
        mass = 1.0 if self.effects.mass is None else 1.0 + self.effects.mass.share
        sunk = mass * self.effects.gravity.constant[2] * y[DEPTH]
        elastic = 0.0 if mode.flies else self.stored(y[DEPTH])
        return np.asarray(GeneralEquations.energy(self, y, mode) + sunk + elastic)

    def landed(self, y: Floats, mode: Mode, stopped: list[int]) -> Floats:
        """Return a state, shape (15,), in which some motions at the contact have been stopped.

        By impulses of friction in the plane where the rim sticks from now on (`SLIP_1`, `SLIP_2`),
        and of fluid where the contact point stops running (`ROLLING_1`). The energy that they take
        is counted as dissipated.

        Parameters
        ----------
        y : ndarray, shape (15,)
        mode : Mode
        stopped : list of int
            Components of (w, u).
        """
        here = self._setting(y[:, None], mode)
        D = self._free(here, mode)[1][0]
        before = GeneralEquations.energy(self, y[:, None], mode)[0]
        level = to_level(y[TURN, None], here.at)[:, 0]
        moves = np.array([*level, *y[SLIP], y[RISE]])[stopped]
        change = D[:, stopped] @ np.linalg.solve(D[np.ix_(stopped, stopped)], -moves)
        out = y.copy()
        out[TURN] += to_body(change[:3, None], here.at)[:, 0]
        out[SLIP] += change[[SLIP_1, SLIP_2]]
        out[RISE] += change[NORMAL]
        # exactly
        if SLIP_1 in stopped:
            out[SLIP] = 0.0
        if ROLLING_1 in stopped:
            out[W1] = out[W3] * here.at.S[0] / here.at.C[0]
        out[DISSIPATED] += before - GeneralEquations.energy(self, out[:, None], mode)[0]
        return out

    def _rim_velocity(self, y: Floats, mode: Mode) -> Floats:
        zero = np.zeros_like(y[U1])
        return np.array([y[U1], y[U2], y[RISE]] if mode.slips else [zero, zero, y[RISE]])

    def _yielding(
        self, y: Floats, mode: Mode, here: Setting, motion: Floats | None = None
    ) -> CompliantContact:
        at, w = here.at, here.turning
        both, mobility = self._free(here, mode)
        wrench = np.zeros_like(both)
        held: list[int] = []
        if not mode.flies:
            held = [*self.moments_that_hold(mode), *([] if mode.slips else [SLIP_1, SLIP_2])]
            wrench = self._law(y, mode, motion) * (at.S * self.pressing(y))
            both = both + np.einsum("nij,jn->in", mobility, wrench)
        # a contact point held on the rim has theta' = 0 in directions that precess with the can
        precessing = w[0] * w[1] if self._held_on_rim(mode) else None
        if precessing is not None:
            both[ROLLING_1] += precessing
        if held:
            holds = np.linalg.solve(mobility[:, held][:, :, held], -both[held].T[..., None])
            wrench[held] += holds[..., 0].T
            both = both + np.einsum("nij,nj->in", mobility[:, :, held], holds[..., 0])
            both[held] = 0.0
        if precessing is not None:
            both[ROLLING_1] = -precessing
        return CompliantContact(
            force=wrench[3:],
            moment=wrench[:3],
            turning=to_body(both[:3], at),
            slipping=both[[SLIP_1, SLIP_2]],
            normal_mobility=np.ones(at.S.shape),
            rising=both[NORMAL],
        )


def _odd_power(depth: Floats, exponent: float) -> Floats:
    """Return depth^n, and -(-depth)^n above the plane, analytic beside zero along imaginary steps.

    A step of an implicit method may ask for it a round-off beyond the end of the contact.
    """
    sign = np.where(depth.real < 0, -1.0, 1.0)
    return np.asarray(sign * (sign * depth) ** exponent)
