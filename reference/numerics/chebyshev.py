"""Polynomials on Chebyshev points: values, integrals, coefficients.

On [-1, 1], at the n points -cos(pi j/(n - 1)) that contain both ends.
"""

from functools import lru_cache

import numpy as np

from reference.problem.states import Floats


@lru_cache(maxsize=8)
def points(n: int) -> Floats:
    """Return the nodes, increasing, shape (n,)."""
    return -np.cos(np.pi * np.arange(n) / (n - 1))


@lru_cache(maxsize=8)
def to_coefficients(n: int) -> Floats:
    """Matrix from values at the nodes to Chebyshev coefficients, shape (n, n)."""
    j = np.arange(n)
    # T_k at the nodes, orthogonal under the sum with halved ends
    matrix = np.cos(np.pi * np.outer(j, n - 1 - j) / (n - 1)) * (2 / (n - 1))
    matrix[:, [0, -1]] /= 2
    matrix[[0, -1], :] /= 2
    return np.asarray(matrix)


@lru_cache(maxsize=8)
def integrator(n: int) -> Floats:
    """Matrix from values to the integral from -1 to each node, shape (n, n)."""
    nodes = points(n)
    k = np.arange(n)
    angle = np.arccos(np.clip(nodes, -1, 1))[:, None]
    T = np.cos(k * angle)
    up = np.cos((k + 1) * angle) / (2 * (k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        down = np.where(k > 1, np.cos((k - 1) * angle) / (2 * (k - 1)), 0.0)
    primitive = up - down
    primitive[:, 0] = nodes
    primitive[:, 1] = T[:, 1] ** 2 / 2
    primitive -= primitive[:1]
    return np.asarray(primitive @ to_coefficients(n))


@lru_cache(maxsize=8)
def derivative(n: int) -> Floats:
    """Matrix from Chebyshev coefficients to those of the derivative, shape (n, n)."""
    row, column = np.indices((n, n))
    matrix = np.where((column > row) & ((column - row) % 2 == 1), 2.0 * column, 0.0)
    matrix[0] /= 2
    return np.asarray(matrix)


def waves(n: int, x: Floats) -> Floats:
    """Return the first n Chebyshev polynomials at `x` in [-1, 1], shape (n, ...)."""
    return np.asarray(np.cos(np.multiply.outer(np.arange(n), np.arccos(x))))


def clenshaw(coefficients: Floats, x: Floats) -> Floats:
    """Value of Chebyshev series, coefficients of shape (terms, ...) broadcast against x."""
    x2 = 2 * x
    b1, b2, spare = np.zeros((3, *np.broadcast_shapes(coefficients.shape[1:], x.shape)))
    for row in coefficients[:0:-1]:
        np.multiply(x2, b1, out=spare)  # arrays written over: new ones leave the processor's cache
        spare -= b2
        spare += row
        b1, b2, spare = spare, b1, b2
    return np.asarray(x * b1 - b2 + coefficients[0])
