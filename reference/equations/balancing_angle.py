"""Distance of a nutation from the balancing angle (eq:phistar), exact for the doubles given.

phi* = arctan(1/h) is no double, and a can released near it falls after a time that is the
logarithm of its distance: of a distance of 1e-12 the nearest double knows four digits. Here phi* is
carried as a double and a rest, so that every distance has all its digits. The rest comes from one
Newton step, sin(phi* - x) = (cos x - h sin x)/sqrt(1 + h^2), in numbers of thirty digits.

Numbers of thirty digits: unevaluated sums of two doubles.

Error-free transformations (Dekker 1971, Knuth 1969): a sum or a product of two doubles is a double
and a rest, both exact. Enough arithmetic is built on them for the sine and cosine of a double; it
is elementwise and the same on every platform, unlike extended precision.
"""

from functools import lru_cache
from typing import TypeAlias, TypeVar

import numpy as np

from reference.problem.states import Floats

Pair: TypeAlias = tuple[Floats, Floats]
Angle = TypeVar("Angle", float, Floats)
# 2^27 + 1 parts a double into two halves whose products are exact.
SPLITTER = 134217729.0
# x^36/36! is 2e-35 at pi/2.
TERMS = 18


def exact_sum(x: Floats, y: Floats) -> Pair:
    """Sum of two doubles, and its rest."""
    total = x + y
    part = total - x
    return total, (x - (total - part)) + (y - part)


def exact_product(x: Floats, y: Floats) -> Pair:
    """Product of two doubles, and its rest, for magnitudes far from overflow."""
    product = np.asarray(x * y)
    x_high, y_high = SPLITTER * x, SPLITTER * y
    x_high, y_high = x_high - (x_high - x), y_high - (y_high - y)
    x_low, y_low = x - x_high, y - y_high
    rest = ((x_high * y_high - product) + x_high * y_low + x_low * y_high) + x_low * y_low
    return product, np.asarray(rest)


def times(x: Pair, y: Pair) -> Pair:
    """Product of two pairs."""
    product, rest = exact_product(x[0], y[0])
    return exact_sum(product, rest + (x[0] * y[1] + x[1] * y[0]))


def over(x: Pair, divisor: float) -> Pair:
    """Quotient of a pair and a double."""
    quotient = np.asarray(x[0] / divisor)
    product, rest = exact_product(quotient, np.asarray(divisor))
    return exact_sum(quotient, ((x[0] - product) - rest + x[1]) / divisor)


def less(x: Pair, y: Pair) -> Pair:
    """Difference of two pairs."""
    total, rest = exact_sum(x[0], -y[0])
    return exact_sum(total, rest + (x[1] - y[1]))


def sine_and_cosine(x: Floats) -> tuple[Pair, Pair]:
    """Sine and cosine of doubles in [-pi/2, pi/2], to some 1e-31.

    Parameters
    ----------
    x : ndarray

    Returns
    -------
    (high, low), (high, low) : pairs of ndarray, shape of `x`
    """
    square = exact_product(x, x)
    one: Pair = (np.ones_like(x), np.zeros_like(x))
    sine = cosine = one
    for n in range(TERMS, 0, -1):
        # 1 - x^2/(2n (2n + 1)) (1 - ...), and likewise for the cosine
        sine = less(one, over(times(square, sine), 2.0 * n * (2 * n + 1)))
        cosine = less(one, over(times(square, cosine), 2.0 * n * (2 * n - 1)))
    return times((x, np.zeros_like(x)), sine), cosine


def short_of_balance(h: Floats, phi: Floats) -> Floats:
    """phi* - phi to relative round-off.

    Parameters
    ----------
    h : ndarray, shape () or broadcastable
        Half the height over the radius.
    phi : ndarray, shape (n,)
        Nutation, in rad.

    Returns
    -------
    ndarray, shape (n,)
    """
    if np.size(h) == 1:
        return np.asarray(short_of_one(float(np.reshape(h, ())), phi))
    rounded, remainder = balancing_angle(np.asarray(h))
    return np.asarray((rounded - phi) + remainder)


def short_of_one(h: float, phi: Angle) -> Angle:
    """phi* - phi of one can, as `short_of_balance` has it: in numbers it takes a tenth as long."""
    nearest, rest = _balance_of_one(h)
    return (nearest - phi) + rest


def balancing_angle(h: Floats) -> Pair:
    """phi* as a double and a rest, each of the shape of `h`."""
    rounded = np.asarray(np.arctan2(1.0, h))
    return rounded, _rest(h, rounded)


@lru_cache(maxsize=256)
def _balance_of_one(h: float) -> tuple[float, float]:
    rounded, rest = balancing_angle(np.asarray(h))
    return float(rounded), float(rest)


def _rest(h: Floats, rounded: Floats) -> Floats:
    """Return the difference of the exact balancing angle and the rounded one."""
    sine, cosine = sine_and_cosine(rounded)
    product, rest = exact_product(h, sine[0])
    residual = less(cosine, (product, rest + h * sine[1]))
    return np.asarray((residual[0] + residual[1]) / np.sqrt(1 + h * h))
