"""In which directions a contact at rest begins to slip, or to roll against resistance.

A rim at rest that cannot be held there slips in a direction e, with the friction -mu N e. By
linearity (`reference.equations.newton_euler`; D is the mobility of the contact, what is held
besides
eliminated, and l what a unit of normal force brings with it but friction) the accelerations along
the plane and the normal are

    a(e) = s + N (D_tz l - mu D_tt e),        0 = n + N G(e),        G(e) = D_zz l - mu D_zt e

where s and n are those of a contact without force. Slip that grows from nothing keeps its
direction, so a direction is admissible if all of this holds:

    e x a(e) = 0,    e.a(e) > 0,    N = -n/G(e) > 0,    G(e) > 0.

N is a quotient with a pole where the normal mobility G is zero; multiplied by G the first condition
is

    P(e) = e x (G(e) s - n (D_tz l - mu D_tt e)) = 0,

a trigonometric polynomial of degree two in the angle of e. With z = exp(i angle) it is a quartic,
whose roots on the unit circle, four at most, are all there are: found together, as eigenvalues of
its companion matrix, and none of them a pole.

Of N > 0 the condition G > 0 leaves the solutions that a plane however stiff would have, too: with G
< 0 a force that grows presses the rim into the plane. n < 0 wherever a direction is admissible;
where n > 0 the rim may also leave the plane. So where nothing can be held:

    one direction                                    it slips
    several                                          indeterminate
    none, n > 0, and e x a = 0, e.a > 0 with G < 0   indeterminate: it slides or lifts
    none, n > 0                                      it lifts
    none, n < 0                                      inconsistent

D is symmetric and positive definite, with which the last cannot happen to a rim at rest that
friction alone acts on (J.-S. Pang and J. C. Trinkle, Math. Programming 73, 1996, 199-226); a rim
that slips already has no choice of direction, and meets it (`reference.nonsmooth.transitions`).
The names are
those of Painleve's paradox: F. Genot and B. Brogliato, Eur. J. Mech. A 18, 1999, 653-677; A. R.
Champneys and P. L. Varkonyi, IMA J. Appl. Math. 81, 2016, 538-588.

At the edge of the friction cone, where sticking ends, e is against the force that sticking took,
and a(e) = 0: there slip grows as the square of time, and how fast is found a little later along the
motion that sticks.

The level part of the angular velocity begins in the same way, under the moment -l_r N e.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from reference.equations.contact_laws import Contact, Equations, Mode
from reference.equations.frames import to_level
from reference.equations.state_vector import LEAN, SLIP, Angles
from reference.nonsmooth.level_spin import HARDLY, rolled
from reference.problem.outcome import Outcome
from reference.problem.states import Floats

# Samples of a trigonometric polynomial of degree two: five would do.
SAMPLES = 8
# The first of them, aside of the likely directions, so that none is a pole.
ASIDE = 0.5
# How far a root may be from the unit circle, and two from each other: what round-off makes of a
# double root is its square root, with a margin.
ON_CIRCLE = 1e-6
# How far along to look for the acceleration at the edge of the cone.
LATER = 1e-6
# Within this share of the limit the force that holds is on the edge of the cone.
EDGE = 1e-9
# A direction this near to that of the edge is the one that begins there.
NEAR = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class SlipOnset:
    """How slip or rolling begins: u = size sigma^power (cos angle, sin angle)."""

    angle: float
    size: float
    power: int

    @property
    def direction(self) -> Floats:
        """A unit vector, shape (2,)."""
        return np.array([np.cos(self.angle), np.sin(self.angle)])


@dataclass(frozen=True, slots=True, kw_only=True)
class UnilateralHold:
    """What may be held at rest by a reaction within a cone.

    Attributes
    ----------
    freed : callable
        The mode in which it is not held.
    hardly : callable
        States (13, n) in which it moves hardly, in directions of shape (2, n).
    acceleration : callable
        Of what begins, shape (2, n), from a contact and its states.
    reaction : callable
        That holds it, shape (2, n), and its limit, shape (n,).
    """

    freed: Callable[[Mode], Mode]
    hardly: Callable[[Floats, Floats], Floats]
    acceleration: Callable[[Contact, Floats], Floats]
    reaction: Callable[[Equations, Contact], tuple[Floats, Floats]]


def _slipping(y: Floats, direction: Floats) -> Floats:
    columns = y.copy()
    columns[SLIP] = HARDLY * direction
    return columns


RIM = UnilateralHold(
    freed=lambda mode: replace(mode, slips=True),
    hardly=_slipping,
    acceleration=lambda found, _: found.slipping,
    reaction=lambda equations, found: (found.force[:2], equations.mu * found.force[2]),
)
"""Friction holds the rim's material where it touches."""

LEAN_OF_CAN = UnilateralHold(
    freed=lambda mode: replace(mode, rests=False),
    hardly=rolled,
    acceleration=lambda found, y: to_level(found.turning, Angles.of(y[LEAN]))[:2],
    reaction=lambda equations, found: (found.moment[:2], equations.resistance * found.force[2]),
)
"""Rolling resistance holds the level part of the angular velocity."""


def slack(equations: Equations, found: Contact, rest: UnilateralHold = RIM) -> Floats:
    """How much of the cone a contact that holds leaves, (mu N - |F|) sin phi, shape (n,)."""
    reaction, limit = rest.reaction(equations, found)
    return np.asarray(limit - np.hypot(*reaction))


def onset(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold = RIM
) -> SlipOnset | Outcome | None:
    """Return how slip, or rolling, begins from rest, or why no one can say; None if it does not.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
        In which it is held.
    rest : Rest
        Which of the two.
    """
    column, free = y[:, None], rest.freed(mode)
    held = equations.contact(column, mode)
    (R1, R2), limit = (each[..., 0] for each in rest.reaction(equations, held))
    if abs(limit - np.hypot(R1, R2)) > EDGE * max(limit, np.hypot(R1, R2)):
        return _only(equations, y, free, rest)
    later = y + LATER * equations.rates(column, mode)[:, 0]
    found = equations.contact(later[:, None], mode)
    if slack(equations, found, rest)[0] >= 0:
        return None
    only = _only(equations, later, free, rest)
    start = float(np.arctan2(-R2, -R1))
    if isinstance(only, SlipOnset) and abs(np.sin((only.angle - start) / 2)) < NEAR / 2:
        return SlipOnset(angle=start, size=only.size / LATER / 2, power=2)
    return only


def admissible(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold = RIM
) -> tuple[SlipOnset, ...]:
    """Return every direction in which slip, or rolling, may grow from rest.

    Of a state as in `onset`, and the mode in which it is free.
    """
    return _growing(equations, y, mode, rest)[0]


def _only(equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold) -> SlipOnset | Outcome:
    """Return the only direction, or what it means that there is none or several."""
    directions, others, falls = _growing(equations, y, mode, rest)
    if len(directions) == 1:
        return directions[0]
    if directions or (others and not falls):
        return Outcome.INDETERMINATE
    return Outcome.INCONSISTENT if falls else Outcome.LIFTED


def _growing(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold
) -> tuple[tuple[SlipOnset, ...], int, bool]:
    """Return the directions, how many there are but for G < 0, and whether n < 0."""
    steps = np.arange(SAMPLES) / SAMPLES
    _, across, found = _yielding(equations, y, mode, rest, ASIDE + 2 * np.pi * steps)
    angles = ASIDE + _roots(across)
    # the same for every direction, but for round-off
    falls = bool(np.median(found.force[2] * found.grip) > 0)
    if not angles.size:
        return (), 0, falls
    along, _, found = _yielding(equations, y, mode, rest, angles)
    grows = (found.force[2] > 0) & (along / found.grip > 0)
    good = grows & (found.grip > 0)
    directions = tuple(
        SlipOnset(angle=float(angle), size=float(size), power=1)
        for angle, size in zip(angles[good], (along / found.grip)[good], strict=True)
    )
    return directions, int((grows & ~good).sum()), falls


def _yielding(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold, angles: Floats
) -> tuple[Floats, Floats, Contact]:
    """Return G a along a direction and across it, both of shape (n,), and the contact."""
    cos, sin = np.cos(angles), np.sin(angles)
    columns = rest.hardly(np.repeat(y[:, None], angles.size, axis=1), np.array([cos, sin]))
    found = equations.contact(columns, mode)
    a1, a2 = rest.acceleration(found, columns) * found.grip
    return a1 * cos + a2 * sin, a2 * cos - a1 * sin, found


def _roots(values: Floats) -> Floats:
    """Return the zeros of a trigonometric polynomial of degree two, increasing.

    Parameters
    ----------
    values : ndarray, shape (SAMPLES,)
        At equal distances from 0 on.
    """
    c0, c1, c2 = np.fft.rfft(values)[:3]
    z = np.roots([c2, c1, c0, np.conj(c1), np.conj(c2)])
    angles = np.sort(np.angle(z[np.abs(np.abs(z) - 1) < ON_CIRCLE]))
    return angles[np.diff(angles, prepend=-np.inf) > ON_CIRCLE]
