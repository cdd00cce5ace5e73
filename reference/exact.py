"""The exact bounce: period, turn, rotation and extrema by quadrature, to round-off.

Precession and spin are known functions of nutation (`reference.frobenius`), energy gives phi'
(`reference.well`), and the elliptic clock (`reference.elliptic`) makes every integrand an analytic
periodic function, so that the midpoint rule is exact to round-off with about 4 log(8 phi_max/phi_min) nodes:
32 for the paper's release. How hard the bounce is changes nothing else.

This replaces eq01:hyper_geom, which is not evaluated; the two are compared in the tests.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.elliptic import Clock
from reference.frobenius import Can, Series, frobenius_series, terms_needed
from reference.outcome import Outcome
from reference.states import Floats
from reference.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.well import Well, level, select_well, well_at

# Nodes that make exp(-2 pi strip nodes/K) smaller than round-off: 38 is -log of 3e-17.
DECADES = 38.0
MOST_NODES = 4096
# The rule's error is the square of the highest harmonic it resolves.
TAIL = 3e-9
# Releases treated together, and numbers in flight in one array: what stays in a processor's cache.
CHUNK = 2048
CACHED = 16384


@dataclass(frozen=True, slots=True, kw_only=True)
class Cycles:
    """The periodic motions of n cans; every field has shape (n,).

    Where the can does not bounce every number is 0 and `code` says why.

    Attributes
    ----------
    code : ndarray of int8
        Index into `reference.turning_points.OUTCOMES`; FINISHED where the can bounces.
    period : ndarray
        From maximum to maximum of phi, in sqrt(R/g).
    angle_of_turn, rotation_turn : ndarray
        Signed change of psi and of theta over a period, in rad.
    phi_min, phi_max : ndarray
    peak_psi_dot : ndarray
        Precession rate of largest magnitude, with its sign, in sqrt(g/R).
    """

    code: NDArray[np.int8]
    period: Floats
    angle_of_turn: Floats
    rotation_turn: Floats
    phi_min: Floats
    phi_max: Floats
    peak_psi_dot: Floats

    @property
    def bounced(self) -> NDArray[np.bool_]:
        """Where there is a bounce, shape (n,)."""
        return self.code == OUTCOMES.index(Outcome.FINISHED)

    def outcome(self, index: int) -> Outcome:
        """Outcome of one release."""
        return OUTCOMES[int(self.code[index])]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rates:
    """Rates in the clock's time u, shape (m, n): of t, of psi and of psi + theta."""

    time: Floats
    precession: Floats
    total: Floats
    psi_dot: Floats


def exact_bounces(
    *,
    a: ArrayLike,
    c: ArrayLike,
    h: ArrayLike,
    phi: ArrayLike,
    phi_dot: ArrayLike = 0.0,
    psi_dot: ArrayLike = 0.0,
    theta_dot: ArrayLike = 0.0,
) -> Cycles:
    """Solve many releases of many cans exactly.

    Parameters
    ----------
    a, c, h : array_like
        The cans (`reference.parameters`); shape () for one can, which is fastest, or broadcastable.
    phi, phi_dot, psi_dot, theta_dot : array_like
        The releases, dimensionless; broadcast together to shape (n,).

    Returns
    -------
    Cycles
        Arrays of shape (n,), in the order of the raveled releases.

    Raises
    ------
    ValueError
        If a value is not finite, a can impossible, or a nutation outside (0, pi/2).
    """
    cans = [np.asarray(value, dtype=float) for value in (a, c, h)]
    parts = [np.asarray(value, dtype=float) for value in (phi, phi_dot, psi_dot, theta_dot)]
    _refuse(cans, parts)
    many = any(value.size > 1 for value in cans)
    arrays = np.broadcast_arrays(*cans, *parts) if many else np.broadcast_arrays(*parts)
    flat = [np.ascontiguousarray(value, dtype=float).ravel() for value in arrays]
    n = flat[0].size
    fields = [np.zeros(n) for _ in range(6)]
    code = np.zeros(n, dtype=np.int8)
    order = np.argsort(flat[-4], kind="stable")
    for start in range(0, n, CHUNK):
        pick = order[start : start + CHUNK]
        released = [value[pick] for value in flat[-4:]]
        owner = [value[pick] for value in flat[:3]] if many else [v.reshape(1) for v in cans]
        result = _chunk(Can(a=owner[0], c=owner[1], h=owner[2]), *released)
        code[pick] = result[0]
        for field, values in zip(fields, result[1:], strict=True):
            field[pick] = values
    return Cycles(
        code=code,
        period=fields[0],
        angle_of_turn=fields[1],
        rotation_turn=fields[2],
        phi_min=fields[3],
        phi_max=fields[4],
        peak_psi_dot=fields[5],
    )


def _refuse(cans: list[Floats], parts: list[Floats]) -> None:
    if not all(np.isfinite(value).all() for value in (*cans, *parts)):
        raise ValueError("cans and releases must be finite")
    if not all((value > 0).all() for value in cans) or (cans[1] > 2 * cans[0]).any():
        raise ValueError("`a`, `c`, `h` must be positive and `c` at most 2 `a`")
    if not ((parts[0] > 0) & (parts[0] < np.pi / 2)).all():
        raise ValueError("`phi` must lie inside (0, pi/2)")


def release_well(
    can: Can, series: Series, phi: Floats, phi_dot: Floats, psi_dot: Floats, theta_dot: Floats
) -> Well:
    """Return the wells of releases, referred to the release, shape (n,)."""
    excess = (can.a_p + 1) * phi_dot**2 / 2
    return well_at(can, series, phi, np.sin(phi) ** 2 * psi_dot, psi_dot + theta_dot, excess)


def _chunk(
    can: Can, phi: Floats, phi_dot: Floats, psi_dot: Floats, theta_dot: Floats
) -> tuple[NDArray[np.int8], Floats, Floats, Floats, Floats, Floats, Floats]:
    """Solve a few releases that need about as many terms."""
    # phi may rise above its release: only where it rests and falls is the release the highest
    highest = np.pi / 2 if phi_dot.any() else float(phi.max())
    series = frobenius_series(can, terms_needed(highest))
    points = turning_points(release_well(can, series, phi, phi_dot, psi_dot, theta_dot))
    if float(points.high.max()) > highest:
        series = frobenius_series(can, terms_needed(np.pi / 2))
        points = turning_points(release_well(can, series, phi, phi_dot, psi_dot, theta_dot))
    out = [np.zeros(phi.size) for _ in range(6)]
    bounced = np.flatnonzero(points.code == OUTCOMES.index(Outcome.FINISHED))
    if bounced.size:
        points_there = _select(points, bounced)
        clock = clock_of(points_there)
        nodes = nodes_needed(clock)
        for count in np.unique(nodes).tolist():
            group = np.flatnonzero(nodes == count)
            for part in np.array_split(group, 1 + group.size * count // CACHED):
                values = _quadrature(_select(points_there, part), count)
                for field, value in zip(out, values, strict=True):
                    field[bounced[part]] = value
    return points.code, out[0], out[1], out[2], out[3], out[4], out[5]


def _select(points: TurningPoints, index: NDArray[np.intp]) -> TurningPoints:
    """Pick some of the releases."""
    return TurningPoints(
        well=select_well(points.well, index),
        low=points.low[index],
        high=points.high[index],
        code=points.code[index],
    )


def clock_of(points: TurningPoints) -> Clock:
    """Return the clock between the turning points, aware of the balanced can beyond them.

    The root of g beyond phi_max is estimated from slope and curvature there; the estimate sets
    how fast the rule converges, not what it converges to.
    """
    well, high = points.well, points.high
    aside = np.minimum(1e-3 * high, 0.5 * (high - points.low))
    below = np.stack([aside, 2 * aside])
    near, far = level(well, high - below, below).slope
    # g/(r - phi) is linear beside the reference and vanishes again at the root beyond it
    drop = far - near
    with np.errstate(divide="ignore", over="ignore"):
        reach = np.where(drop > 0, (2 * near - far) * aside / np.where(drop > 0, drop, 1.0), np.inf)
    beyond = high + np.clip(reach, 1e-14 * high, np.pi - high)
    return Clock(low=points.low, high=high, beyond=beyond)


def nodes_needed(clock: Clock) -> NDArray[np.int64]:
    """Nodes of the midpoint rule, rounded up so that few different numbers occur, shape (n,)."""
    raw = DECADES * clock.quarter / (2 * np.pi * clock.strip) + 4
    return np.asarray(8 * np.ceil(raw / 8), dtype=np.int64)


def rates(points: TurningPoints, clock: Clock, fraction: Floats) -> Rates:
    """Rates of the motion in the clock's time.

    Parameters
    ----------
    points : TurningPoints
    clock : Clock
    fraction : ndarray, shape (m, 1)
        Where, as a fraction of K, inside (0, 1).

    Returns
    -------
    Rates
    """
    phi, rise, gap = clock.nutation(fraction)
    state = level(points.well, phi, gap)
    can = points.well.can
    S = state.sine
    # g S^2 over the quartic of the clock: smooth and positive
    smooth = (
        S**2 * state.slope / (rise * (phi + points.low) * ((clock.beyond - clock.high) + gap))
    )
    # at an exact double root round-off may leave a zero
    smooth = np.maximum(smooth, np.finfo(float).tiny)
    time = np.sqrt((can.a_p + 1) / 2) * clock.gauge * S / np.sqrt(smooth)
    psi_dot = state.b / S**2
    return Rates(time=time, precession=psi_dot * time, total=state.spin * time, psi_dot=psi_dot)


def _quadrature(points: TurningPoints, nodes: int) -> tuple[Floats, ...]:
    """Period, turn, rotation, phi_min, phi_max, peak rate, with as many nodes as it takes."""
    clock = clock_of(points)
    fraction = (np.arange(nodes)[:, None] + 0.5) / nodes
    found = rates(points, clock, fraction)
    scale = 2 * clock.quarter / nodes
    period, turn, total = (
        scale * part.sum(axis=0) for part in (found.time, found.precession, found.total)
    )
    peak = _peak(points, found)
    values = [period, turn, total - turn, points.low, points.high, peak]
    rough = np.flatnonzero(_unresolved(found)) if nodes < MOST_NODES else np.empty(0, dtype=int)
    if rough.size:
        for field, better in zip(values, _quadrature(_select(points, rough), 2 * nodes), strict=True):
            field[rough] = better
    return tuple(np.array(value) for value in values)


def _unresolved(found: Rates) -> NDArray[np.bool_]:
    """Where the two highest harmonics of an integrand have not yet fallen."""
    nodes = found.time.shape[0]
    angle = np.pi * (np.arange(nodes) + 0.5) / nodes
    waves = np.stack([np.cos((nodes - 1) * angle), np.cos((nodes - 2) * angle)])
    rough = np.zeros(found.time.shape[1], dtype=bool)
    for part in (found.time, found.precession, found.total):
        rough |= np.abs(waves @ part).max(axis=0) > TAIL * np.abs(part).sum(axis=0)
    return rough


def _peak(points: TurningPoints, found: Rates) -> Floats:
    """Precession rate of largest magnitude on the way."""
    low, high = points.low, points.high
    bottom = level(points.well, low[None], (high - low)[None])
    ends = np.stack([bottom.b[0] / bottom.sine[0] ** 2, points.well.b / np.sin(high) ** 2])
    rate = np.concatenate([ends[:1], found.psi_dot, ends[1:]])
    best = np.abs(rate).argmax(axis=0)
    columns = np.arange(low.size)
    peak = rate[best, columns]
    inside = (best > 0) & (best < rate.shape[0] - 1)
    if inside.any():
        left, mid, right = (np.abs(rate[np.clip(best + d, 0, rate.shape[0] - 1), columns]) for d in (-1, 0, 1))
        bend = left - 2 * mid + right
        rise = np.where(bend < 0, (left - right) ** 2 / np.where(bend < 0, -8 * bend, 1.0), 0.0)
        peak = np.where(inside, np.sign(peak) * (mid + rise), peak)
    return peak
