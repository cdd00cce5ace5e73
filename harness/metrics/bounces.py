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

_MOST_BETWEEN = 2.0
"""Largest rate between samples over that of a sample: beyond, too few samples tell where it is."""

_ALIKE = 3.0
"""Factor within which a smooth peak bends alike from sample to sample."""

_NEAREST = (0, -1, 1, -2)
"""Where the intervals about a sample begin, in samples from it, those beside it first: rates that
an engine records a step from its angles change sign up to two intervals off."""


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
    return Bounce(
        start=start,
        time=time,
        end=end,
        phi_min=phi_min,
        angle_of_turn=psi_end - psi_start,
        rotation_turn=theta_end - theta_start,
        peak_psi_dot=_peak_rate(motion.time, angles.psi_dot, inside),
        peak_friction_ratio=_peak_ratio(motion.time, motion.friction_ratio, inside),
        resolved=not bool(angles.unresolved[before + 1 : after + 1].any()),
    )


def _peak_rate(time: Floats, rates: Floats, inside: slice) -> float:
    """Return the rate of largest magnitude, between samples too.

    Near the flat state phi^2 psi' is constant and phi^2 a parabola in time, so 1/psi' is one: three
    samples tell it, also where they are as far apart as the peak is wide.
    """
    index = inside.start + int(np.argmax(np.abs(rates[inside])))
    largest = float(rates[index])
    about = slice(max(index - 1, 0), index + 2)
    beside = rates[about]
    if len(beside) < _PARABOLA or not np.all(beside * largest > 0.0):
        return largest
    least = -_vertex(time[about], -1.0 / np.abs(beside), 1)
    if least * _MOST_BETWEEN * abs(largest) < 1.0:
        return largest
    return float(np.copysign(1.0 / least, largest))


def _peak_ratio(time: Floats, ratios: Floats, inside: slice) -> float:
    """Return the largest ratio, between samples too; NaN if none is known.

    Where the rim begins to slip, or a contact is made or lost, the ratio has a kink, and its
    largest sample stands. Round a smooth peak it bends alike at three samples.
    """
    own = ratios[inside]
    if not np.isfinite(own).any():
        return float("nan")
    index = inside.start + int(np.nanargmax(own))
    largest = float(ratios[index])
    about = slice(index - 2, index + 3)
    if about.start < 0 or not np.isfinite(ratios[about]).all() or about.stop > len(ratios):
        return largest
    slopes = np.diff(ratios[about]) / np.diff(time[about])
    bends = np.diff(slopes) / (time[about][2:] - time[about][:-2])
    smooth = bends.max() < 0.0 and bends.min() >= _ALIKE * bends.max()
    return _vertex(time, ratios, index) if smooth else largest


_PARABOLA = 3
"""Samples that a parabola goes through."""


def _vertex(time: Floats, values: Floats, index: int) -> float:
    """Return the maximum of the parabola through the largest value and its two neighbours.

    It exceeds the value by at most an eighth of the two falls, if samples are evenly spaced.
    Without two neighbours that are known and not larger the value itself is returned.
    """
    value = float(values[index])
    if not 0 < index < len(values) - 1:
        return value
    before, after = float(time[index] - time[index - 1]), float(time[index + 1] - time[index])
    fall, rise = value - float(values[index - 1]), float(values[index + 1]) - value
    if not (fall >= 0.0 >= rise and fall > rise and before > 0.0 < after):
        return value
    left, right = fall / before, rise / after  # slopes in the middle of both intervals
    slope = (left * after + right * before) / (before + after)  # at the sample
    return value + slope**2 * (before + after) / (4.0 * (left - right))


def _at_maximum(motion: Motion, index: int) -> tuple[float, float, float]:
    """Return time, psi and theta where phi' falls through zero near a sample."""
    angles, time = motion.angles, motion.time
    place = _turning(motion, index, rising=False)
    if place is None:
        return float(time[index]), float(angles.psi[index]), float(angles.theta[index])
    left, share = place
    gap = float(time[left + 1] - time[left])
    return (
        float(time[left]) + share * gap,
        hermite(angles.psi, angles.psi_dot, left, share, gap),
        hermite(angles.theta, angles.theta_dot, left, share, gap),
    )


def _turning(motion: Motion, index: int, *, rising: bool) -> tuple[int, float] | None:
    """Return interval and share of it at which phi', taken as linear, changes sign near a sample.

    Parameters
    ----------
    motion : Motion
    index : int
    rising : bool
        Whether phi' becomes positive, at a minimum, or negative, at a maximum.

    Returns
    -------
    tuple of int and float, or None
        None if phi' is zero at the sample itself, or changes sign in no interval near it.
    """
    rate = motion.angles.phi_dot
    if rate[index] == 0.0:
        return None
    for offset in _NEAREST:
        left = index + offset
        if left < 0 or left + 1 >= len(rate):
            continue
        first, last = (rate[left], rate[left + 1]) if rising else (-rate[left], -rate[left + 1])
        if first < 0.0 < last:
            return left, float(first / (first - last))
    return None


def hermite(values: Floats, rates: Floats, left: int, share: float, gap: float) -> float:
    """Return Hermite's cubic between two samples at a share of the interval.

    Parameters
    ----------
    values, rates : ndarray, shape (n,)
    left : int
        The first of the two samples.
    share : float
        Of the interval, from the first; beyond 1 the cubic goes on.
    gap : float
        Length of the interval, in the unit of time of the rates.
    """
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
    place = _turning(motion, index, rising=True)
    if place is None:
        return float(time[index]), float(angles.phi[index])
    left, share = place
    gap = float(time[left + 1] - time[left])
    phi = hermite(angles.phi, angles.phi_dot, left, share, gap)
    turn = can.slowness * (angles.psi[left + 1] - angles.psi[left])
    if _COARSE < abs(turn) < np.pi:
        here, there = complex(angles.phi[left]), angles.phi[left + 1] * np.exp(1j * turn)
        step = there - here
        share = float(np.clip(-(here * step.conjugate()).real / abs(step) ** 2, 0.0, 1.0))
        phi = float(abs(here + share * step))
    return float(time[left]) + share * gap, phi
