"""The integrals of one period where the midpoint rule converges too slowly.

Beside a separatrix g all but touches zero between the turning points, or just beyond the lower one,
and the rates have a peak that no even grid resolves. Here the clock's time is divided where the
rates change, until two Gauss rules agree on every part or differ by no more than the round-off of
g. Above the lower turning point g is computed from its difference from there, because half of the
peak may be the square root of a distance from it.
"""

import numpy as np
from numpy.typing import NDArray

from reference.integrable.quadrature import (
    Rates,
    elliptic_substitution,
    peak_rate,
    rates,
    select_points,
)
from reference.integrable.turning_points import TurningPoints
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
    n = points.low.size
    clock = elliptic_substitution(points)
    sums = np.zeros((3, n))
    converged = np.ones(n, dtype=bool)
    owner = np.repeat(np.arange(n), PARTS)
    left = np.tile(np.arange(PARTS) / PARTS, n)
    width = np.full(owner.shape, 1.0 / PARTS)
    scale = np.zeros((3, n))
    for level in range(MOST_LEVELS):
        few, _ = _gauss(points, owner, left, width, COARSE)
        many, noise = _gauss(points, owner, left, width, FINE)
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
    period, turn, total = 2 * clock.quarter * sums
    looks = rates(points, clock, (np.arange(LOOKS)[:, None] + 0.5) / LOOKS)
    peak = peak_rate(points, looks)
    return (period, turn, total - turn, points.low, points.high, peak), converged


def _gauss(
    points: TurningPoints,
    owner: NDArray[np.intp],
    left: Floats,
    width: Floats,
    rule: tuple[Floats, Floats],
) -> tuple[Floats, Floats]:
    """Integrals over parts, shape (3, k), and the largest share of round-off in g, shape (k,)."""
    nodes, weights = rule
    some = select_points(points, owner)
    fraction = left + width * (nodes[:, None] + 1) / 2
    found: Rates = rates(some, elliptic_substitution(some), fraction, careful=True)
    weight = (width / 2) * weights[:, None]
    values = np.stack(
        [(weight * part).sum(axis=0) for part in (found.time, found.precession, found.total)]
    )
    return values, found.noise.max(axis=0)
