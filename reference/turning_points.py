"""Between which nutations the can rocks, found for many releases at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.outcome import Outcome
from reference.rolling import ROUND_OFFS
from reference.roots import bracketed_roots
from reference.states import Floats
from reference.track import PROMINENCE
from reference.well import Well, level, nutation_force, select_well, well_at

OUTCOMES = tuple(Outcome)
# Up to here phi is searched for its maximum: beyond it the side of the can meets the plane.
UPRIGHT = np.pi / 2
GRID = 32
COARSE = 8
# Distances below this share of phi have lost so many digits that they are solved for by themselves.
NEARBY = 0.1
# Below this the square of b underflows, and the far rim is nearer than any length in physics.
SMALLEST = 1e-150


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
        Index into `OUTCOMES`; FINISHED where the can bounces.
    """

    well: Well
    low: Floats
    high: Floats
    swing: Floats
    climb: Floats
    code: NDArray[np.int8]


def turning_points(well: Well) -> TurningPoints:
    """Extrema of phi around the release.

    Parameters
    ----------
    well : Well
        Referred to the release, with `excess` its kinetic energy of nutation.

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
    climbing = np.flatnonzero(~found)
    if climbing.size:
        climb[climbing], found[climbing] = _upper(select_well(well, climbing))
    high = release + climb
    top = level(well, high[None], -climb[None])
    based = well_at(
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
    low, bottom = _lower(based)
    swing = _swing(based, low)
    code = np.full(release.shape, OUTCOMES.index(Outcome.FINISHED), dtype=np.int8)
    code[~bottom] = OUTCOMES.index(Outcome.FELL_FLAT)
    code[found & bottom & (swing <= PROMINENCE * high)] = OUTCOMES.index(Outcome.STEADY)
    code[~found] = OUTCOMES.index(Outcome.OVERTURNED)
    # moving down with too much energy to turn at the top: flat comes first if nothing turns
    code[still] = OUTCOMES.index(Outcome.STEADY)
    return TurningPoints(well=based, low=low, high=high, swing=swing, climb=climb, code=code)


def fall_below(well: Well, points: TurningPoints) -> Floats:
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
    some = select_well(well, near)

    def g(below: Floats) -> Floats:
        slope = level(some, (some.reference - below)[None], below[None]).slope[0]
        return np.asarray(np.where(below == 0, some.excess, slope * below))

    fall[near] = bracketed_roots(g, np.zeros(near.size), 2 * NEARBY * some.reference)
    return fall


def _swing(well: Well, low: Floats) -> Floats:
    """Distance from the reference down to the root of g, to relative round-off."""
    swing = well.reference - low
    near = np.flatnonzero(swing < NEARBY * well.reference)
    some = select_well(well, near)

    def slope(below: Floats) -> Floats:
        return np.asarray(level(some, (some.reference - below)[None], below[None]).slope[0])

    swing[near] = bracketed_roots(slope, 0.5 * swing[near], 2 * swing[near])
    return swing


def _upper(well: Well) -> tuple[Floats, NDArray[np.bool_]]:
    """Distance of the first root of g above the release, and whether there is one below pi/2."""
    release = well.reference
    rise = (UPRIGHT - release) * (np.arange(1, GRID + 1)[:, None] / GRID) ** 2
    phi = release + rise
    state = level(well, phi, -rise)
    negative = state.slope > 0  # g = slope (r - phi), and r - phi < 0
    # beside balance two roots may lie between two points, also between the release and the first
    force = nutation_force(well.can, state.b, state.spin, phi)
    at_release = nutation_force(well.can, well.b, well.spin, release)
    before = np.vstack((at_release, force[:-1]))
    dips = (before < 0) & (force > 0) & ~negative
    dips[1:] &= ~negative[:-1]
    found = np.asarray(negative.any(axis=0))
    first = np.where(found, negative.argmax(axis=0), GRID - 1)
    columns = np.arange(release.size)
    left = np.where(first > 0, rise[first - 1, columns], 0.0)
    right = rise[first, columns]
    candidate = dips.any(axis=0)
    if candidate.any():
        at = dips.argmax(axis=0)
        start = np.where(at > 0, rise[at - 1, columns], 0.0)
        bottom = bracketed_roots(lambda x: _force_above(well, x), start, rise[at, columns])
        deep = candidate & (_g_above(well, bottom) < 0) & (~found | (at <= first))
        right = np.where(deep, bottom, right)
        left = np.where(deep, start, left)
        found |= deep
    root = bracketed_roots(lambda x: _g_above(well, x), left, right)
    return np.asarray(np.where(found, root, UPRIGHT - release)), found


def _lower(well: Well) -> tuple[Floats, NDArray[np.bool_]]:
    """First root of g below the reference, and whether there is one."""
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
    steps = np.linspace(0, 1, COARSE)[:, None]
    phi = high * (floor / high) ** steps[1:]
    negative = level(well, phi, high - phi).slope <= 0
    first = negative.argmax(axis=0)
    columns = np.arange(high.size)
    right = np.where(first > 0, phi[first - 1, columns], high)
    left = phi[first, columns]
    # the slope g/(r - phi) tends to -g'(r) at the reference: step off it by what a double resolves
    right = np.minimum(right, high * (1 - 4 * np.finfo(float).eps))
    root = bracketed_roots(
        lambda x: np.sin(x) ** 2 * _slope(well, x), np.minimum(left, right), right
    )
    return np.where(turns, root, floor), turns


def _slope(well: Well, phi: Floats) -> Floats:
    return np.asarray(level(well, phi[None], (well.reference - phi)[None]).slope[0])


def _g_above(well: Well, distance: Floats) -> Floats:
    """G where the release moves, g over the distance where it rests."""
    apart = np.where(distance == 0, np.spacing(well.reference), distance)
    slope = level(well, (well.reference + apart)[None], -apart[None]).slope[0]
    moving = np.where(distance == 0, well.excess, -slope * distance)
    return np.asarray(np.where(well.excess == 0, -slope, moving))


def _force_above(well: Well, distance: Floats) -> Floats:
    phi = well.reference + distance
    state = level(well, phi[None], -distance[None])
    return nutation_force(well.can, state.b[0], state.spin[0], phi)
