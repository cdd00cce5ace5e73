"""Derivatives of the exact bounce by the release and the can, to round-off.

A period is an integral between the turning points of the nutation, T = 2 int dphi/phi', and so half
of one round both of them in the plane of complex nutations, on which phi' has no zero. So

    dT/dp = -(1/2) oint (dg/dp)/g dt,    dg/dp at a fixed nutation,

without the derivatives of the turning points, which would be infinite quantities that cancel. The
path is the elliptic clock's (`reference.integrable.elliptic`) shifted by an imaginary constant, on
which all rates are analytic and periodic: the midpoint rule converges exponentially as it does on
the real line. Turn and rotation are integrals of the same kind. That nothing singular lies between
the path and the real line is seen from the integrals themselves, which must be the same on both.

A turning point moves by -(dg/dp)/(dg/dphi). Peaks are those of a function of the nutation, of which
at the peak only the explicit derivative is left (envelope theorem).
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, elliprf

from reference.integrable.cycle import released_potential
from reference.integrable.elliptic import EllipticSubstitution, squared_sn_cn
from reference.integrable.exact_motion import ExactPath
from reference.integrable.frobenius import CanConstants, frobenius_series
from reference.integrable.quadrature import (
    cycle_integrals,
    elliptic_substitution,
    nodes_needed,
    select_points,
)
from reference.integrable.tangents import (
    AT,
    BY,
    TangentState,
    TangentWell,
    force_ratio,
    seeds,
    tangent_state,
    tangent_well,
)
from reference.integrable.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.numerics.jets import Jet, Values
from reference.problem.outcome import Outcome
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
# Places of the clock among which a peak is looked for, and rounds that narrow it to round-off.
SAMPLES = 193
NARROWER, ROUNDS = 9, 14
# Two peaks as alike as this change places by a change of the release that no one resolves.
TIED = 1e-9
# Releases treated together: what stays in a processor's cache.
BATCH = 32


QUANTITIES = ("period", "angle_of_turn", "phi_min", "peak_psi_dot", "peak_friction_ratio")
"""What is differentiated: numbers of a `Bounce`, and the time from its maximum to the next."""
PULLED = "the plane would have to pull: the normal force is not positive throughout the bounce"


TWICE = "the peak is reached in two places of the bounce at once"
NO_PATH = "a singularity of the motion is too near its real times"


@dataclass(frozen=True, slots=True, kw_only=True)
class PathNodes:
    """Nodes of the clock's time on a path, shape (m, n), complex.

    Attributes
    ----------
    phi, below : ndarray
        Nutation, and its distance below that of the release.
    rise, gap : ndarray
        Its distances from phi_min and phi_max.
    """

    phi: Values
    rise: Values
    gap: Values
    below: Values


def nodes_on_path(
    points: TurningPoints, clock: EllipticSubstitution, left: Floats, height: Floats
) -> PathNodes:
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
    return PathNodes(
        phi=np.where(nearer, low + rise, clock.high - gap),
        rise=rise,
        gap=gap,
        below=np.where(nearer, points.fall - rise, gap - points.climb),
    )


def rates_on_path(
    well: TangentWell, clock: EllipticSubstitution, nodes: PathNodes
) -> tuple[Jet, Jet, Jet]:
    """Return the rates of t, psi and psi + theta in the clock's time, shape (m, n)."""
    state = tangent_state(well, nodes.phi, nodes.below)
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
            for rate in rates_on_path(well, clock, nodes):
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
    of a path from the release round phi_max and back.
    """
    clock = elliptic_substitution(points)
    left = _before_maximum(points, clock)
    x, weight = np.polynomial.legendre.leggauss(LEGS)
    share = ((x + 1) / 2)[:, None]
    top = np.minimum(HEIGHT * clock.analyticity_strip, left / 2)
    nodes = nodes_on_path(
        points, clock, left / clock.quarter * (1 - share), top * np.sin(np.pi / 2 * share)
    )
    step = left + 0.5j * np.pi * top * np.cos(np.pi / 2 * share)
    step = step * weight[:, None] / 2
    out = []
    ends = (1.0, problem.psi_dot, problem.psi_dot + problem.theta_dot)
    for rate, end in zip(rates_on_path(well, clock, nodes), ends, strict=True):
        value = (step * rate.value).sum(axis=0).real
        slope = (step[..., None] * rate.slope).sum(axis=0).real
        slope = slope - end / abs(problem.phi_dot) * well.reference.slope
        out.append(Jet(value, slope))
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


def turning_tangent(state: TangentState) -> Floats:
    """Return the derivatives of a root of g at which the state is, shape (n, k)."""
    slope = state.g.slope[0]
    return np.asarray(-slope[..., :AT] / slope[..., AT:])


def peak_tangent(
    points: TurningPoints, well: TangentWell, quantity: Callable[[TangentState], Jet]
) -> tuple[Jet, NDArray[np.bool_]]:
    """Return the peaks of a function of the nutation, and where there are two, of shape (n,).

    The peak is the value of largest magnitude, with its sign; no number where the function has
    none.

    Parameters
    ----------
    points : TurningPoints
    well : TangentWell
    quantity : callable
        From states to jets, shape (m, n).

    Returns
    -------
    Jet
    ndarray of bool
        Whether two places of the bounce are equally high: then there is no derivative.
    """
    clock = elliptic_substitution(points)
    columns = np.arange(points.low.size)

    def at(fraction: Floats) -> tuple[TangentState, Jet]:
        phi, rise, gap = clock.nutation(fraction)
        below = np.where(rise < gap, points.fall - rise, gap - points.climb)
        state = tangent_state(well, phi, below)
        return state, quantity(state)

    grid = np.broadcast_to(np.linspace(0.0, 1.0, SAMPLES)[:, None], (SAMPLES, columns.size))
    size = np.abs(at(grid)[1].value)
    best = size.argmax(axis=0)
    padded = np.pad(size, ((1, 1), (0, 0)), constant_values=-1.0)
    apart = np.abs(np.arange(SAMPLES)[:, None] - best) > 1
    others = np.where(apart & (size > padded[:-2]) & (size > padded[2:]), size, 0.0)
    low, high = grid[np.maximum(best - 1, 0), 0], grid[np.minimum(best + 1, SAMPLES - 1), 0]
    for _ in range(ROUNDS):
        finer = low + (high - low) * np.linspace(0.0, 1.0, NARROWER)[:, None]
        finer[-1] = high
        seen = at(finer)[1]
        # towards the peak the magnitude rises
        rising = np.sign(seen.value) * seen.slope[..., AT] > 0
        last = np.where(rising.any(axis=0), NARROWER - 1 - rising[::-1].argmax(axis=0), -1)
        low = finer[np.maximum(last, 0), columns]
        high = finer[np.minimum(last + 1, NARROWER - 1), columns]
    state, seen = at(np.stack([low, high]))
    pick = np.abs(seen.value).argmax(axis=0)
    value, slope = seen.value[pick, columns], seen.slope[pick, columns]
    force = state.g.slope[pick, columns]
    moved = -force[:, :AT] / np.where(force[:, AT:] == 0, np.nan, force[:, AT:])
    edge = (low == 0.0) | (high == 1.0)
    by = slope[:, :AT] + np.where(edge[:, None], slope[:, AT:] * moved, 0.0)
    nothing = np.where(np.isfinite(size).all(axis=0), 0.0, np.nan)
    tied = others.max(axis=0) >= np.abs(value) * (1 - TIED)
    return Jet(value, by + nothing[:, None]), np.asarray(tied)


def tangents(
    points: TurningPoints,
    well: TangentWell,
    known: tuple[Floats, ...],
    wanted: Collection[str] = QUANTITIES,
) -> tuple[dict[str, Jet], dict[str, NDArray[np.bool_]]]:
    """Return the numbers of whole bounces in jets, of shape (n,), not numbers where undecided.

    Parameters
    ----------
    points : TurningPoints
    well : TangentWell
    known : tuple of ndarray, shape (n,)
        Period, turn and turn of psi + theta.
    wanted : collection of str
        Which of `QUANTITIES`.

    Returns
    -------
    dict of str to Jet
        By the names `QUANTITIES`.
    dict of str to ndarray of bool
        Of peaks, whether there are two.
    """
    jets: dict[str, Jet] = {}
    tied: dict[str, NDArray[np.bool_]] = {}
    if "period" in wanted or "angle_of_turn" in wanted:
        jets["period"], jets["angle_of_turn"], _ = cycle_tangents(points, well, known)
    if "phi_min" in wanted:
        bottom = tangent_state(well, points.low[None], points.fall[None])
        jets["phi_min"] = Jet(points.low, turning_tangent(bottom))
    peaks: dict[str, Callable[[TangentState], Jet]] = {
        "peak_psi_dot": lambda state: state.psi_dot,
        "peak_friction_ratio": lambda state: force_ratio(well, state),
    }
    for name, quantity in peaks.items():
        if name in wanted:
            jets[name], tied[name] = peak_tangent(points, well, quantity)
    return {name: Jet(jet.value, jet.slope[..., :AT]) for name, jet in jets.items()}, tied


def bounce_tangents(problem: Problem, path: ExactPath) -> tuple[dict[str, Jet], dict[str, str]]:
    """Return the numbers of the first bounce of a rolling can in jets.

    Parameters
    ----------
    problem : Problem
        Of the ideal can; its horizon does not matter.
    path : ExactPath
        Its motion.

    Returns
    -------
    jets : dict of str to Jet, each a value and a slope of shape (7,)
        By the names `QUANTITIES`; derivatives by the numbers
        `reference.integrable.tangents.BY`, dimensionless.
    why : dict of str to str
        Why there is no derivative, of the quantities that are left out.
    """
    p = problem.parameters
    numbers = {name: getattr(p if name in {"a", "c", "h"} else problem, name) for name in BY}
    well = tangent_well(seeds(**{name: np.array([value]) for name, value in numbers.items()}))
    known = tuple(np.array([2 * part.slope]) for part in (path.time, path.precession, path.total))
    jets, tied = tangents(path.points, well, known)
    if problem.phi_dot < 0:
        early = skipped_tangents(path.points, well, problem)
        for name, skipped in zip(("period", "angle_of_turn"), early, strict=False):
            jets[name] = jets[name] - Jet(skipped.value, skipped.slope[..., :AT])
    why = {name: TWICE for name, twice in tied.items() if twice[0]}
    for name, jet in jets.items():
        if name not in why and not np.isfinite(jet.slope).all():
            why[name] = NO_PATH if name in {"period", "angle_of_turn"} else PULLED
    return {name: jet[0] for name, jet in jets.items() if name not in why}, why


def batch_tangents(wanted: Collection[str] = QUANTITIES, **numbers: Floats) -> dict[str, Jet]:
    """Return the numbers of whole bounces of many releases of ideal cans in jets, of shape (n,).

    Parameters
    ----------
    wanted : collection of str
        Which of `QUANTITIES`.
    **numbers : ndarray, shape (n,)
        By the names `reference.integrable.tangents.BY`, dimensionless.

    Returns
    -------
    dict of str to Jet
        By the names `QUANTITIES`; not numbers where there is no bounce, or no derivative.
    """
    n = numbers["phi"].size
    out = {name: Jet(np.full(n, np.nan), np.full((n, AT), np.nan)) for name in wanted}
    for start in range(0, n, BATCH):
        part = {name: value[start : start + BATCH] for name, value in numbers.items()}
        cans = {name: part[name] for name in ("a", "c", "h")}
        if all((value == value[0]).all() for value in cans.values()):
            cans = {name: value[:1] for name, value in cans.items()}
        can = CanConstants(**cans)
        release = {name: part[name] for name in ("phi", "phi_dot", "psi_dot", "theta_dot")}
        well = released_potential(can, frobenius_series(can), **release)
        points = turning_points(well, certain=True)
        rows = np.flatnonzero(points.code == OUTCOMES.index(Outcome.FINISHED))
        if not rows.size:
            continue
        points = select_points(points, rows)
        nodes = int(nodes_needed(elliptic_substitution(points)).max())
        period, turn, rotation, *_, doubt = cycle_integrals(points, nodes, careful=True)
        own = tangent_well(seeds(**{name: value[rows] for name, value in part.items()}))
        jets, tied = tangents(points, own, (period, turn, turn + rotation), wanted)
        for name in wanted:
            jet = jets[name]
            none = (doubt != 0) | tied.get(name, np.zeros(rows.size, dtype=bool))
            out[name].value[start + rows] = np.where(none, np.nan, jet.value)
            out[name].slope[start + rows] = np.where(none[:, None], np.nan, jet.slope)
    return out
