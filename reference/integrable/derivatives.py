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

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj

from reference.integrable.elliptic import EllipticSubstitution, squared_sn_cn
from reference.integrable.exact_motion import ExactPath
from reference.integrable.quadrature import elliptic_substitution
from reference.integrable.tangents import (
    AT,
    TangentState,
    TangentWell,
    force_ratio,
    seeds,
    tangent_state,
    tangent_well,
)
from reference.integrable.turning_points import TurningPoints
from reference.numerics.jets import Jet, Values
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
# Nodes of Gauss's rule on a path from the release to the maximum of phi.
LEGS = 120
# Places of the clock among which a peak is looked for, and rounds that narrow it to round-off.
SAMPLES = 193
NARROWER, ROUNDS = 9, 18
# Two peaks as alike as this change places by a change of the release that no one resolves.
TIED = 1e-9


QUANTITIES = ("period", "angle_of_turn", "phi_min", "peak_psi_dot", "peak_friction_ratio")
"""What is differentiated: numbers of a `Bounce`, and the time from its maximum to the next."""
PULLED = "the plane would have to pull: the normal force is not positive throughout the bounce"


class UndecidedError(ArithmeticError):
    """A derivative that round-off leaves undecided, or that does not exist; says why."""


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
    points: TurningPoints, clock: EllipticSubstitution, fraction: Floats, height: Floats
) -> PathNodes:
    """Return nodes at u = fraction K + i height, shapes (m, 1) or (m, n).

    By the addition theorem of the elliptic functions, each part to its own round-off.
    """
    k1 = clock.complementary
    sn2, cn2 = squared_sn_cn(fraction, k1)
    s, c, d = np.sqrt(sn2), np.sqrt(cn2), np.sqrt(k1 + (1 - k1) * cn2)
    s1, c1, d1, _ = ellipj(height, k1)
    below = c1**2 + (1 - k1) * sn2 * s1**2
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

    Raises
    ------
    UndecidedError
        If a singularity is so near the real line that no path runs below it.
    """
    clock = elliptic_substitution(points)
    height = HEIGHT * clock.analyticity_strip
    lowest = LOWEST * height
    while True:
        count = int(np.ceil((DECADES * clock.quarter / (2 * np.pi * height)).max())) + 8
        fraction = (np.arange(count)[:, None] + 0.5) / count
        nodes = nodes_on_path(points, clock, fraction, height)
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
        if not wrong.any():
            return parts[0], parts[1], parts[2]
        if (height[wrong] < lowest[wrong]).any():
            raise UndecidedError("a singularity of the motion is too near its real times")
        height = np.where(wrong, height / 2, height)


def skipped_tangents(
    points: TurningPoints, well: TangentWell, problem: Problem, fraction: float
) -> tuple[Jet, Jet, Jet]:
    """Return time, turn and turn of psi + theta from a falling release up to phi_max, in jets.

    They are what the first bounce of a falling release lacks of a whole cycle.

    Parameters
    ----------
    points : TurningPoints
    well : TangentWell
    problem : Problem
    fraction : float
        u/K of the release, inside (0, 1).
    """
    clock = elliptic_substitution(points)
    K = float(clock.quarter[0])
    x, weight = np.polynomial.legendre.leggauss(LEGS)
    share = ((x + 1) / 2)[:, None]
    top = min(HEIGHT * float(clock.analyticity_strip[0]), (1 - fraction) * K / 2)
    along = fraction + (1 - fraction) * share
    nodes = nodes_on_path(points, clock, along, top * np.sin(np.pi / 2 * share))
    step = (1 - fraction) * K + 0.5j * np.pi * top * np.cos(np.pi / 2 * share)
    step = step * weight[:, None] / 2
    out = []
    ends = (1.0, problem.psi_dot, problem.psi_dot + problem.theta_dot)
    for rate, end in zip(rates_on_path(well, clock, nodes), ends, strict=True):
        value = (step * rate.value).sum(axis=0).real
        slope = (step[..., None] * rate.slope).sum(axis=0).real
        slope = slope - end / abs(problem.phi_dot) * well.reference.slope
        out.append(Jet(value, slope))
    return out[0], out[1], out[2]


def turning_tangent(state: TangentState) -> Floats:
    """Return the derivatives of a root of g at which the state is, shape (n, k)."""
    slope = state.g.slope[0]
    return np.asarray(-slope[..., :AT] / slope[..., AT:])


def peak_tangent(
    points: TurningPoints,
    well: TangentWell,
    quantity: Callable[[TangentState], Jet],
) -> Jet:
    """Return the peak of a function of the nutation of one release, in a jet of shape ().

    The peak is the value of largest magnitude, with its sign.

    Parameters
    ----------
    points : TurningPoints
    well : TangentWell
    quantity : callable
        From states to jets, shape (m, n).

    Returns
    -------
    Jet

    Raises
    ------
    UndecidedError
        If two places of the bounce are equally high.
    """
    clock = elliptic_substitution(points)

    def at(fraction: Floats) -> tuple[TangentState, Jet]:
        phi, rise, gap = clock.nutation(fraction[:, None])
        below = np.where(rise < gap, points.fall - rise, gap - points.climb)
        state = tangent_state(well, phi, below)
        return state, quantity(state)

    grid = np.linspace(0.0, 1.0, SAMPLES)
    size = np.abs(at(grid)[1].value[:, 0])
    if not np.isfinite(size).all():
        raise UndecidedError(PULLED)
    best = int(size.argmax())
    around = np.abs(np.arange(SAMPLES) - best) > 1
    inner = (size[1:-1] > size[:-2]) & (size[1:-1] > size[2:])
    others = np.concatenate([[size[0] > size[1]], inner, [size[-1] > size[-2]]]) & around
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, SAMPLES - 1)]
    for _ in range(ROUNDS):
        finer = np.linspace(low, high, NARROWER)
        _, seen = at(finer)
        # towards the peak the magnitude rises
        rising = (np.sign(seen.value) * seen.slope[..., AT])[:, 0] > 0
        last = int(np.flatnonzero(rising)[-1]) if rising.any() else -1
        low, high = finer[max(last, 0)], finer[min(last + 1, NARROWER - 1)]
    _, seen = at(np.array([low, high]))
    pick = int(np.abs(seen.value[:, 0]).argmax())
    value, slope = seen.value[pick, 0], seen.slope[pick, 0]
    if (size[others] >= abs(value) * (1 - TIED)).any():
        raise UndecidedError("the peak is reached in two places of the bounce at once")
    edge = low == 0.0 or high == 1.0
    if not edge:
        return Jet(value, slope[:AT])
    moved = turning_tangent(at(np.array([0.0 if low == 0.0 else 1.0]))[0])[0]
    return Jet(value, slope[:AT] + slope[AT] * moved)


def release_tangents(problem: Problem) -> TangentWell:
    """Return the well of the release of an ideal can in jets, of shape (1,)."""
    names = ("phi", "phi_dot", "psi_dot", "theta_dot")
    numbers = {name: np.array([getattr(problem, name)]) for name in names}
    p = problem.parameters
    return tangent_well(seeds(**numbers, a=np.array([p.a]), c=np.array([p.c]), h=np.array([p.h])))


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
    points, well = path.points, release_tangents(problem)
    out: dict[str, Jet] = {}
    why: dict[str, str] = {}
    known = tuple(np.array([2 * part.slope]) for part in (path.time, path.precession, path.total))
    try:
        period, turn, _ = cycle_tangents(points, well, known)
        if problem.phi_dot < 0:
            early = skipped_tangents(points, well, problem, -path.start)
            period, turn = period - early[0], turn - early[1]
        for name, jet in (("period", period), ("angle_of_turn", turn)):
            out[name] = Jet(jet.value[0], jet.slope[0, :AT])
    except UndecidedError as error:
        why["period"] = why["angle_of_turn"] = str(error)
    bottom = tangent_state(well, points.low[None], points.fall[None])
    out["phi_min"] = Jet(points.low[0], turning_tangent(bottom)[0])
    peaks: dict[str, Callable[[TangentState], Jet]] = {
        "peak_psi_dot": lambda state: state.psi_dot,
        "peak_friction_ratio": lambda state: force_ratio(well, state),
    }
    for name, quantity in peaks.items():
        try:
            out[name] = peak_tangent(points, well, quantity)
        except UndecidedError as error:
            why[name] = str(error)
    return out, why
