"""The bounces of a record: extrema of phi, and the turns of psi and theta between them."""

from itertools import pairwise

import numpy as np

from harness.core.bounce import PROMINENCE, Bounce
from harness.core.trajectory import Floats
from harness.metrics.motion import Motion
from models.can import Can

_AT_REST = 1e-6
"""Share of the largest |phi'| below which the first or last sample counts as an extremum itself."""

_COARSE = 0.1
"""rad of the rim between two samples from which a cubic in time no longer follows phi."""


def bounces(motion: Motion, can: Can) -> tuple[Bounce, ...]:
    """Return the bounces of a motion that are complete: with a maximum of phi on either side.

    Parameters
    ----------
    motion : Motion
    can : Can
        Its moments set how the rim moves between two samples of a bounce.
    """
    phi = motion.angles.phi
    minima = prominent_minima(phi, PROMINENCE * float(phi.max()))
    edges = [0, *minima, len(phi) - 1]
    peaks = [left + int(np.argmax(phi[left : right + 1])) for left, right in pairwise(edges)]
    complete = []
    for number, minimum in enumerate(minima):
        before, after = peaks[number], peaks[number + 1]
        if _is_maximum(motion, before) and _is_maximum(motion, after):
            complete.append(_bounce(motion, can, before, minimum, after))
    return tuple(complete)


def prominent_minima(values: Floats, prominence: float) -> list[int]:
    """Return where values have minima below which they do not fall before they rise enough.

    The same as `scipy.signal.find_peaks` of the negative values, whose package takes longer to
    import than a short run to simulate.

    Parameters
    ----------
    values : ndarray, shape (n,)
    prominence : float
        From a minimum the values rise by at least so much on either side, before they fall below it
        or end.

    Returns
    -------
    list of int
        Of a flat bottom its middle.
    """
    changes = np.flatnonzero(np.diff(values) != 0.0)
    falls = values[changes + 1] < values[changes]
    bottoms = np.flatnonzero(falls[:-1] & ~falls[1:])
    firsts, lasts = changes[bottoms] + 1, changes[bottoms + 1]
    if not bottoms.size:
        return []
    # of alternating bottoms and peaks, the first and the last peak may be an end
    depths, peaks = values[firsts], np.maximum.reduceat(values, np.concatenate(([0], lasts)))
    rises = np.minimum(_rises(depths, peaks[:-1]), _rises(depths[::-1], peaks[:0:-1])[::-1])
    found = np.flatnonzero(rises - depths >= prominence)
    return [int(first + last) // 2 for first, last in zip(firsts[found], lasts[found], strict=True)]


def _rises(depths: Floats, peaks: Floats) -> Floats:
    """Return how high values were before each bottom, since they were below it last, shape (n,).

    Parameters
    ----------
    depths : ndarray, shape (n,)
        Values at the bottoms.
    peaks : ndarray, shape (n,)
        Largest value between each bottom and the one before.
    """
    highest = np.array(peaks)
    above: list[int] = []
    for index, depth in enumerate(depths):
        while above and depths[above[-1]] >= depth:
            highest[index] = max(highest[index], highest[above.pop()])
        above.append(index)
    return highest


def _is_maximum(motion: Motion, index: int) -> bool:
    """Return whether phi has a maximum at a sample, and does not merely begin or end there."""
    rate, last = motion.angles.phi_dot, len(motion.time) - 1
    rest = _AT_REST * float(np.abs(rate).max())
    if index == 0:
        return bool(rate[0] <= rest)
    return index < last or bool(abs(rate[last]) <= rest)


def _bounce(motion: Motion, can: Can, before: int, minimum: int, after: int) -> Bounce:
    """Return the bounce between two maxima of phi."""
    angles, inside = motion.angles, slice(before, after + 1)
    start, psi_start, theta_start = _at_maximum(motion, before)
    end, psi_end, theta_end = _at_maximum(motion, after)
    time, phi_min = _closest_to_flat(motion, can, minimum)
    rate = angles.psi_dot[inside]
    ratio = motion.friction_ratio[inside]
    known = np.isfinite(ratio)
    return Bounce(
        start=start,
        time=time,
        end=end,
        phi_min=phi_min,
        angle_of_turn=psi_end - psi_start,
        rotation_turn=theta_end - theta_start,
        peak_psi_dot=float(rate[np.argmax(np.abs(rate))]),
        peak_friction_ratio=float(ratio[known].max()) if known.any() else float("nan"),
        resolved=not bool(angles.unresolved[before + 1 : after + 1].any()),
    )


def _at_maximum(motion: Motion, index: int) -> tuple[float, float, float]:
    """Return time, psi and theta where phi' passes through zero next to a sample."""
    angles, time = motion.angles, motion.time
    for left in (index - 1, index):
        turn = _turning(motion, left)
        if turn is not None:
            gap = float(time[left + 1] - time[left])
            return (
                float(time[left]) + turn * gap,
                _cubic(angles.psi, angles.psi_dot, left, turn, gap),
                _cubic(angles.theta, angles.theta_dot, left, turn, gap),
            )
    return float(time[index]), float(angles.psi[index]), float(angles.theta[index])


def _turning(motion: Motion, left: int) -> float | None:
    """Return the share of an interval at which phi', taken as linear, changes sign, if ever."""
    rate = motion.angles.phi_dot
    if left < 0 or left + 1 >= len(rate) or not rate[left] * rate[left + 1] < 0.0:
        return None
    return float(rate[left] / (rate[left] - rate[left + 1]))


def _cubic(values: Floats, rates: Floats, left: int, share: float, gap: float) -> float:
    """Return Hermite's cubic between two samples at a share of the interval."""
    s, t = share, 1.0 - share
    return float(
        values[left] * (1.0 + 2.0 * s) * t * t
        + values[left + 1] * (1.0 + 2.0 * t) * s * s
        + gap * s * t * (rates[left] * t - rates[left + 1] * s)
    )


def _closest_to_flat(motion: Motion, can: Can, index: int) -> tuple[float, float]:
    """Return time and phi of a minimum of phi near a sample.

    Where a few samples carry the whole bounce: phi exp(i chi), chi = psi sqrt(a_p/(a_p + 1)), moves
    on a straight line at constant speed, and the minimum is the point of the chord nearest to the
    origin. Where the samples lie densely: the zero of phi'.
    """
    angles, time = motion.angles, motion.time
    best = (float(angles.phi[index]), float(time[index]))
    for left in (index - 1, index):
        share = _turning(motion, left)
        if share is None:
            continue
        gap = float(time[left + 1] - time[left])
        phi = _cubic(angles.phi, angles.phi_dot, left, share, gap)
        turn = can.slowness * (angles.psi[left + 1] - angles.psi[left])
        if _COARSE < abs(turn) < np.pi:
            here, there = complex(angles.phi[left]), angles.phi[left + 1] * np.exp(1j * turn)
            step = there - here
            share = float(np.clip(-(here * step.conjugate()).real / abs(step) ** 2, 0.0, 1.0))
            phi = float(abs(here + share * step))
        best = (phi, float(time[left]) + share * gap)
    return best[1], best[0]
