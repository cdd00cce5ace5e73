"""Vectors of shape (3, n) in the three frames of a can, and products of them.

Frame B leans and precesses with the can but does not spin with it; the level frame precesses with
it, its axes (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical; the world stands.
"""

import numpy as np

from reference.equations.state_vector import Angles
from reference.problem.states import Floats


def applied(matrix: Floats, vector: Floats) -> Floats:
    """Matrices (3, 3, n) applied to vectors."""
    return np.asarray(np.einsum("ijn,jn->in", matrix, vector))


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products, shape (n,)."""
    return np.asarray((a * b).sum(axis=0))


def length(a: Floats, b: Floats) -> Floats:
    """Length of a vector of two components, analytic in them where they are complex.

    Derivatives are taken along imaginary steps (`reference.analysis.linearisation`), which
    `np.hypot` refuses.
    """
    return np.asarray(np.sqrt(a * a + b * b) if np.iscomplexobj(a) else np.hypot(a, b))


def cross(a: Floats, b: Floats) -> Floats:
    """Vector products."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def to_level(vector: Floats, at: Angles) -> Floats:
    """From frame B to (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical."""
    return np.array(
        [at.C * vector[0] - at.S * vector[2], vector[1], at.S * vector[0] + at.C * vector[2]]
    )


def to_body(vector: Floats, at: Angles) -> Floats:
    """Back from those directions to frame B."""
    return np.array(
        [at.C * vector[0] + at.S * vector[2], vector[1], at.C * vector[2] - at.S * vector[0]]
    )


def to_precessing(vector: Floats, cos: Floats, sin: Floats) -> Floats:
    """From the world to (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical."""
    return np.array(
        [cos * vector[0] + sin * vector[1], cos * vector[1] - sin * vector[0], vector[2]]
    )
