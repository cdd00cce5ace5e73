"""Many bracketed roots at once."""

from collections.abc import Callable

import numpy as np

from reference.problem.states import Floats

# Bisection alone needs 53 halvings to exhaust a double; the mixed rule never needs twice that.
MOST_ITERATIONS = 100


def bracketed_roots(f: Callable[[Floats], Floats], left: Floats, right: Floats) -> Floats:
    """Roots of n functions, each between `left` and `right`, to round-off.

    Inverse quadratic interpolation guarded by bisection (Chandrupatla 1997). Where f has one sign
    on both ends, the end with the smaller magnitude is returned.

    Parameters
    ----------
    f : callable
        From shape (n,) to shape (n,), elementwise.
    left, right : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,)
    """
    a, b = left.astype(float), right.astype(float)
    fa, fb = f(a), f(b)
    c, fc = a.copy(), fa.copy()
    fraction = np.full(a.shape, 0.5)
    settled = (fa == 0) | (fb == 0) | (np.sign(fa) == np.sign(fb))
    best = np.where(np.abs(fa) < np.abs(fb), a, b)
    for _ in range(MOST_ITERATIONS):
        if settled.all():
            break
        x = np.where(settled, best, b + fraction * (a - b))
        fx = f(x)
        same = np.sign(fx) == np.sign(fb)
        # the bracket is always (a, b) with the newest point b; c is the one that was dropped
        c, fc = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = x, fx
        # of the ends of the bracket: an end left behind may have a smaller value and be far away
        best = np.where(settled, best, np.where(np.abs(fa) < np.abs(fb), a, b))
        width = np.abs(a - b)
        tolerance = 2 * np.spacing(np.maximum(np.abs(a), np.abs(b)))
        settled |= (width <= tolerance) | (fx == 0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            xi, ratio = (b - a) / (c - a), (fb - fa) / (fc - fa)
            quadratic = (ratio**2 < xi) & ((1 - ratio) ** 2 < 1 - xi)
            step = fb / (fa - fb) * (fc / (fa - fc)) + fb / (fc - fb) * (fa / (fc - fa)) * (
                (c - b) / (a - b)
            )
            # fraction of the way from b to a
            step = np.where(quadratic & np.isfinite(step), step, 0.5)
            nearest = 0.5 * tolerance / width
        fraction = np.clip(step, np.fmin(nearest, 0.5), np.fmax(1 - nearest, 0.5))
    return np.asarray(best)
