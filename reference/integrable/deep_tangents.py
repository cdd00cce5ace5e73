"""Derivatives of deep bounces: jets at nutations that go with the first integral B.

Near the flat state b and phi are of the size of B, and g depends on b/sin(phi). There derivatives
at a fixed nutation are larger than what they add up to by 1/phi, and leave it as many digits less.
But an integral does not change where its path moves, nor a peak where its place does:

    d/dp oint f dphi = oint (f_p + (f V)_phi) dphi

for any V that is analytic along the path. With V = (B_p/B) phi (1 - x^2), x = phi/phi_max, the
ratio phi/B stays where phi is small, and so do, all but, b/B and sin(phi)/B; where phi is large,
beside a root of g, nothing moves. With beta = phi cot(phi) - 1 the terms in B_p/B of q = b/sin(phi)
and of the turn, of which b/sin(phi)^2 dphi is a factor, are

    B_p/B - V cot(phi) = (B_p/B) (x^2 (1 + beta) - beta),
    V_phi - V cot(phi) = -(B_p/B) (beta + x^2 (2 - beta)),

small where phi is: what is large has gone by algebra, and not by a subtraction.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import zeta

from reference.integrable.effective_potential import NEARLY_ALL
from reference.integrable.tangents import (
    AT,
    ClockNodes,
    TangentState,
    TangentWell,
    fixed,
    kinetic_energy,
    logarithm,
    polynomial,
)
from reference.numerics.jets import Jet, Values, jet_cos, jet_sin, jet_sqrt, jet_stack, jet_where
from reference.problem.states import Floats

# Of phi_max: a bounce with a lower phi_min is deep.
DEEP = 1e-3
# zeta(2), zeta(4), ...: terms of the series of x cot(x) in (x/pi)^2, to round-off up to 0.6 pi.
EVEN_ZETA = zeta(2.0 * np.arange(1, 41))


def is_deep(low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Return whether bounces between two nutations are deep."""
    return low < DEEP * high


def deep_state(
    well: TangentWell, state: TangentState, nodes: ClockNodes, high: Floats
) -> TangentState:
    """Return jets at nutations that go with B: of b/sin(phi), of the spin and of g to round-off.

    Parameters
    ----------
    well : TangentWell
    state : TangentState
        At the nutations as they are.
    nodes : ClockNodes
    high : ndarray, shape (n,)
        phi_max.
    """
    growth, phi = _growth(well), nodes.phi
    # 1 - x^2, by what is known of its smallness
    left = nodes.gap * (high + phi) / high**2
    V = growth * (phi * left)[..., None]
    at = Jet(phi, fixed(phi).slope + V)
    gap = Jet(nodes.below, well.reference.slope - at.slope)
    log = logarithm(well, at, gap) * well.residue
    b1, s1, b2, s2 = _series(well, at)
    S, C = jet_sin(at), jet_cos(at)
    over, square, beta = well.B.value / S.value, (phi / high) ** 2, _beta(phi)
    by = growth * (square * (1 + beta) - beta)[..., None]
    by[..., AT] -= C.value / S.value
    q = (log * b1 + b2) * Jet(over, over[..., None] * by)
    spin = (log * s1 + s2) * well.B
    start = well.b / jet_sin(well.reference)
    turned = well.spin - well.b / (jet_cos(well.reference) + 1.0)
    kinetic = kinetic_energy(well, q, spin - q * S / (C + 1.0))
    half = gap * 0.5
    lean = 2.0 * jet_sin(half) * jet_sqrt(1.0 + well.h * well.h) * jet_sin(well.short + half)
    g = well.excess + lean - (kinetic - kinetic_energy(well, start, turned))
    # elsewhere g is known as a difference from the release, and its derivatives are not large
    moved = Jet(state.g.value, state.g.slope + V * state.g.slope[..., AT:])
    g = jet_where(np.abs(nodes.below / well.reference.value) > NEARLY_ALL, g, moved)
    return TangentState(phi=at, q=q, spin=spin, sine=S, cosine=C, g=g)


def turn_on_path(
    well: TangentWell, state: TangentState, nodes: ClockNodes, high: Floats, pace: Values
) -> Jet:
    """Return the rate of psi on a path that goes with B, given that of t, shape (m, n)."""
    state = deep_state(well, state, nodes, high)
    rate, inertia = state.q / state.sine.value, well.inertia
    by = inertia.slope / inertia.value[..., None] - state.g.slope / state.g.value[..., None]
    beta, square = _beta(nodes.phi), (nodes.phi / high) ** 2
    by = by / 2 - _growth(well) * (beta + square * (2 - beta))[..., None]
    return Jet(pace * rate.value, pace[..., None] * (rate.slope + rate.value[..., None] * by))


def _series(well: TangentWell, at: Jet) -> list[Jet]:
    """Return b1, s1, and what is without a logarithm of b/B and of the spin over B."""
    share = well.K / well.B
    b1, s1, b2, s2 = (well.series[:, place] for place in range(4))
    values = polynomial(jet_stack([b1, s1, b2 + b1 * share, s2 + s1 * share], axis=1), at)
    return [values[place] for place in range(4)]


def _growth(well: TangentWell) -> Floats:
    """Return B_p/B, shape (n, k)."""
    return np.asarray(well.B.slope / well.B.value[..., None])


def _beta(x: Values) -> Values:
    """Return x cot(x) - 1 to relative round-off: -2 sum zeta(2 n) (x/pi)^(2 n)."""
    square = (x / np.pi) ** 2
    out = np.zeros_like(square)
    for term in EVEN_ZETA[::-1]:
        out = (out + term) * square
    return -2 * out
