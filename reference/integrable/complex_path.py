"""Derivatives of integrals over a bounce, along a path of complex nutations.

A period is an integral between the turning points of the nutation, T = 2 int dphi/phi', and so half
of one round both of them in the plane of complex nutations, on which phi' has no zero. So

    dT/dp = -(1/2) oint (dg/dp)/g dt,    dg/dp at a fixed nutation,

without the derivatives of the turning points, which would be infinite quantities that cancel. The
path is the elliptic clock's (`reference.integrable.elliptic`) shifted by an imaginary constant, on
which all rates are analytic and periodic: the midpoint rule converges exponentially as it does on
the real line. Turn and rotation are integrals of the same kind; that of the turn of a deep bounce
takes a path that moves (`reference.integrable.deep_tangents`). That nothing singular lies between
the path and the real line is seen from the integrals themselves, which must be the same on both.
"""

import numpy as np
from scipy.special import ellipj, elliprf

from reference.integrable.deep_tangents import is_deep, turn_on_path
from reference.integrable.elliptic import EllipticSubstitution, squared_sn_cn
from reference.integrable.quadrature import elliptic_substitution
from reference.integrable.tangents import ClockNodes, TangentState, TangentWell, tangent_state
from reference.integrable.turning_points import TurningPoints
from reference.numerics.jets import Jet, jet_where
from reference.problem.problem import Problem
from reference.problem.states import Floats

# How high the path runs, as a share of the strip in which the rates are known to be analytic.
HEIGHT = 0.5
# Nodes that make exp(-2 pi height nodes/K) smaller than round-off: 38 is -log of 3e-17.
DECADES = 38.0
# Lower than this share of the first height a path is not tried.
LOWEST = 1 / 64
# Largest relative difference of an integral on the path from that on the real line.
ALIKE = 1e-9
# Elliptic functions of arguments below this are near their arguments.
CLOSE = 0.05
# Nodes of Gauss's rule on a path from the release to the maximum of phi.
LEGS = 120


def nodes_on_path(
    points: TurningPoints, clock: EllipticSubstitution, left: Floats, height: Floats
) -> ClockNodes:
    """Return nodes at u = (1 - left) K + i height, shapes (m, 1) or (m, n).

    By the addition theorem of the elliptic functions, each part to its own round-off.
    """
    k1 = clock.complementary
    sn2, cn2 = squared_sn_cn(left, k1)
    # theta series know a sine that is all but zero to absolute round-off
    way = left * clock.quarter
    sn2 = np.where(way < CLOSE, ellipj(np.minimum(way, CLOSE), 1 - k1)[0] ** 2, sn2)
    dn2 = k1 + (1 - k1) * cn2
    # reflected about K/2: sn(K - x) = cn/dn, cn(K - x) = k' sn/dn, dn(K - x) = k'/dn
    s, c, d = np.sqrt(cn2 / dn2), np.sqrt(k1 * sn2 / dn2), np.sqrt(k1 / dn2)
    s1, c1, d1, _ = ellipj(height, k1)
    below = c1**2 + (1 - k1) * s**2 * s1**2
    sn2 = ((s * d1 + 1j * c * d * s1 * c1) / below) ** 2
    cn2 = ((c * c1 - 1j * s * d * s1 * d1) / below) ** 2
    swing, low = clock.swing, clock.low
    denominator = swing * cn2 + 2 * low
    rise = 2 * low * swing * sn2 / denominator
    gap = swing * (clock.high + low) * cn2 / denominator
    nearer = np.abs(rise) < np.abs(gap)
    return ClockNodes(
        phi=np.where(nearer, low + rise, clock.high - gap),
        rise=rise,
        gap=gap,
        below=np.where(nearer, points.fall - rise, gap - points.climb),
    )


def rates_on_path(
    well: TangentWell, state: TangentState, clock: EllipticSubstitution, nodes: ClockNodes
) -> tuple[Jet, Jet, Jet]:
    """Return the rates of t, psi and psi + theta in the clock's time, shape (m, n)."""
    sine, inertia = state.sine.value, well.inertia
    outside = (nodes.phi + clock.low) * ((clock.fourth_root - clock.high) + nodes.gap)
    room = sine**2 * (state.g.value / (nodes.rise * nodes.gap)) / outside
    pace = np.sqrt(inertia.value / 2) * clock.scale * sine / np.sqrt(room)
    growth = (
        inertia.slope / inertia.value[..., None] - state.g.slope / state.g.value[..., None]
    ) / 2
    time = Jet(pace, pace[..., None] * growth)
    return time, time * state.psi_dot, time * state.spin


def cycle_tangents(
    points: TurningPoints, well: TangentWell, known: tuple[Floats, ...]
) -> tuple[Jet, Jet, Jet]:
    """Return period, turn and turn of psi + theta between maxima, in jets of shape (n,).

    Parameters
    ----------
    points : TurningPoints
    well : TangentWell
        Of the same releases.
    known : tuple of ndarray, shape (n,)
        The integrals on the real line.

    Not numbers where a singularity is so near the real line that no path runs below it.
    """
    clock = elliptic_substitution(points)
    height = HEIGHT * clock.analyticity_strip
    lowest = LOWEST * height
    while True:
        count = int(np.ceil((DECADES * clock.quarter / (2 * np.pi * height)).max())) + 8
        midpoints = (np.arange(count)[:, None] + 0.5) / count
        nodes = nodes_on_path(points, clock, midpoints, height)
        scale = 2 * clock.quarter / count
        parts = []
        with np.errstate(all="ignore"):  # a path across a singularity shows in the values
            state = tangent_state(well, nodes.phi, nodes.below)
            time, precession, rotation = rates_on_path(well, state, clock, nodes)
            if (deep := is_deep(clock.low, clock.high)).any():
                own = turn_on_path(well, state, nodes, clock.high, time.value)
                precession = jet_where(np.broadcast_to(deep, nodes.phi.shape), own, precession)
            for rate in (time, precession, rotation):
                total = rate.real
                parts.append(
                    Jet(
                        scale * total.value.sum(axis=0),
                        scale[..., None] * total.slope.sum(axis=0),
                    )
                )
        gap = np.zeros_like(height)
        for part, value in zip(parts, known, strict=True):
            size = np.abs(value) + np.abs(known[1])
            gap = np.maximum(gap, np.abs(part.value - value) / np.maximum(size, 1e-300))
        wrong = ~(gap <= ALIKE)
        if not (wrong & (height >= lowest)).any():
            nothing = np.where(wrong, np.nan, 0.0)
            period, turn, total = (Jet(part.value, part.slope + nothing[:, None]) for part in parts)
            return period, turn, total
        height = np.where(wrong, height / 2, height)


def skipped_tangents(
    points: TurningPoints, well: TangentWell, problem: Problem
) -> tuple[Jet, Jet, Jet]:
    """Return time, turn and turn of psi + theta from phi_max down to a falling release, in jets.

    They are what the first bounce of a falling release lacks of a whole cycle: integrals along half
    of a path from the release round phi_max and back. Not numbers where twice the nodes give other
    ones.
    """
    clock = elliptic_substitution(points)
    left = _before_maximum(points, clock)
    top = np.minimum(HEIGHT * clock.analyticity_strip, left / 2)
    ends = (1.0, problem.psi_dot, problem.psi_dot + problem.theta_dot)
    found = []
    for legs in (LEGS, 2 * LEGS):
        x, weight = np.polynomial.legendre.leggauss(legs)
        share = ((x + 1) / 2)[:, None]
        nodes = nodes_on_path(
            points, clock, left / clock.quarter * (1 - share), top * np.sin(np.pi / 2 * share)
        )
        step = left + 0.5j * np.pi * top * np.cos(np.pi / 2 * share)
        step = step * weight[:, None] / 2
        rates = rates_on_path(well, tangent_state(well, nodes.phi, nodes.below), clock, nodes)
        found.append(
            [
                Jet(
                    (step * rate.value).sum(axis=0).real,
                    (step[..., None] * rate.slope).sum(axis=0).real
                    - end / abs(problem.phi_dot) * well.reference.slope,
                )
                for rate, end in zip(rates, ends, strict=True)
            ]
        )
    out = []
    for few, many in zip(*found, strict=True):
        # near its minimum a release has a pole beside it, which no such rule integrates
        gap = np.abs(few.slope - many.slope).max(axis=-1) / np.abs(many.slope).max(axis=-1)
        nothing = np.where(gap <= ALIKE, 0.0, np.nan)
        out.append(Jet(many.value, many.slope + nothing[:, None]))
    return out[0], out[1], out[2]


def _before_maximum(points: TurningPoints, clock: EllipticSubstitution) -> Floats:
    """Return the clock's time between the release and phi_max, to relative round-off, shape (n,).

    From cn^2 there, by Carlson's integral, of which no argument is a difference.
    """
    k1, climb = clock.complementary, points.climb
    cn2 = 2 * clock.low * climb / (clock.swing * (clock.high + clock.low - climb))
    # of the time that is left: sn^2, cn^2 and dn^2
    total = k1 + (1 - k1) * cn2
    sn2, cn2, dn2 = cn2 / total, k1 * (1 - cn2) / total, k1 / total
    return np.asarray(np.sqrt(sn2) * elliprf(cn2, dn2, 1.0))
