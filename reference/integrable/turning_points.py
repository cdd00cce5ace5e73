"""Between which nutations the can rocks, found for many releases at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.equations.nonholonomic import ROUND_OFFS
from reference.integrable.brackets import Brackets, first_brackets, stays_positive
from reference.integrable.effective_potential import (
    EffectivePotential,
    effective_potential,
    energy_noise,
    evaluate_potential,
    nutation_force,
    select_potential,
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
    well, released : EffectivePotential
        Referred to phi_max, where there is one, and to the release.
    low, high : ndarray
        phi_min and phi_max.
    swing : ndarray
        phi_max - phi_min, to relative round-off.
    climb, fall : ndarray
        From the release up to phi_max and down to phi_min, to relative round-off.
    code : ndarray of int
        Index into `OUTCOMES`; FINISHED where the can bounces, UNRESOLVED where round-off decides
        which root is the first.
    """

    well: EffectivePotential
    released: EffectivePotential
    low: Floats
    high: Floats
    swing: Floats
    climb: Floats
    fall: Floats
    code: NDArray[np.int8]


def turning_points(well: EffectivePotential, *, certain: bool) -> TurningPoints:
    """Extrema of phi around the release: the first roots of g above and below it.

    Parameters
    ----------
    well : EffectivePotential
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
    low, fall, bottom = release.copy(), np.zeros_like(release), np.ones(release.shape, dtype=bool)
    turning = np.flatnonzero(found & ~still & ~rising & decided)
    if turning.size:
        low[turning], fall[turning], bottom[turning], decided[turning] = _lower(
            select_potential(well, turning), certain=certain
        )
    swing = climb + fall
    code = np.full(release.shape, OUTCOMES.index(Outcome.FINISHED), dtype=np.int8)
    code[~bottom] = OUTCOMES.index(Outcome.FELL_FLAT)
    code[found & bottom & (swing <= PROMINENCE * high)] = OUTCOMES.index(Outcome.STEADY)
    code[~found] = OUTCOMES.index(Outcome.OVERTURNED)
    code[~decided] = OUTCOMES.index(Outcome.UNRESOLVED)
    code[still] = OUTCOMES.index(Outcome.STEADY)
    return TurningPoints(
        well=based,
        released=well,
        low=low,
        high=high,
        swing=swing,
        climb=climb,
        fall=fall,
        code=code,
    )


def _fall(well: EffectivePotential, low: Floats) -> Floats:
    """Distance from the reference down to the root of g, to relative round-off."""
    release = well.reference
    fall = release - low
    near = np.flatnonzero(fall < NEARBY * release)
    some = select_potential(well, near)
    # no farther than the rounding of phi_min: the next root may be near
    margin = MARGIN * np.spacing(release[near])
    fall[near] = bracketed_roots(
        lambda below: _left(some, (some.reference - below)[None], below[None], 1.0)[0],
        np.maximum(fall[near] - margin, 0.0),
        fall[near] + margin,
    )
    return fall


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
        height = release[doubted]
        bracket = _first_of(select_potential(well, doubted), np.full(height.shape, UPRIGHT))
        found[doubted], decided[doubted] = bracket.found, bracket.decided
        left[doubted], right[doubted] = bracket.near - height, bracket.far - height
    root = bracketed_roots(lambda x: _above(well, x[None])[0], left, right)
    return np.asarray(np.where(found, root, UPRIGHT - release)), found, decided


def _left(well: EffectivePotential, phi: Floats, below: Floats, way: float) -> Floats:
    """G where the release moves, g over the distance where it rests, shape (m, n)."""
    at = _beside(well, below, way)
    return _at(well, at, way, evaluate_potential(well, phi, at).slope)


def _beside(well: EffectivePotential, below: Floats, way: float | Floats) -> Floats:
    """Distances from the release, none zero where it rests: there g/(r - phi) has its limit."""
    limit = (below == 0) & (well.excess == 0)
    return np.where(limit, way * BESIDE * well.reference, below)


def _at(well: EffectivePotential, at: Floats, way: float | Floats, slope: Floats) -> Floats:
    moves = np.where(at == 0, well.excess, slope * at)
    return np.asarray(np.where(well.excess == 0, way * slope, moves))


def _above(well: EffectivePotential, rise: Floats) -> Floats:
    """Likewise at distances above the release, shape (m, n)."""
    return _left(well, well.reference + rise, -rise, -1.0)


def _below(well: EffectivePotential, phi: Floats) -> Floats:
    """Likewise at nutations that do not exceed the release, shape (m, n)."""
    return _left(well, phi, well.reference - phi, 1.0)


def _lower(
    well: EffectivePotential, *, certain: bool
) -> tuple[Floats, Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """First root of g below the release, its distance, if there is one, and if that is sure."""
    release, B = well.reference, np.abs(well.B)
    turns = B > SMALLEST
    floor = release / 2
    safe = np.where(turns, B, 1.0)
    # g is negative at the latest where the precession alone would take all the energy
    with np.errstate(over="ignore"):
        floor = np.minimum(floor, safe)
    for _ in range(60):
        positive = turns & (_below(well, floor[None])[0] > 0)
        if not positive.any():
            break
        floor = np.where(positive, floor / 8, floor)
    # without B the energy stays finite down to the flat state, and may yet be too little
    floor = np.where(turns, floor, FLAT * release)
    steps = np.linspace(0, 1, COARSE)[:, None]
    phi = release * (floor / release) ** steps[1:]
    first = (_below(well, phi) <= 0).argmax(axis=0)
    columns = np.arange(release.size)
    right = np.where(first > 0, phi[first - 1, columns], release)
    left = phi[first, columns]
    decided = np.ones(release.shape, dtype=bool)
    # a can that rolls with a finite spin and no B: rare
    regular = ~turns & ((well.spin != 0) | (well.b != 0))
    doubted = np.flatnonzero(regular | certain)
    if doubted.size:
        bracket = _first_of(select_potential(well, doubted), floor[doubted])
        turns[doubted], decided[doubted] = bracket.found, bracket.decided
        left[doubted], right[doubted] = bracket.far, bracket.near
    root = bracketed_roots(
        lambda x: np.sin(x) ** 2 * _below(well, x[None])[0], np.minimum(left, right), right
    )
    low = np.where(turns, root, floor)
    return low, _fall(well, low), turns, decided


def _first_of(well: EffectivePotential, stop: Floats) -> Brackets:
    """Bracket the first root of g between the release and another nutation."""
    way = np.sign(stop - well.reference)

    def left(which: NDArray[np.intp], phi: Floats) -> tuple[Floats, Floats]:
        part = select_potential(well, which)
        at = _beside(part, part.reference - phi, -way[which])
        state = evaluate_potential(part, phi, at)
        noise = energy_noise(part, phi, at, state)
        share = np.where(part.excess == 0, np.abs(at), 1.0)
        return _at(part, at, -way[which], state.slope), noise / share

    return first_brackets(left, well.reference, stop)
