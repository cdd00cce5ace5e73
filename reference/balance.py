"""How far a nutation is short of the balancing angle (eq:phistar), exactly for the doubles given.

phi* = arctan(1/h) is no double, and a can released beside it falls after a time that is the
logarithm of its distance: of a distance of 1e-12 the nearest double knows four digits. Here phi* is
carried as a double and a rest, so that every distance has all its digits. The rest comes from one
Newton step, sin(phi* - x) = (cos x - h sin x)/sqrt(1 + h^2), in numbers of thirty digits.
"""

from functools import lru_cache

import numpy as np

from reference.double_double import exact_product, less, sine_and_cosine
from reference.states import Floats


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
        nearest, rest = _balance_of_one(float(np.reshape(h, ())))
        return np.asarray((nearest - phi) + rest)
    rounded = np.asarray(np.arctan2(1.0, h))
    return np.asarray((rounded - phi) + _rest(np.asarray(h), rounded))


@lru_cache(maxsize=256)
def _balance_of_one(h: float) -> tuple[float, float]:
    """phi* of one can as a double and a rest."""
    rounded = np.arctan2(1.0, np.asarray(h))
    return float(rounded), float(_rest(np.asarray(h), np.asarray(rounded)))


def _rest(h: Floats, rounded: Floats) -> Floats:
    """Return what the rounded balancing angle lacks."""
    sine, cosine = sine_and_cosine(rounded)
    product, rest = exact_product(h, sine[0])
    residual = less(cosine, (product, rest + h * sine[1]))
    return np.asarray((residual[0] + residual[1]) / np.sqrt(1 + h * h))
