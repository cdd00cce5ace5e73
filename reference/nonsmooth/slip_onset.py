"""Directions in which a contact at rest begins to slip, or to roll against resistance.

A rim at rest that cannot be held there slips in a direction e, with the friction -mu N e. By
linearity (`reference.equations.newton_euler`; D is the mobility of the contact, what is held
besides eliminated, and l what a unit of normal force brings with it but friction) the accelerations
along the plane and the normal are

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
that slips already has no choice of direction, and meets it (`reference.nonsmooth.transitions`). The
names are those of Painleve's paradox: F. Genot and B. Brogliato, Eur. J. Mech. A 18, 1999, 653-677;
A. R. Champneys and P. L. Varkonyi, IMA J. Appl. Math. 81, 2016, 538-588.

On the edge of the friction cone, where sticking ends, e is against the force that sticking took,
and a(e) = 0: there the signs of e.a(e) and of what is left of the cone are those of a round-off,
and a motion that stays there (steady rolling, or an extremum of the friction it needs) has no
instant at which it leaves. So what is held is held up to a share `BEYOND` outside of its cone,
where all signs are safe, and lets go there. Where the slack falls at the rate s that is
d = BEYOND/s late, by which the can misses an impulse of BEYOND d/2: less than the round-off of a
step, unless s is below 1e-2, and never more than BEYOND^(3/2).

The level part of the angular velocity begins in the same way, under the moment -l_r N e.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Protocol

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
# Share of its limit by which a reaction that holds may exceed it: a million times the round-off of
# a force.
BEYOND = 2e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class SlipOnset:
    """Onset of a slip or of rolling: u = size sigma (cos angle, sin angle)."""

    angle: float
    size: float

    @property
    def direction(self) -> Floats:
        """Return the unit vector of the direction, shape (2,)."""
        return np.array([np.cos(self.angle), np.sin(self.angle)])


class Onset(Protocol):
    """How a motion begins: its acceleration in sigma, and its direction."""

    @property
    def size(self) -> float:
        """Acceleration along the direction."""
        ...

    @property
    def direction(self) -> Floats:
        """Unit vector, shape (2,), or (3,) of a patch."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class UnilateralHold:
    """A motion that a reaction within a cone can hold at rest.

    Attributes
    ----------
    freed : callable
        The mode in which it is not held.
    infinitesimal : callable
        States (13, n) in which it moves hardly, in directions of shape (2, n).
    acceleration : callable
        Of what begins, shape (2, n), from a contact and its states.
    reaction : callable
        That holds it, shape (2, n), and its limit, shape (n,).
    patch : bool
        Whether it slips and turns together, in three components instead of two.
    """

    freed: Callable[[Mode], Mode]
    infinitesimal: Callable[[Floats, Floats], Floats]
    acceleration: Callable[[Contact, Floats], Floats]
    reaction: Callable[[Equations, Contact], tuple[Floats, Floats]]
    patch: bool = False


def _slipping(y: Floats, direction: Floats) -> Floats:
    columns = y.copy()
    columns[SLIP] = HARDLY * direction
    return columns


RIM = UnilateralHold(
    freed=cache(lambda mode: replace(mode, slips=True)),
    infinitesimal=_slipping,
    acceleration=lambda contact, _: contact.slipping,
    reaction=lambda equations, contact: (contact.force[:2], equations.mu_static * contact.force[2]),
)
"""Friction holds the rim's material where it touches."""

LEAN_OF_CAN = UnilateralHold(
    freed=cache(lambda mode: replace(mode, rests=False)),
    infinitesimal=rolled,
    acceleration=lambda contact, y: to_level(contact.turning, Angles.of(y[LEAN]))[:2],
    reaction=lambda equations, contact: (
        contact.moment[:2],
        equations.resistance * contact.force[2],
    ),
)
"""Rolling resistance holds the level part of the angular velocity."""


def slack(equations: Equations, contact: Contact, rest: UnilateralHold = RIM) -> Floats:
    """Return the unused part of the cone of a contact at rest, (mu N - |F|) sin phi, shape (n,)."""
    reaction, limit = rest.reaction(equations, contact)
    return np.asarray(limit - np.hypot.reduce(reaction))


def reserve(equations: Equations, contact: Contact, rest: UnilateralHold = RIM) -> Floats:
    """Return the margin to the end of a hold, `BEYOND` its cone, times sin phi, shape (n,)."""
    reaction, limit = rest.reaction(equations, contact)
    return np.asarray((1 + BEYOND) * limit - np.hypot.reduce(reaction))


def holding(equations: Equations, contact: Contact) -> Floats:
    """Return the same margin of the hold of turning about the normal, shape (n,)."""
    limit = (1 + BEYOND) * equations.drilling * contact.force[2]
    return np.asarray(limit - np.abs(contact.moment[2]))


def holding_on_rim(equations: Equations, contact: Contact, y: Floats) -> Floats:
    """Return the same margin of the hold of the contact point on the rim, shape (n,).

    Times sin phi, as the others: the moment that holds theta' has the limit f N/sin(phi).
    """
    limit = (1 + BEYOND) * equations.contour * contact.force[2]
    return np.asarray(limit - np.abs(contact.moment[0]) * Angles.of(y[LEAN]).S)


def onset(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold = RIM
) -> SlipOnset | Outcome:
    """Return the only admissible direction, or the outcome that says why there is not one.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
        In which it is free.
    rest : UnilateralHold
        Which of the two.
    """
    directions, others, falls = _growing(equations, y, mode, rest)
    if len(directions) == 1:
        return directions[0]
    if directions or (others and not falls):
        return Outcome.INDETERMINATE
    return Outcome.INCONSISTENT if falls else Outcome.LIFTED


def admissible(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold = RIM
) -> tuple[SlipOnset, ...]:
    """Return every direction in which slip, or rolling, may grow from rest.

    Of a state and the mode in which it is free.
    """
    return _growing(equations, y, mode, rest)[0]


def _growing(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold
) -> tuple[tuple[SlipOnset, ...], int, bool]:
    """Return the directions, how many only G <= 0 excludes, and whether n = -N G is negative.

    n is the acceleration of the contact, along the normal, without a force of contact.
    """
    steps = np.arange(SAMPLES) / SAMPLES
    _, across, contact = _yielding(equations, y, mode, rest, ASIDE + 2 * np.pi * steps)
    angles = ASIDE + roots_on_circle(across)
    # the same for every direction, but for round-off
    pulls = np.sort(contact.force[2] * contact.normal_mobility)
    falls = bool(pulls[SAMPLES // 2 - 1] + pulls[SAMPLES // 2] > 0)
    if not angles.size:
        return (), 0, falls
    along, _, contact = _yielding(equations, y, mode, rest, angles)
    grows = (contact.force[2] > 0) & (along / contact.normal_mobility > 0)
    good = grows & (contact.normal_mobility > 0)
    directions = tuple(
        SlipOnset(angle=float(angle), size=float(size))
        for angle, size in zip(angles[good], (along / contact.normal_mobility)[good], strict=True)
    )
    return directions, int((grows & ~good).sum()), falls


def _yielding(
    equations: Equations, y: Floats, mode: Mode, rest: UnilateralHold, angles: Floats
) -> tuple[Floats, Floats, Contact]:
    """Return G a along a direction and across it, both of shape (n,), and the contact."""
    cos, sin = np.cos(angles), np.sin(angles)
    columns = rest.infinitesimal(np.repeat(y[:, None], angles.size, axis=1), np.array([cos, sin]))
    contact = equations.contact(columns, mode)
    a1, a2 = rest.acceleration(contact, columns) * contact.normal_mobility
    return a1 * cos + a2 * sin, a2 * cos - a1 * sin, contact


_SHIFT = np.diag(np.ones(3, complex), -1)


def roots_on_circle(values: Floats) -> Floats:
    """Return the zeros of a trigonometric polynomial of degree two, increasing.

    Parameters
    ----------
    values : ndarray, shape (SAMPLES,)
        At equal distances from 0 on.
    """
    c0, c1, c2 = np.fft.rfft(values)[:3]
    if c2 == 0:
        z = np.roots([c1, c0, np.conj(c1)])
    else:
        companion = _SHIFT.copy()
        companion[0] = -np.array([c1, c0, np.conj(c1), np.conj(c2)]) / c2
        z = np.linalg.eigvals(companion)
    angles = np.sort(np.angle(z[np.abs(np.abs(z) - 1) < ON_CIRCLE]))
    apart = np.append(True, angles[1:] - angles[:-1] > ON_CIRCLE)
    return np.asarray(angles[apart[: angles.size]])
