"""Between which nutations the can rocks, found for many releases at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.equations.nonholonomic import ROUND_OFFS
from reference.integrable.brackets import first_brackets, stays_positive
from reference.integrable.effective_potential import (
    EffectivePotential,
    effective_potential,
    evaluate_potential,
    nutation_force,
    select_potential,
    slope_noise,
)
from reference.numerics.chebyshev import to_coefficients
from reference.numerics.rootfinding import bracketed_roots
from reference.problem.outcome import Outcome
from reference.problem.states import Floats
from reference.smooth.extrema import PROMINENCE

OUTCOMES = tuple(Outcome)
# Up to here phi is searched for its maximum: beyond it the side of the can meets the plane.
UPRIGHT = np.pi / 2
GRID = 32
COARSE = 8
# Distances below this share of phi have lost so many digits that they are solved for by themselves.
NEARBY = 0.1
# Below this the square of b underflows, and the far rim is nearer than any length in physics.
SMALLEST = 1e-150
# Down to this share of phi_max a can without B is searched for a turning point: the energy there is
# that of the flat state to round-off.
FLAT = 1e-17
# Distances from a root that is known to a few ulp are looked for within so many.
MARGIN = 16.0
# So near the reference, as a share of it, that g/(r - phi) has its limit.
BESIDE = 1e-20


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningPoints:
    """Turning points of n releases, each of shape (n,).

    Attributes
    ----------
    well : Well
        Referred to phi_max where there is one.
    low, high : ndarray
        phi_min and phi_max.
    swing : ndarray
        phi_max - phi_min, to relative round-off.
    climb : ndarray
        From the release up to phi_max, to relative round-off.
    code : ndarray of int
        Index into `OUTCOMES`; FINISHED where the can bounces, UNRESOLVED where round-off decides
        which root is the first.
    """

    well: EffectivePotential
    low: Floats
    high: Floats
    swing: Floats
    climb: Floats
    code: NDArray[np.int8]


def turning_points(well: EffectivePotential, *, certain: bool) -> TurningPoints:
    """Extrema of phi around the release: the first roots of g above and below it.

    Parameters
    ----------
    well : Well
        Referred to the release, with `excess` its kinetic energy of nutation.
    certain : bool
        Whether no root is stepped over. Otherwise a few trial nutations bracket a root, and
        whoever integrates between the roots has to show that g is positive there.

    Returns
    -------
    TurningPoints
    """
    release = well.reference
    force = nutation_force(well.can, well.b, well.spin, release)
    q = well.b / np.sin(release)
    # round-off of the force: of its terms as they are added
    terms = 1 + (q**2 * (1 + well.can.a_p) + np.abs(q * well.spin)) / np.sin(release)
    noise = ROUND_OFFS * np.finfo(float).eps * terms
    at_rest = well.excess == 0
    still = at_rest & (np.abs(force) <= noise)
    falling = at_rest & (force < 0)
    climb, found = np.zeros_like(release), falling | still
    decided = np.ones(release.shape, dtype=bool)
    climbing = np.flatnonzero(~found)
    if climbing.size:
        climb[climbing], found[climbing], decided[climbing] = _upper(
            select_potential(well, climbing), certain=certain
        )
    high = release + climb
    top = evaluate_potential(well, high[None], -climb[None])
    based = effective_potential(
        well.can,
        well.series,
        phi=high,
        # at the release itself its own values are exact
        b=np.where(climb == 0, well.b, top.b[0]),
        spin=np.where(climb == 0, well.spin, top.spin[0]),
        excess=np.zeros_like(high),
        B=well.B,
        short=well.short - climb,
    )
    # a can that rests and rises is at its minimum
    rising = at_rest & ~still & ~falling
    low, swing, bottom = release.copy(), climb.copy(), np.ones(release.shape, dtype=bool)
    turning = np.flatnonzero(found & ~still & ~rising & decided)
    if turning.size:
        low[turning], swing[turning], bottom[turning], decided[turning] = _lower(
            select_potential(based, turning), certain=certain
        )
    code = np.full(release.shape, OUTCOMES.index(Outcome.FINISHED), dtype=np.int8)
    code[~bottom] = OUTCOMES.index(Outcome.FELL_FLAT)
    code[found & bottom & (swing <= PROMINENCE * high)] = OUTCOMES.index(Outcome.STEADY)
    code[~found] = OUTCOMES.index(Outcome.OVERTURNED)
    code[~decided] = OUTCOMES.index(Outcome.UNRESOLVED)
    code[still] = OUTCOMES.index(Outcome.STEADY)
    return TurningPoints(well=based, low=low, high=high, swing=swing, climb=climb, code=code)


def fall_below(well: EffectivePotential, points: TurningPoints) -> Floats:
    """Distance from a moving release down to phi_min, to relative round-off, shape (n,).

    Parameters
    ----------
    well : Well
        Referred to the release, with its kinetic energy of nutation as `excess`.
    points : TurningPoints
    """
    release = well.reference
    fall = release - points.low
    near = np.flatnonzero(fall < NEARBY * release)
    some = select_potential(well, near)

    def g(below: Floats) -> Floats:
        slope = evaluate_potential(some, (some.reference - below)[None], below[None]).slope[0]
        return np.asarray(np.where(below == 0, some.excess, slope * below))

    # no farther than the rounding of phi_min: the next root may be near
    margin = MARGIN * np.spacing(release[near])
    fall[near] = bracketed_roots(g, np.maximum(fall[near] - margin, 0.0), fall[near] + margin)
    return fall


def _swing(well: EffectivePotential, low: Floats) -> Floats:
    """Distance from the reference down to the root of g, to relative round-off."""
    swing = well.reference - low
    near = np.flatnonzero(swing < NEARBY * well.reference)
    some = select_potential(well, near)

    def slope(below: Floats) -> Floats:
        return np.asarray(
            evaluate_potential(some, (some.reference - below)[None], below[None]).slope[0]
        )

    margin = MARGIN * np.spacing(some.reference)
    least = BESIDE * some.reference
    swing[near] = bracketed_roots(
        slope, np.maximum(swing[near] - margin, least), swing[near] + margin
    )
    return swing


def _upper(
    well: EffectivePotential, *, certain: bool
) -> tuple[Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """Distance of the first root of g above the release, if one is below pi/2, and if that is sure.

    Trial nutations are the Chebyshev points in log(phi).
    """
    release = well.reference
    span = np.log(UPRIGHT / release)
    share = (1 - np.cos(np.pi * np.arange(GRID + 1)[:, None] / GRID)) / 2
    rise = release * np.expm1(span * share)
    g = _above(well, rise)
    negative = g <= 0
    found = np.asarray(negative.any(axis=0))
    first = np.where(found, negative.argmax(axis=0), GRID)
    columns = np.arange(release.size)
    left, right = rise[np.maximum(first - 1, 0), columns], rise[first, columns]
    decided = np.ones(release.shape, dtype=bool)
    unsure = np.full(release.shape, certain)
    open_ = np.flatnonzero(~found)
    unsure[open_] |= ~stays_positive(g[:, open_], to_coefficients(GRID + 1) @ g[:, open_])
    doubted = np.flatnonzero(unsure)
    if doubted.size:
        some = select_potential(well, doubted)
        height = some.reference

        def above(which: NDArray[np.intp], phi: Floats) -> tuple[Floats, Floats]:
            part = select_potential(some, which)
            below = part.reference - phi
            state = evaluate_potential(part, phi, below)
            noise = slope_noise(part, phi, below, state)
            moving = part.excess > 0
            value = np.where(moving, state.slope * below, -state.slope)
            return value, np.where(moving, noise * np.abs(below), noise)

        bracket = first_brackets(above, height, np.full(height.shape, UPRIGHT))
        found[doubted], decided[doubted] = bracket.found, bracket.decided
        left[doubted], right[doubted] = bracket.near - height, bracket.far - height
    root = bracketed_roots(lambda x: _above(well, x[None])[0], left, right)
    return np.asarray(np.where(found, root, UPRIGHT - release)), found, decided


def _above(well: EffectivePotential, rise: Floats) -> Floats:
    """G where the release moves, g over the distance where it rests, shape (m, n)."""
    at = np.where(rise == 0, BESIDE * well.reference, rise)
    slope = evaluate_potential(well, well.reference + at, -at).slope
    moving = np.where(rise == 0, well.excess, -slope * at)
    return np.asarray(np.where(well.excess == 0, -slope, moving))


def _lower(
    well: EffectivePotential, *, certain: bool
) -> tuple[Floats, Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """First root of g below the reference, its distance, if there is one, and if that is sure."""
    high, B = well.reference, np.abs(well.B)
    turns = B > SMALLEST
    floor = high / 2
    safe = np.where(turns, B, 1.0)
    # g is negative at the latest where the precession alone would take all the energy
    with np.errstate(over="ignore"):
        floor = np.minimum(floor, safe)
    for _ in range(60):
        positive = turns & (_slope(well, floor) > 0)
        if not positive.any():
            break
        floor = np.where(positive, floor / 8, floor)
    # without B the energy stays finite down to the flat state, and may yet be too little
    floor = np.where(turns, floor, FLAT * high)
    steps = np.linspace(0, 1, COARSE)[:, None]
    phi = high * (floor / high) ** steps[1:]
    negative = evaluate_potential(well, phi, high - phi).slope <= 0
    first = negative.argmax(axis=0)
    columns = np.arange(high.size)
    right = np.where(first > 0, phi[first - 1, columns], high)
    left = phi[first, columns]
    decided = np.ones(high.shape, dtype=bool)
    # a can that rolls with a finite spin and no B: rare
    regular = ~turns & ((well.spin != 0) | (well.b != 0))
    doubted = np.flatnonzero(regular | certain)
    if doubted.size:
        some = select_potential(well, doubted)

        def slope_below(which: NDArray[np.intp], at: Floats) -> tuple[Floats, Floats]:
            part = select_potential(some, which)
            below = part.reference - at
            state = evaluate_potential(part, at, below)
            return state.slope, slope_noise(part, at, below, state)

        bracket = first_brackets(slope_below, some.reference, floor[doubted])
        turns[doubted], decided[doubted] = bracket.found, bracket.decided
        left[doubted], right[doubted] = bracket.far, bracket.near
    # the slope g/(r - phi) tends to -g'(r) at the reference: step off it by what a double resolves
    right = np.minimum(right, high * (1 - 4 * np.finfo(float).eps))
    root = bracketed_roots(
        lambda x: np.sin(x) ** 2 * _slope(well, x), np.minimum(left, right), right
    )
    low = np.where(turns, root, floor)
    return low, _swing(well, low), turns, decided


def _slope(well: EffectivePotential, phi: Floats) -> Floats:
    return np.asarray(evaluate_potential(well, phi[None], (well.reference - phi)[None]).slope[0])
