"""Derivatives of the exact bounce by the release and the can, to round-off.

Period and turn are integrals along a path of complex nutations, differentiated under the sum
(`reference.integrable.complex_path`). A turning point moves by -(dg/dp)/(dg/dphi). Peaks are those
of a function of the nutation, of which at the peak only the explicit derivative is left (envelope
theorem).
"""

from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray

from reference.integrable.complex_path import cycle_tangents, skipped_tangents
from reference.integrable.cycle import released_potential
from reference.integrable.deep_tangents import deep_state, is_deep
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
    ClockNodes,
    TangentState,
    TangentWell,
    force_ratio,
    seeds,
    tangent_state,
    tangent_well,
)
from reference.integrable.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.numerics.jets import Jet, jet_where
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats

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

    def at(fraction: Floats) -> tuple[TangentState, ClockNodes]:
        phi, rise, gap = clock.nutation(fraction)
        below = np.where(rise < gap, points.fall - rise, gap - points.climb)
        nodes = ClockNodes(phi=phi, rise=rise, gap=gap, below=below)
        return tangent_state(well, phi, below), nodes

    grid = np.broadcast_to(np.linspace(0.0, 1.0, SAMPLES)[:, None], (SAMPLES, columns.size))
    size = np.abs(quantity(at(grid)[0]).value)
    best = size.argmax(axis=0)
    padded = np.pad(size, ((1, 1), (0, 0)), constant_values=-1.0)
    apart = np.abs(np.arange(SAMPLES)[:, None] - best) > 1
    others = np.where(apart & (size > padded[:-2]) & (size > padded[2:]), size, 0.0)
    low, high = grid[np.maximum(best - 1, 0), 0], grid[np.minimum(best + 1, SAMPLES - 1), 0]
    for _ in range(ROUNDS):
        finer = low + (high - low) * np.linspace(0.0, 1.0, NARROWER)[:, None]
        finer[-1] = high
        seen = quantity(at(finer)[0])
        # towards the peak the magnitude rises
        rising = np.sign(seen.value) * seen.slope[..., AT] > 0
        last = np.where(rising.any(axis=0), NARROWER - 1 - rising[::-1].argmax(axis=0), -1)
        low = finer[np.maximum(last, 0), columns]
        high = finer[np.minimum(last + 1, NARROWER - 1), columns]
    state, nodes = at(np.stack([low, high]))
    g, seen = state.g, quantity(state)
    edge = (low == 0.0) | (high == 1.0)
    # of a peak between the edges no more digits are known than of its place
    deep = np.broadcast_to(edge & is_deep(clock.low, clock.high), nodes.phi.shape)
    if deep.any():
        own = deep_state(well, state, nodes, clock.high)
        g, seen = jet_where(deep, own.g, g), jet_where(deep, quantity(own), seen)
    pick = np.abs(seen.value).argmax(axis=0)
    value, slope = seen.value[pick, columns], seen.slope[pick, columns]
    force = g.slope[pick, columns]
    moved = -force[:, :AT] / np.where(force[:, AT:] == 0, np.nan, force[:, AT:])
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
