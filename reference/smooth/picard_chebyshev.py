"""One long step of the regular equations, by Chebyshev collocation.

y(sigma) = y0 + integral of the field: the integral equation is satisfied at Chebyshev points by
fixed-point iteration, all of it matrix products. The nutation is updated first, through T = T0
exp(integral of phi'), which takes the exponential growth out of the iteration. A step of order 47
is as good as exact, or it is refused.
"""

from dataclasses import dataclass
from math import atanh, cosh, sqrt

import numpy as np

from reference.equations.regularised import (
    NUTATION_RATE,
    RISE,
    TANGENT,
    RegularEquations,
    sine_of,
    vector_field,
)
from reference.numerics.chebyshev import integrator, points, to_coefficients, waves
from reference.problem.states import Floats

NODES = 48
MOST_ITERATIONS = 40
# Without a guess the first rounds never suffice: they are not looked at.
BLIND_ROUNDS = 6
# Where phi' hardly moves phi within a step there is nothing to guess.
SLOW = 0.1
# Round-off of the kinetic force, over eps, as a share of its terms: some twenty roundings.
ROUNDED = 0.1
# As close to 1 as phi' over its speed is taken, far from the bounce.
CLOSEST = 1 - 1e-15
# An iteration that moves by this much, or to where there are no numbers, diverges.
HOPELESS = 1e3
# The iteration stands when it moves by a few units of the last place of the largest values.
STANDS = 3e-15
# A standstill above this is a step too long.
TOLERATED = 2e-14
# Chebyshev coefficients fall geometrically: the last two below this leave nothing visible behind
# them.
RESOLVED = 4e-15

NO_GUESS = np.empty((5, 0)), np.empty((5, 1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Element:
    """A converged step.

    Attributes
    ----------
    length : float
        In sigma.
    values : ndarray, shape (5, nodes)
        (T, Phi, b, s, d) at the Chebyshev points.
    evaluations : int
        Evaluations of the field, each at all nodes.
    harmonics : int
        Index of the last Chebyshev coefficient that stands out of round-off.
    scale : ndarray, shape (5, 1)
        Magnitudes of the values.
    """

    length: float
    values: Floats
    evaluations: int
    harmonics: int
    scale: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """A step that was too long: the factor by which to shorten it, and its cost."""

    shrink: float
    evaluations: int


def scales(equations: RegularEquations, values: Floats, length: float) -> Floats:
    """Return the magnitudes against which (T, Phi, b, s, d) are judged, shape (5, 1)."""
    tangent, rate, sweep, spin, rise = np.abs(values).max(axis=1).tolist()
    tiny = float(np.finfo(float).tiny)
    # an iteration that diverges may have fallen through the plane
    precession = sweep / (abs(float(values[TANGENT].min())) + tiny)
    # beside balance phi' is tiny and yet has all its digits, but for round-off of the kinetic force
    swung = precession * (precession + spin)
    speed = max(rate, ROUNDED * min(swung * length, precession)) + tiny
    # the distance from balance; and the spin is driven by the sweep through a logarithm, of order b
    fall = max(abs(equations.short), rise) + tiny
    return np.array([[tangent], [speed], [sweep + tiny], [spin + sweep + tiny], [fall]])


def advance(
    equations: RegularEquations, start: Floats, length: float, guess: Element | None
) -> Element | Refused:
    """Take one step.

    Parameters
    ----------
    equations : RegularEquations
    start : ndarray, shape (5,)
    length : float
        In sigma.
    guess : Element or None
        Where the iteration starts.

    Returns
    -------
    Element or Refused
    """
    if equations.compiled:
        return _advance_compiled(equations, start, length, guess)
    weights = integrator(NODES).T * (length / 2)
    origin = start[:, None]
    y = _bare_bounce(equations, start, length) if guess is None else guess.values
    rounds = BLIND_ROUNDS if guess is None else 1
    count, before = 0, np.inf
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        while True:
            for _ in range(rounds):
                old, y = y, origin + vector_field(equations, y) @ weights
                y[TANGENT] = start[TANGENT] * np.exp(y[NUTATION_RATE] @ weights)
            count += rounds
            rounds = 1 if guess is not None else 2
            scale = scales(equations, y, length) if guess is None else guess.scale
            moved = float((np.abs(y - old) / scale).max())
            if moved < STANDS or (moved < TOLERATED and moved > before / 2):
                break
            if not moved < HOPELESS:
                return Refused(shrink=0.3, evaluations=count)
            if count >= MOST_ITERATIONS:
                return Refused(shrink=0.5, evaluations=count)
            before = moved
    harmonics = harmonics_present(y, scale)
    if harmonics >= NODES - 2:
        return Refused(shrink=0.6, evaluations=count)
    return Element(length=length, values=y, evaluations=count, harmonics=harmonics, scale=scale)


def _advance_compiled(
    equations: RegularEquations, start: Floats, length: float, guess: Element | None
) -> Element | Refused:
    """Take one step by compiled code."""
    from reference.smooth import kernels

    shrink, count, harmonics, values, scale = kernels.converge(
        equations.forms,
        (equations.short, equations.swing),
        start,
        length,
        NO_GUESS if guess is None else (guess.values, guess.scale),
    )
    if shrink > 0:
        return Refused(shrink=shrink, evaluations=count)
    return Element(
        length=length, values=values, evaluations=count, harmonics=harmonics, scale=scale
    )


def _bare_bounce(equations: RegularEquations, start: Floats, length: float) -> Floats:
    """Return the motion without gravity near the flat state: T on a cosh, phi' on a tanh.

    A first guess: it keeps the iteration from falling through the plane.
    """
    T, Phi, b, _, _ = start.tolist()
    q = b / sine_of(T)
    speed = sqrt(Phi * Phi + equations.swing * q * q)
    y = np.repeat(start[:, None], NODES, axis=1)
    if speed * length < SLOW:
        return y
    phase = atanh(min(max(Phi / speed, -CLOSEST), CLOSEST))
    u = phase + (speed * length / 2) * (points(NODES) + 1)
    y[TANGENT] = T * np.cosh(u) / cosh(phase)
    y[NUTATION_RATE] = speed * np.tanh(u)
    y[RISE] += 2 * (np.arctan(y[TANGENT]) - np.arctan(T))
    return y


def harmonics_present(values: Floats, scale: Floats) -> int:
    """Return the index of the last Chebyshev coefficient that stands out of round-off."""
    present = np.asarray((np.abs(values @ to_coefficients(NODES).T) > RESOLVED * scale).any(axis=0))
    return int(np.flatnonzero(present)[-1])


def integral(length: float, integrand: Floats) -> Floats:
    """Return the integral from the start of a step to each node, shape of `integrand`."""
    return np.asarray(integrand @ integrator(NODES).T * (length / 2))


def shortened(element: Element, fraction: float, *, compiled: bool = False) -> Element:
    """Return the first `fraction` of a step, by interpolation."""
    x = fraction * (points(NODES) + 1) - 1
    if compiled:
        from reference.smooth import kernels

        values = kernels.values_at(element.values, x)
    else:
        at_places = waves(NODES, x.clip(-1, 1))
        values = np.asarray(element.values @ to_coefficients(NODES).T @ at_places)
    return Element(
        length=element.length * fraction,
        values=values,
        evaluations=0,
        harmonics=element.harmonics,
        scale=element.scale,
    )
