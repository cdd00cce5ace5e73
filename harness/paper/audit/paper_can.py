"""The paper's can and its release, in numbers as printed."""

from collections.abc import Callable
from itertools import product

import mpmath as mp

with mp.workdps(80):  # more than any check asks for
    RADIUS, HALF_HEIGHT = mp.mpf("3.7e-2"), mp.mpf("5.45e-2")
    MOMENT_A, MOMENT_C = mp.mpf("6.97e-5"), mp.mpf("5.89e-5")
    a, c, h = mp.mpf("0.727"), mp.mpf("0.615"), mp.mpf("1.473")
    a_p, c_p = a + h**2, c + 1
    k = c / (a + c * a_p)
    # unit of time in s; the paper does not print g, and 9.8 changes the fourth digit of a rate
    SECOND = mp.sqrt(RADIUS / mp.mpf("9.81"))
    PHI = mp.pi / 100
    # of the release, in sqrt(g/R): the paper prints them in rad/s
    PSI_DOT, THETA_DOT = mp.mpf("0.1001") * SECOND, mp.mpf("-0.1") * SECOND
    # the paper's I: phi(0) = I/2
    WIDTH = 2 * PHI


def reach(value: Callable[..., mp.mpf], *printed: str) -> tuple[mp.mpf, mp.mpf]:
    """Return the least and the largest value of a function of rounded inputs.

    Parameters
    ----------
    value : callable
        Monotone in each argument over half a unit in the last place.
    printed : str
        The inputs as printed.
    """
    ranges = []
    for text in printed:
        half = mp.mpf(10) ** -len(text.partition(".")[2]) / 2
        ranges.append((mp.mpf(text) - half, mp.mpf(text) + half))
    found = [value(*corner) for corner in product(*ranges)]
    return min(found), max(found)
