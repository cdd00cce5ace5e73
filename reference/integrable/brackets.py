"""Brackets of the first root of a smooth function from a point on, without missing one.

From the start the search takes steps, each an interval on which the function is a Chebyshev
series resolved to round-off. Because |T_k| <= 1, a series whose first coefficient outweighs the
sum of the others keeps its sign. So an interval is settled where

    f   keeps its sign: no root in it;
    f'  keeps its sign, or f'' < 0: at most one root, and f at the far end tells;
    f'' > 0: f has one minimum; the sign there tells.

Where none of these can be shown the step is halved. Where the minimum that decides is itself
below the round-off of f, no sign is claimed: the root is undecided.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from reference.numerics.chebyshev import clenshaw, derivative
from reference.numerics.rootfinding import bracketed_roots
from reference.problem.states import Floats

# On [x/2, x] a function with singularities at 0 and pi alone has coefficients that fall like
# (3 + sqrt 8)^-n: to 1e-18 in 24 terms.
NODES = 24
LONGEST = 0.5
# Of steps: a thousand octaves down to the smallest double, and fifty halvings beside a near-double
# root.
MOST_STEPS = 2000
# The coefficients left out are fewer than so many times the last few: they fall by a third each.
TAIL, LAST = 8.0, 3
# Points for each coefficient where a series in doubt is looked at.
FINER = 8
# The n-th derivative magnifies the round-off of coefficients, on [-1, 1], up to NODES^(2 n).
MAGNIFIED = float(NODES) ** 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Brackets:
    """Brackets of the first roots of n functions, each of shape (n,).

    Attributes
    ----------
    near, far : ndarray
        Ends of the bracket, in the order of the way; it holds one root.
    found : ndarray of bool
        Whether there is a root.
    decided : ndarray of bool
        Whether that is more than round-off.
    """

    near: Floats
    far: Floats
    found: NDArray[np.bool_]
    decided: NDArray[np.bool_]


Sampled = Callable[[NDArray[np.intp], Floats], tuple[Floats, Floats]]


def first_brackets(f: Sampled, start: Floats, stop: Floats) -> Brackets:
    """Bracket the first root of each function between `start` and `stop`, `start` excluded.

    Parameters
    ----------
    f : callable
        From the numbers of some functions, shape (k,), and places of shape (m, k), to their values
        and the round-off of these, each of shape (m, k). Positive beside `start`, and analytic but
        at 0 and pi.
    start, stop : ndarray, shape (n,)
        Positive; the way leads up or down.

    Returns
    -------
    Brackets
    """
    near, way = start.astype(float), np.sign(stop - start)
    step = _reach(near, stop)
    left, right = near.copy(), near.copy()
    found, decided = np.zeros(start.shape, dtype=bool), np.ones(start.shape, dtype=bool)
    active = np.flatnonzero(near != stop)
    for _ in range(MOST_STEPS):
        if not active.size:
            break
        x = near[active]
        y = _limited(x + way[active] * step[active], stop[active], way[active])
        verdict = _judged(f, active, x, y)
        ends = verdict.root | ~verdict.decided
        done = active[ends]
        left[done], right[done] = x[ends], verdict.far[ends]
        found[done], decided[done] = verdict.root[ends], verdict.decided[ends]
        # an interval that no double divides any more
        stuck = ~verdict.settled & (np.abs(y - x) <= 4 * np.spacing(x))
        decided[active[stuck]] = False
        halved = ~verdict.settled & ~ends
        step[active[halved]] /= 2
        passed = verdict.settled & ~ends
        gone = active[passed]
        near[gone] = y[passed]
        step[gone] = np.minimum(2 * step[gone], _reach(near[gone], stop[gone]))
        active = active[~ends & ~stuck & (near[active] != stop[active])]
    decided[active] = False
    return Brackets(near=left, far=right, found=found, decided=decided)


def _reach(near: Floats, stop: Floats) -> Floats:
    """Longest step from a point that stays one octave."""
    return np.asarray(np.where(stop < near, LONGEST * near, near))


def _limited(far: Floats, stop: Floats, way: Floats) -> Floats:
    return np.asarray(np.where(way * (far - stop) >= 0, stop, far))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Verdict:
    """Knowledge of f on an interval, each of shape (k,)."""

    settled: NDArray[np.bool_]
    root: NDArray[np.bool_]
    decided: NDArray[np.bool_]
    far: Floats


def _judged(f: Sampled, which: NDArray[np.intp], x: Floats, y: Floats) -> _Verdict:
    """Judge the functions on the intervals from x to y, of shape (k,)."""
    angles = np.pi * (np.arange(NODES)[:, None] + 0.5) / NODES
    # from x at +1 to y at -1
    middle, half = (x + y) / 2, (x - y) / 2
    values, noise = f(which, middle + half * np.cos(angles))
    series = dct(values, axis=0) / NODES
    series[0] /= 2
    noise = noise.max(axis=0)
    # without a library of linear algebra, whose threads decide the last bits of many releases
    slope = np.einsum("jk,kn->jn", derivative(NODES), series)
    bend = np.einsum("jk,kn->jn", derivative(NODES), slope)
    weight = np.abs(series).max(axis=0) * np.finfo(float).eps
    keeps = _outweighs(series, noise) & (series[0] > 0)
    monotone = _outweighs(slope, MAGNIFIED * (weight + noise))
    bent = _outweighs(bend, MAGNIFIED**2 * (weight + noise))
    convex = bent & (bend[0] > 0)
    at_far, _ = f(which, y[None])
    settled = keeps | monotone | bent
    root = ~keeps & settled & (at_far[0] <= 0)
    far, decided = y.copy(), np.ones(x.shape, dtype=bool)
    # d/dx runs towards x: a minimum lies inside where it is negative at y and positive at x
    dips = ~keeps & ~monotone & convex
    dips &= (clenshaw(slope, -np.ones_like(x)) < 0) & (clenshaw(slope, np.ones_like(x)) > 0)
    deep = np.flatnonzero(dips)
    if deep.size:
        place = bracketed_roots(
            lambda at: clenshaw(slope[:, deep], at), -np.ones(deep.size), np.ones(deep.size)
        )
        bottom = middle[deep] + half[deep] * place
        least, doubt = f(which[deep], bottom[None])
        below = least[0] <= 0
        root[deep] = below
        far[deep] = np.where(below, bottom, y[deep])
        decided[deep] = np.abs(least[0]) > doubt[0]
    return _Verdict(settled=settled, root=root, decided=decided, far=far)


def _outweighs(series: Floats, noise: Floats) -> NDArray[np.bool_]:
    """Return whether the first coefficient exceeds the sum of the others and the noise."""
    return np.asarray(np.abs(series[0]) > np.abs(series[1:]).sum(axis=0) + noise)


def stays_positive(values: Floats, series: Floats) -> NDArray[np.bool_]:
    """Return whether cosine series are shown to be positive everywhere, shape (n,).

    Between neighbouring points a distance d apart a function is less than d^2/8 of its largest
    second derivative below the smaller of the two. What the series leaves out is taken for no more
    than TAIL of its last coefficients: it converges exponentially.

    Parameters
    ----------
    values : ndarray, shape (p, n)
        At p evenly spaced points of [0, pi], the first and the last no farther than half a
        distance from the ends.
    series : ndarray, shape (m, n)
        Coefficients of cos(k u).
    """
    p, m = values.shape[0], series.shape[0]
    size = np.abs(series)
    bend = np.square(np.arange(m)) @ size
    tail = TAIL * size[-LAST:].max(axis=0) + m * np.finfo(float).eps * size.max(axis=0)
    positive = values.min(axis=0) > tail + (np.pi / (p - 1)) ** 2 / 8 * bend
    doubted = np.flatnonzero(~positive)
    if doubted.size:
        points = FINER * m
        spacing = np.pi / points
        waves = np.cos(spacing * np.outer(np.arange(points + 1), np.arange(m)))
        least = (waves @ series[:, doubted]).min(axis=0)
        positive[doubted] = least > tail[doubted] + spacing**2 / 8 * bend[doubted]
    return np.asarray(positive)
