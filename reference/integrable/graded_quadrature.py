"""The integrals of one period where the midpoint rule converges too slowly.

Near a separatrix g almost touches zero between the turning points, or just beyond the lower one,
and the rates have a peak that no even grid resolves. Here the clock's time is divided where the
rates change, until two Gauss rules agree on every part or differ by no more than the round-off of
g. Above the lower turning point g is computed from its difference from there, because half of the
peak may be the square root of a distance from it. Around a release that passes slowly near an
equilibrium the variable is the distance from the release, which both the energy left over there
and the peak's width are known in.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from reference.integrable.effective_potential import BESIDE as SHORT
from reference.integrable.effective_potential import energy_near_reference, select_potential
from reference.integrable.elliptic import EllipticSubstitution
from reference.integrable.quadrature import (
    Rates,
    elliptic_substitution,
    peak_rate,
    rates,
    select_points,
)
from reference.integrable.turning_points import TurningPoints
from reference.numerics.rootfinding import bracketed_roots
from reference.problem.states import Floats

COARSE = np.polynomial.legendre.leggauss(8)
FINE = np.polynomial.legendre.leggauss(12)
# Parts at first, and how often one is divided: a peak 2^-40 wide is below what g resolves.
PARTS = 8
MOST_LEVELS = 44
MOST_OPEN = 24
# Of the whole integral, on one part.
AGREED = 1e-14
# The rate is known to half the share that g is; the two rules feel it differently.
NOISY = 2.0
# Nodes at which the peak rate is looked for.
LOOKS = 256


Integrands = Callable[
    [NDArray[np.intp], Floats, Floats, tuple[Floats, Floats]], tuple[Floats, Floats]
]
"""From release, left end and width of k parts, and a rule, to three integrals over each part, shape
(3, k), and to the largest share of round-off in g, shape (k,)."""


def graded_integrals(
    points: TurningPoints,
) -> tuple[tuple[Floats, ...], NDArray[np.bool_]]:
    """Return period, turn, rotation, phi_min, phi_max, peak rate, and whether they converged.

    Parameters
    ----------
    points : TurningPoints
        Certain ones, of n releases.

    Returns
    -------
    values : tuple of six ndarray, shape (n,)
    converged : ndarray of bool, shape (n,)
        False also where g is not positive all the way.
    """
    clock = elliptic_substitution(points)
    passing = _released_near_a_barrier(points)
    lower, upper, reach = _surroundings(points, clock, passing)
    steps = np.arange(PARTS // 2)[:, None] / (PARTS // 2)
    left = np.concatenate([lower * steps, upper + (1 - upper) * steps])
    width = np.repeat([lower, 1 - upper], PARTS // 2, axis=0) / (PARTS // 2)
    owner = np.broadcast_to(np.arange(clock.low.size), left.shape)

    def by_the_clock(
        owner: NDArray[np.intp], left: Floats, width: Floats, rule: tuple[Floats, Floats]
    ) -> tuple[Floats, Floats]:
        some = select_points(points, owner)
        fraction = left + width * (rule[0][:, None] + 1) / 2
        part: Rates = rates(some, elliptic_substitution(some), fraction, careful=True)
        weight = (clock.quarter[owner] * width / 2) * rule[1][:, None]
        parts = (part.time, part.precession, part.total)
        return np.stack([(weight * x).sum(axis=0) for x in parts]), part.noise.max(axis=0)

    def by_the_distance(
        owner: NDArray[np.intp], left: Floats, width: Floats, rule: tuple[Floats, Floats]
    ) -> tuple[Floats, Floats]:
        well = select_potential(points.released, passing[owner])
        distance = left + width * (rule[0][:, None] + 1) / 2
        sums, noise = np.zeros((3, owner.size)), np.zeros(owner.size)
        for way in (-1.0, 1.0):
            g, lost, b, spin = energy_near_reference(well, way * distance)
            inertia = (well.can.a_p + 1) / 2
            time = (width / 2) * rule[1][:, None] * np.sqrt(inertia / np.where(g > 0, g, np.nan))
            psi_dot = b / np.sin(well.reference - way * distance) ** 2
            sums += np.stack([(time * x).sum(axis=0) for x in (1.0, psi_dot, spin)])
            noise = np.maximum(noise, np.abs(lost / g).max(axis=0))
        return sums, noise

    sums, converged = _divided(by_the_clock, owner.T.ravel(), left.T.ravel(), width.T.ravel())
    if passing.size:
        near, good = _divided(
            by_the_distance, np.arange(passing.size), np.zeros(passing.size), reach
        )
        sums[:, passing] += near
        converged[passing] &= good
    period, turn, total = 2 * sums
    looks = rates(points, clock, (np.arange(LOOKS)[:, None] + 0.5) / LOOKS)
    peak = peak_rate(points, looks)
    return (period, turn, total - turn, points.low, points.high, peak), converged


def _released_near_a_barrier(points: TurningPoints) -> NDArray[np.intp]:
    """Numbers of the releases that move near an equilibrium inside a wide swing."""
    well = points.released
    inside = (well.excess > 0) & (np.minimum(points.climb, points.fall) > 0)
    return np.flatnonzero(well.poised & inside & (points.swing >= SHORT * points.high))


def _surroundings(
    points: TurningPoints, clock: EllipticSubstitution, passing: NDArray[np.intp]
) -> tuple[Floats, Floats, Floats]:
    """Return the fractions of K between which the distance from the release is the variable.

    A node's nutation is known to its rounding only, and the peak of a slow passage may be no wider
    than a thousand of these: there the distance from the release has to be known to its own digits.
    The fractions are equal but for the releases in `passing`; of these the third array returned is
    the distance itself.
    """
    lower, upper = np.full(clock.low.shape, 0.5), np.full(clock.low.shape, 0.5)
    some = select_points(points, passing)
    reach = np.minimum(np.minimum(some.climb, some.fall) / 2, SHORT * some.released.reference)
    part = elliptic_substitution(some)
    for ends, rise in ((lower, some.fall - reach), (upper, some.fall + reach)):
        ends[passing] = _fraction_of(part, rise)
    return lower, upper, reach


def _fraction_of(clock: EllipticSubstitution, rise: Floats) -> Floats:
    """Return the fraction of K at which phi - phi_min is as given, shape (n,)."""
    start = np.zeros_like(rise)
    return bracketed_roots(lambda x: clock.nutation(x[None])[1][0] - rise, start, start + 1)


def _divided(
    integrands: Integrands, owner: NDArray[np.intp], left: Floats, width: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Integrals over all parts of a release, shape (3, n), and whether they converged."""
    n = int(owner.max()) + 1
    sums, scale = np.zeros((3, n)), np.zeros((3, n))
    converged = np.ones(n, dtype=bool)
    for level in range(MOST_LEVELS):
        few, _ = integrands(owner, left, width, COARSE)
        many, noise = integrands(owner, left, width, FINE)
        if level == 0:
            np.add.at(scale.T, owner, np.abs(many).T)
        error = np.abs(many - few)
        good = (error <= AGREED * scale[:, owner] + NOISY * noise * np.abs(many)).all(axis=0)
        converged[owner[~np.isfinite(many).all(axis=0)]] = False
        np.add.at(sums.T, owner[good], many[:, good].T)
        # round-off has no end: a peak leaves few parts open, whatever its width
        converged[np.bincount(owner[~good], minlength=n) > MOST_OPEN] = False
        open_ = ~good & converged[owner]
        if not open_.any():
            break
        owner = np.repeat(owner[open_], 2)
        half = np.repeat(width[open_] / 2, 2)
        left = np.repeat(left[open_], 2)
        left[1::2] += half[1::2]
        width = half
    else:
        converged[owner] = False
    return sums, converged
