"""Friction of a circular patch of contact, which sliding and drilling share.

The rim touches in a patch of radius a with Hertz's pressure 3 N sqrt(1 - r^2/a^2)/(2 pi a^2), and
each of its elements has Coulomb's friction against its own velocity u + omega_z z x r (Contensou
1963; Erismann 1954). All elements move about one centre, at c = |u|/(a |omega_z|) from that of the
patch in units of a, and the power that friction takes is mu N a |omega_z| g(c), g the mean distance
from that centre under the pressure:

    c <= 1    g = (3 pi/16) (1 + c^2 - c^4/8)
    c >= 1    g = (3/8) (1 + c^2 - c^4/8) arcsin(1/c) + (3/64) (14 + c^2) sqrt(c^2 - 1)
                = c 2F1(-1/2, -1/2; 5/2; 1/c^2).

The Laplacian of a distance is its reciprocal, so that of g is the known potential of Hertz's
pressure, and g is elementary (those of a uniform pressure are elliptic integrals). The force
against the slip and the moment against the turning are its derivatives (R. I. Leine and C. Glocker,
Eur. J. Mech. A 22, 2003, 193-216),

    F = mu N f,  f = g',        M = mu N a m,  m = g - c g',

of pure drilling M = (3 pi/16) mu N a, of pure sliding F = mu N. Both are smooth where anything
moves, but for a singularity (c - 1)^(5/2) of f where the centre crosses the edge of the patch. The
pairs (f, m) are the limit surface: what is inside or on it holds the patch.
"""

import math
from functools import lru_cache

import numpy as np

from reference.equations.frames import length
from reference.problem.states import Floats

# From this c on the series is summed: what cancels in the closed form grows as its fourth power.
FAR = 2.0
# Terms of the series that a double has at 1/c^2 = 1/4, where the last is 4^-22 22^-4.5.
TERMS = 22
# Rounds of Newton's method or of halving after which a double has the direction.
ROUNDS = 60
RESOLVED = 4e-16


@lru_cache(maxsize=1)
def _series() -> Floats:
    """Return the coefficients of g/c in powers of 1/c^2."""
    terms = [1.0]
    for k in range(TERMS):
        terms.append(terms[-1] * (k - 0.5) ** 2 / ((k + 1) * (k + 2.5)))
    return np.array(terms)


def _sum(terms: Floats, q: Floats) -> Floats:
    total = np.zeros_like(q)
    for term in terms[::-1]:
        total = total * q + term
    return total


def force_and_moment(slide: Floats, turn: Floats) -> tuple[Floats, Floats, Floats]:
    """Return f/|u|, m/|a omega_z| and f' of speeds that are not both zero.

    Parameters
    ----------
    slide, turn : ndarray, shape (n,)
        |u| and a |omega_z|, in the same unit; may be complex.

    Returns
    -------
    tuple of ndarray, shape (n,)
        f over `slide`, m over `turn` and df/dc; analytic in both speeds, on either side of c = 1.
    """
    kind = np.result_type(slide, turn, float)
    over_slide, over_turn, slope = (np.empty(slide.shape, dtype=kind) for _ in range(3))
    inside = slide.real <= turn.real
    far = ~inside & (slide.real >= FAR * turn.real)
    near = ~inside & ~far
    if inside.any():
        own = turn[inside]
        q = (slide[inside] / own) ** 2
        over_slide[inside] = 3 * math.pi / 8 * (1 - q / 4) / own
        over_turn[inside] = 3 * math.pi / 16 * (1 - q + 3 * q * q / 8) / own
        slope[inside] = 3 * math.pi / 8 * (1 - 3 * q / 4)
    if near.any():
        own = turn[near]
        c, root = slide[near] / own, np.sqrt((slide[near] - own) * (slide[near] + own)) / own
        # arcsin(1/c), with its digits and those of its derivative beside c = 1
        q, arc = c * c, np.arctan(1 / root)
        over_slide[near] = 3 / 16 * ((4 - q) * arc + (1 + 2 / q) * root) / own
        even = 3 / 8 * (1 - q + 3 * q * q / 8) * arc + 9 / 64 * (2 - q) * root
        over_turn[near] = even / own
        slope[near] = 3 / 16 * ((4 - 3 * q) * arc + (3 - 2 / q) * root)
    if far.any():
        own, k = slide[far], np.arange(TERMS + 1)
        x = turn[far] / own
        q, terms = x * x, _series()
        over_slide[far] = _sum((1 - 2 * k) * terms, q) / own
        over_turn[far] = _sum((2 * k * terms)[1:], q) / own
        slope[far] = _sum((2 * k * (2 * k - 1) * terms)[1:], q) * x * q
    return over_slide, over_turn, slope


def friction_of_patch(motion: Floats) -> Floats:
    """Return force and moment against a motion, over mu N and mu N a, shape (3, n).

    Parameters
    ----------
    motion : ndarray, shape (3, n)
        The slip u1, u2 and a omega_z, not all zero; may be complex.
    """
    slide = length(motion[0], motion[1])
    turn = np.where(motion[2].real < 0, -motion[2], motion[2])
    over_slide, over_turn, _ = force_and_moment(slide, turn)
    return np.asarray(-motion * np.array([over_slide, over_slide, over_turn]))


def motion_against(reaction: Floats) -> Floats:
    """Return the motion that a reaction opposes at its limit, as long as mu N is for that limit.

    The pair (f, m) of a motion is normal to it on the limit surface, so that this motion is the
    normal of the surface where the ray of the reaction meets it.

    Parameters
    ----------
    reaction : ndarray, shape (3, n)
        F1, F2 and the moment over a.

    Returns
    -------
    ndarray, shape (3, n)
        Directions of (u1, u2, a omega_z), times the mu N whose limit surface the reaction lies on.
    """
    force, moment = np.hypot(reaction[0], reaction[1]), np.abs(reaction[2])
    level = np.hypot(force, moment)
    size = np.maximum(level, np.finfo(float).tiny)
    across, about = force / size, moment / size
    # the angle of (c, 1): less than that of (f, m) is from (1, 0), and between 0 and pi/2
    low, high = np.zeros_like(force), np.full_like(force, math.pi / 2)
    angle = np.arctan2(about, across)
    for _ in range(ROUNDS):
        slide, turn = np.cos(angle), np.sin(angle)
        over_slide, over_turn, slope = force_and_moment(slide, turn)
        f, m = over_slide * slide, over_turn * turn
        gap = m * across - f * about
        low, high = np.where(gap < 0, angle, low), np.where(gap < 0, high, angle)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            # f' dc of the angle, of which m has -c
            rate = slope * (slide / turn * across + about) / (turn * turn)
            newer = angle - gap / rate
        inside = (newer > low) & (newer < high)
        newer = np.where(inside, newer, (low + high) / 2)
        moved = np.abs(newer - angle).max()
        angle = newer
        if moved <= RESOLVED:
            break
    slide, turn = np.cos(angle), np.sin(angle)
    over_slide, over_turn, _ = force_and_moment(slide, turn)
    limit = level / np.hypot(over_slide * slide, over_turn * turn)
    way = np.where(
        force > 0, reaction[:2] / np.maximum(force, np.finfo(float).tiny), [[1.0], [0.0]]
    )
    way = np.array([slide * way[0], slide * way[1], turn * np.sign(reaction[2])])
    return np.asarray(-limit * way)


def friction_limit(reaction: Floats) -> Floats:
    """Return the mu N on whose limit surface a reaction lies, shape (n,).

    It grows in proportion to the reaction, and along the normal of the surface, which is the motion
    q that the reaction opposes: so it is q.reaction over q.surface. Of complex reactions it has the
    first derivatives, for q is taken of the real parts.

    Parameters
    ----------
    reaction : ndarray, shape (3, n)
        F1, F2 and the moment over a, not all zero; may be complex.
    """
    against = motion_against(reaction.real)
    surface = friction_of_patch(against)
    return np.asarray((against * reaction).sum(axis=0) / (against * surface).sum(axis=0))
