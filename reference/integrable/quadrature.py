"""The integrals of one period of the motion, by the midpoint rule on the elliptic clock.

The rates of t, psi and psi + theta are even, analytic and periodic in the clock's time, so the rule
converges exponentially: with the nodes that `nodes_needed` asks for it is exact to round-off.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reference.integrable.brackets import stays_positive
from reference.integrable.effective_potential import BESIDE as SHORT
from reference.integrable.effective_potential import (
    EffectivePotential,
    PotentialState,
    between,
    effective_potential,
    energy_noise,
    evaluate_potential,
    select_potential,
)
from reference.integrable.elliptic import EllipticSubstitution
from reference.integrable.turning_points import TurningPoints
from reference.problem.states import Floats

# Nodes that make exp(-2 pi strip nodes/K) smaller than round-off: 38 is -log of 3e-17.
DECADES = 38.0
MOST_NODES = 4096
# So near the reference, over the distance of the second point, that it stands for the reference.
BESIDE = 1e-20
# A peak is flat: 4^-12 of the distance between nodes is 4^-24 in the value.
PEAK_ROUNDS = 12
# Share of g at one of some tens of nodes: of an integral a hundredth of it.
LOST = 1e-10
# Two values of g whose round-off adds up, each bounded by what single roundings leave.
ALIKE = 16.0
# The rule's error is the square of the highest harmonic it resolves.
TAIL = 3e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Rates:
    """Rates in the clock's time u, shape (m, n): of t, of psi and of psi + theta.

    Attributes
    ----------
    room : ndarray
        g S^2 over the quartic of the clock: smooth, and positive between two turning points. Where
        it is not, the rates are no numbers.
    noise : ndarray
        Round-off of g as a share of g, where care was asked for.
    """

    time: Floats
    precession: Floats
    total: Floats
    psi_dot: Floats
    room: Floats
    noise: Floats


def select_points(points: TurningPoints, index: NDArray[np.intp]) -> TurningPoints:
    """Return some of the releases."""
    return TurningPoints(
        well=select_potential(points.well, index),
        released=select_potential(points.released, index),
        low=points.low[index],
        high=points.high[index],
        swing=points.swing[index],
        climb=points.climb[index],
        fall=points.fall[index],
        code=points.code[index],
    )


def elliptic_substitution(points: TurningPoints) -> EllipticSubstitution:
    """Return the clock between the turning points, aware of the balanced can beyond them.

    The root of g beyond phi_max is estimated from slope and curvature there; the estimate sets
    how fast the rule converges, not what it converges to.
    """
    well, high = points.well, points.high
    aside = np.minimum(1e-3 * high, 0.5 * points.swing)
    below = np.stack([BESIDE * aside, aside])
    near, far = evaluate_potential(well, high - below, below).slope
    # g/(r - phi) is linear beside the reference and vanishes again at the root beyond it: a small
    # distance to it is known to its own digits, because the slope at the reference is
    drop = far - near
    with np.errstate(divide="ignore", over="ignore"):
        reach = np.where(drop > 0, near * aside / np.where(drop > 0, drop, 1.0), np.inf)
    beyond = high + np.clip(reach, 2 * np.spacing(high), np.pi - high)
    return EllipticSubstitution(low=points.low, high=high, swing=points.swing, fourth_root=beyond)


def nodes_needed(clock: EllipticSubstitution) -> NDArray[np.int64]:
    """Nodes of the midpoint rule, rounded up so that few different numbers occur, shape (n,)."""
    raw = DECADES * clock.quarter / (2 * np.pi * clock.analyticity_strip) + 4
    return np.asarray(8 * np.ceil(raw / 8), dtype=np.int64)


def rates(
    points: TurningPoints, clock: EllipticSubstitution, fraction: Floats, *, careful: bool = False
) -> Rates:
    """Rates of the motion in the clock's time.

    Parameters
    ----------
    points : TurningPoints
    clock : Clock
    fraction : ndarray, shape (m, 1) or (m, n)
        Where, as a fraction of K, inside (0, 1).
    careful : bool
        Whether to take g from where it is known best (`energy_left`).

    Returns
    -------
    Rates
    """
    phi, rise, gap = clock.nutation(fraction)
    state, g, noise = energy_left(points, phi, rise, gap, careful=careful)
    can = points.well.can
    S = state.sine
    outside = (phi + points.low) * ((clock.fourth_root - clock.high) + gap)
    room = S**2 * (g / (rise * gap)) / outside
    time = np.sqrt((can.a_p + 1) / 2) * clock.scale * S / np.sqrt(np.where(room > 0, room, np.nan))
    psi_dot = state.b / S**2
    return Rates(
        time=time,
        precession=psi_dot * time,
        total=state.spin * time,
        psi_dot=psi_dot,
        room=room,
        noise=np.divide(noise, np.abs(g), out=np.zeros_like(g), where=g != 0),
    )


def energy_left(
    points: TurningPoints, phi: Floats, rise: Floats, gap: Floats, *, careful: bool
) -> tuple[PotentialState, Floats, Floats]:
    """Return the state, g, and the round-off of g, at nutations of shape (m, n).

    Parameters
    ----------
    points : TurningPoints
    phi, rise, gap : ndarray, shape (m, n)
        Nutation, and its distances from phi_min and phi_max.
    careful : bool
        Whether to refer g to phi_min and to the release as well as to phi_max, and to take it from
        where it loses least: at phi_max and phi_min g is zero, at the release the energy is given.
        Two that differ by more than round-off are no number: one of the two is no turning point.
    """
    state = evaluate_potential(points.well, phi, gap)
    g = state.slope * gap
    noise = energy_noise(points.well, phi, gap, state) if careful else np.zeros_like(g)
    from_release = np.where(rise < gap, points.fall - rise, gap - points.climb)
    for well, below in (
        ((_from_below(points), -rise), (points.released, from_release)) if careful else ()
    ):
        other = evaluate_potential(well, phi, below)
        value = np.where(below == 0, well.excess, other.slope * below)
        lost = energy_noise(well, phi, below, other)
        value = np.where(np.abs(value - g) <= ALIKE * (noise + lost), value, np.nan)
        g = np.where((lost < noise) | np.isnan(value), value, g)
        noise = np.minimum(lost, noise)
    # of a small oscillation even the first order of g is round-off of its terms
    small = np.flatnonzero(points.well.poised & (points.swing < SHORT * points.high))
    if small.size:
        up, down = rise[:, small], gap[:, small]
        inside, lost = between(select_potential(points.well, small), up, down)
        g[:, small], noise[:, small] = inside * up * down, lost * up * down
    return state, g, noise


def _from_below(points: TurningPoints) -> EffectivePotential:
    """Return the wells, referred to phi_min."""
    released, rests = points.released, points.fall == 0
    bottom = evaluate_potential(released, points.low[None], points.fall[None])
    return effective_potential(
        released.can,
        released.series,
        phi=points.low,
        # at the release itself its own values are exact
        b=np.where(rests, released.b, bottom.b[0]),
        spin=np.where(rests, released.spin, bottom.spin[0]),
        excess=np.zeros_like(points.low),
        B=released.B,
        short=released.short + points.fall,
    )


def cycle_integrals(points: TurningPoints, nodes: int, *, careful: bool) -> tuple[Floats, ...]:
    """Return period, turn, rotation, phi_min, phi_max, peak rate, each of shape (n,), and doubt.

    The nodes are doubled where they turn out too few. Doubt is 1, and the others mean nothing,
    where g was not shown to be positive between the turning points, the rule did not converge, or,
    of releases without care, g all but cancels near phi_min.
    """
    clock = elliptic_substitution(points)
    fraction = (np.arange(nodes)[:, None] + 0.5) / nodes
    at_nodes = rates(points, clock, fraction, careful=careful)
    scale = 2 * clock.quarter / nodes
    period, turn, total = (
        scale * part.sum(axis=0) for part in (at_nodes.time, at_nodes.precession, at_nodes.total)
    )
    doubt = ~known_positive(at_nodes)
    if not careful:
        doubt |= _loses_digits(points, clock, at_nodes, fraction)
    rough = ~doubt & unresolved(at_nodes)
    values = [period, turn, total - turn, points.low, points.high, peak_rate(points, at_nodes)]
    if nodes < MOST_NODES:
        few = np.flatnonzero(rough)
        values.append(np.asarray(doubt, dtype=float))
        if few.size:
            better = cycle_integrals(select_points(points, few), 2 * nodes, careful=careful)
            for field, value in zip(values, better, strict=True):
                field[few] = value
    else:
        values.append(np.asarray(doubt | rough, dtype=float))
    return tuple(np.array(value) for value in values)


def _loses_digits(
    points: TurningPoints, clock: EllipticSubstitution, at_nodes: Rates, fraction: Floats
) -> NDArray[np.bool_]:
    """Return whether g, referred to phi_max, has lost digits at its least or near phi_min."""
    least = np.where(at_nodes.room > 0, at_nodes.room, np.inf).argmin(axis=0)
    at = np.stack([np.broadcast_to(fraction[0], least.shape), fraction[least, 0]])
    phi, _, gap = clock.nutation(at)
    state = evaluate_potential(points.well, phi, gap)
    lost = energy_noise(points.well, phi, gap, state)
    return np.asarray((lost > LOST * np.abs(state.slope * gap)).any(axis=0))


def known_positive(at_nodes: Rates) -> NDArray[np.bool_]:
    """Return whether rates at midpoints show g to be positive between the turning points."""
    room = at_nodes.room
    series = to_cosines(room.shape[0]) @ room
    return np.asarray((room > 0).all(axis=0) & stays_positive(room, series))


@lru_cache(maxsize=64)
def to_cosines(n: int) -> Floats:
    """Matrix from values at n midpoints of [0, pi] to coefficients of cos(k u), shape (n, n)."""
    angle = np.pi * (np.arange(n) + 0.5) / n
    matrix = np.cos(np.outer(np.arange(n), angle)) * (2 / n)
    matrix[0] /= 2
    return np.asarray(matrix)


def unresolved(at_nodes: Rates) -> NDArray[np.bool_]:
    """Return where the two highest harmonics of an integrand have not yet decayed."""
    nodes = at_nodes.time.shape[0]
    angle = np.pi * (np.arange(nodes) + 0.5) / nodes
    waves = np.stack([np.cos((nodes - 1) * angle), np.cos((nodes - 2) * angle)])
    rough = np.zeros(at_nodes.time.shape[1], dtype=bool)
    for part in (at_nodes.time, at_nodes.precession, at_nodes.total):
        rough |= np.abs(waves @ part).max(axis=0) > TAIL * np.abs(part).sum(axis=0)
    return rough


def peak_rate(points: TurningPoints, at_nodes: Rates) -> Floats:
    """Return the precession rate of largest magnitude between the turning points."""
    low, high = points.low, points.high
    bottom = evaluate_potential(points.well, low[None], points.swing[None])
    ends = np.stack([bottom.b[0] / bottom.sine[0] ** 2, points.well.b / np.sin(high) ** 2])
    rate = np.concatenate([ends[:1], at_nodes.psi_dot, ends[1:]])
    best = np.abs(rate).argmax(axis=0)
    columns = np.arange(low.size)
    peak = rate[best, columns]
    inside = (best > 0) & (best < rate.shape[0] - 1)
    some = np.flatnonzero(inside)
    if some.size:
        nodes = at_nodes.psi_dot.shape[0]
        peak[some] = _peak_between(
            select_points(points, some), (best[some] - 0.5) / nodes, 1.0 / nodes
        )
    return np.asarray(peak)


def _peak_between(points: TurningPoints, fraction: Floats, width: float) -> Floats:
    """Peak precession rate around a node, by sampling ever closer; each round gains a factor 4."""
    clock = elliptic_substitution(points)
    low, high = np.clip(fraction - width, 0, 1), np.clip(fraction + width, 0, 1)
    columns = np.arange(fraction.size)
    for _ in range(PEAK_ROUNDS):
        grid = low + (high - low) * np.linspace(0, 1, 9)[:, None]
        phi, _, gap = clock.nutation(grid)
        state = evaluate_potential(points.well, phi, gap)
        rate = state.b / state.sine**2
        best = np.abs(rate).argmax(axis=0)
        low = grid[np.maximum(best - 1, 0), columns]
        high = grid[np.minimum(best + 1, 8), columns]
    return np.asarray(rate[best, columns])
