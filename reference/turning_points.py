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
    code : ndarray of int
        Index into `OUTCOMES`; FINISHED where the can bounces.
    """

    well: Well
    low: Floats
    high: Floats
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
    high, found = release.copy(), falling | still
    climbing = np.flatnonzero(~found)
    if climbing.size:
        high[climbing], found[climbing] = _upper(select_well(well, climbing))
    top = level(well, high[None], (release - high)[None])
    # at the release itself its own values are exact
    b = np.where(high == release, well.b, top.b[0])
    spin = np.where(high == release, well.spin, top.spin[0])
    none = np.zeros_like(high)
    based = well_at(well.can, well.series, phi=high, b=b, spin=spin, excess=none, B=well.B)
    low, bottom = _lower(based)
    code = np.full(release.shape, OUTCOMES.index(Outcome.FINISHED), dtype=np.int8)
    code[~bottom] = OUTCOMES.index(Outcome.FELL_FLAT)
    code[found & bottom & (high - low <= PROMINENCE * high)] = OUTCOMES.index(Outcome.STEADY)
    code[~found] = OUTCOMES.index(Outcome.OVERTURNED)
    # moving down with too much energy to turn at the top: flat comes first if nothing turns
    code[still] = OUTCOMES.index(Outcome.STEADY)
    return TurningPoints(well=based, low=low, high=high, code=code)


def _upper(well: Well) -> tuple[Floats, NDArray[np.bool_]]:
    """First root of g above the release, and whether there is one below pi/2."""
    release = well.reference
    steps = (np.arange(1, GRID + 1)[:, None] / GRID) ** 2
    phi = release + (UPRIGHT - release) * steps
    state = level(well, phi, release - phi)
    negative = state.slope > 0  # g = slope (r - phi), and r - phi < 0
    force = nutation_force(well.can, state.b, state.spin, phi)
    dips = np.zeros_like(negative)
    dips[1:] = (force[:-1] < 0) & (force[1:] > 0) & ~negative[:-1] & ~negative[1:]
    found = np.asarray(negative.any(axis=0))
    first = np.where(found, negative.argmax(axis=0), GRID - 1)
    columns = np.arange(release.size)
    left = np.where(first > 0, phi[first - 1, columns], release)
    right = phi[first, columns]
    candidate = dips.any(axis=0)
    if candidate.any():
        at = dips.argmax(axis=0)
        bottom = bracketed_roots(
            lambda x: _force_at(well, x), phi[np.maximum(at - 1, 0), columns], phi[at, columns]
        )
        deep = candidate & (_slope(well, bottom) > 0) & (~found | (at <= first))
        right = np.where(deep, bottom, right)
        left = np.where(deep, phi[np.maximum(at - 1, 0), columns], left)
        found |= deep
    root = bracketed_roots(lambda x: _g_like(well, x), left, right)
    return np.asarray(np.where(found, root, UPRIGHT)), found


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


def _g_like(well: Well, phi: Floats) -> Floats:
    """G where the release moves, g over the distance where it rests."""
    below = well.reference - phi
    below = np.where(below == 0, -np.spacing(well.reference), below)
    slope = level(well, phi[None], below[None]).slope[0]
    return np.asarray(np.where(well.excess == 0, -slope, slope * below))


def _force_at(well: Well, phi: Floats) -> Floats:
    state = level(well, phi[None], (well.reference - phi)[None])
    return nutation_force(well.can, state.b[0], state.spin[0], phi)
