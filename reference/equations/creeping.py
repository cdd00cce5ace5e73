"""Dry friction along the rim of a can that falls on its face: the normal force as a state.

As S = sin(phi) goes to zero the moment of dry contour friction, f N/S, grows beside all else, and
the contact point either stops or runs on where N is next to nothing. Of a can that is mirrored in
the plane of its lean N does not feel the moment: N = g(y)/S, where infinite friction holds the rim,
with

    g = R w1 ((a + h^2) w1 - h R w3)/(a + R^2 + h^2) + O(S),      R = 1 - r

(centrifugal, in the time of the rim). Where w1 and w3 are of one sign N may fall to next to
nothing, and there the moment f N s, s = sign(theta'), keeps it: beside

    w3 = k w1,    k = (a + h^2)/(h R)

a larger w1 has a larger N, and so more friction against it. What is off this manifold dies out
within sigma = S/(f |w1|); on it the parts of g cancel, and with them all its digits as S goes to
zero. So N is a state beside the others, its rate the derivative of g/S along theirs,

    S N' = g_y y'(N) - S' N,

stiff, but without a cancellation in N. With all terms of S gone the manifold has

    w1' = -p w1 w2,    w2' = 0,    psi' = w1,    p = h^2/((a + h^2)(1 + c/R^2) - h^2),

so that w1 falls as phi^p, the contact point turns ever faster, but by w1/(p w2) in all, and the
whole face meets the plane at once. Where p > 1/2 and the weight presses the rim down, w1^2 falls
below S: N rises, and the point stops.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from reference.equations.contact_laws import Contact, Mode
from reference.equations.state_vector import LEAN, TURN, U1, W2, Angles
from reference.problem.states import Floats

if TYPE_CHECKING:
    from reference.equations.newton_euler import GeneralEquations

NORMAL_FORCE = U1
"""Row of N: a rim that sticks has no slip."""
# Imaginary steps subtract nothing, so that one is as small as may be. A state that has such a step
# already, for a matrix of Newton's method, needs fewer digits: there g, quadratic but for terms of
# S, has real steps of this share of the turning.
IMAGINARY, REAL = 1e-40, 1e-3
# How fast g - S N, of which there is round-off, dies out, in phi' of the fall: faster than w1^2 of
# the manifold, which goes as phi^(2p), p < 1/2.
BACK = 2.0


def pushed(contact: Contact, y: Floats) -> Contact:
    """Return a contact with the normal force of its states, shape (13, n)."""
    normal = Angles.of(y[LEAN]).S * y[NORMAL_FORCE]
    return replace(contact, force=np.array([*contact.force[:2], normal]))


def rate_of_normal_force(
    equations: "GeneralEquations", y: Floats, mode: Mode, rates: Floats
) -> Floats:
    """Return N', shape (n,), from states and the rates of their other rows, shape (13, n)."""
    at, pressing = Angles.of(y[LEAN]), y[NORMAL_FORCE]
    g, change = _along(equations, y, mode, rates)
    lost = g - at.S * pressing
    return np.asarray((change + BACK * y[W2] * lost) / at.S - at.C * rates[LEAN] * pressing)


def _along(
    equations: "GeneralEquations", y: Floats, mode: Mode, rates: Floats
) -> tuple[Floats, Floats]:
    """Return g and its derivative along some rates, both of shape (n,)."""

    def normal(states: Floats) -> Floats:
        return equations.normal_reaction(states, mode)

    if not np.iscomplexobj(y):
        found = normal(y + 1j * IMAGINARY * rates)
        return found.real, found.imag / IMAGINARY
    speed = np.abs(rates[[LEAN, *TURN]]).max(axis=0)
    shift = REAL * np.abs(y[TURN]).max(axis=0) / np.where(speed > 0.0, speed, 1.0)
    shift = np.where(shift > 0.0, shift, REAL)
    ahead, back = normal(y + shift * rates), normal(y - shift * rates)
    return normal(y), np.asarray((ahead - back) / (2 * shift))
