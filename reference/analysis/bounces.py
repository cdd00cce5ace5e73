"""Measurement of the bounces of a motion."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from reference.equations.reaction_force import friction_ratio, ratio_of
from reference.problem.can import Parameters
from reference.problem.states import Floats, States
from reference.smooth.dense_output import ElementsPath
from reference.smooth.extrema import Extrema, Path
from reference.smooth.time_reversal import MirroredPath
from reference.solution import Bounce

Quantity: TypeAlias = Callable[[States], Floats]
# A peak is narrowed down by sampling between the neighbours of the best sample, again and again,
# until they are as high as the best but for this share of it; each round gains 8^2.
LEVEL = 1e-8
MOST_ROUNDS = 16
SAMPLES = 17
# Share of the highest sample from which the top of a lower one may be the highest.
WORTH = 0.7
# Samples beside an extremum exceed it by round-off alone.
SHOULDER = 1e-12


def measure_bounces(
    path: Path,
    track: Extrema,
    parameters: Parameters,
    *,
    known: Floats | None = None,
    sliding: bool = False,
    symmetric: bool = True,
    compiled: bool = False,
) -> tuple[Bounce, ...]:
    """Return a `Bounce` for each minimum of phi that has a maximum on either side.

    Parameters
    ----------
    path : Path
    track : Extrema
    parameters : Parameters
    known : ndarray, shape (2, bounces), or None
        The peaks, where an integrator has measured them (`reference.smooth.extrema.Run`).
    sliding : bool
        Whether the plane is without friction, so that there is no force to ask for.
    symmetric : bool
        Whether each extremum of phi mirrors the motion, so that a peak that is no sample is there.
    compiled : bool
        Whether to measure the friction of a can that rolls by compiled code.
    """
    if np.count_nonzero(track.maximum) < 2:  # noqa: PLR2004 - a bounce has one on either side
        return ()
    tops = np.flatnonzero(track.maximum)

    def ratio(states: States) -> Floats:
        if sliding:
            return np.zeros_like(states.phi)
        if compiled and states.force is None:
            from reference.smooth import kernels

            p, at = parameters, states
            can = p.a, p.c, p.h, p.k, p.c_p
            return ratio_of(
                kernels.forces(can, (at.phi, at.phi_dot), (at.psi, at.psi_dot), at.spin)
            )
        return friction_ratio(states, parameters)

    peaks: Sequence[Floats] | Floats
    if known is not None:
        peaks = known
    elif isinstance(path, MirroredPath):
        # a bounce is a half and its mirror image, all of them the same
        times, states = path.half.nodes()
        peaks = [
            np.full(tops.size - 1, _peak_of_half(path.half, times, quantity(states), quantity))
            for quantity in (_precession, ratio)
        ]
    else:
        times, states = path.nodes()
        edges = track.times[tops]
        slices = [slice(*np.searchsorted(times, pair)) for pair in pairwise(edges)]
        peaks = [
            _peaks(path, track, (times, quantity(states)), slices, quantity, symmetric=symmetric)
            for quantity in (_precession, ratio)
        ]
    bounces = []
    for number, (left, right) in enumerate(pairwise(tops.tolist())):
        bounces.append(
            Bounce(
                time=float(track.times[left + 1]),
                phi_min=float(track.extrema.phi[left + 1]),
                angle_of_turn=float(track.extrema.psi[right] - track.extrema.psi[left]),
                rotation_turn=float(track.extrema.theta[right] - track.extrema.theta[left]),
                peak_psi_dot=float(peaks[0][number]),
                peak_friction_ratio=float(peaks[1][number]),
            )
        )
    return tuple(bounces)


def _precession(states: States) -> Floats:
    return states.psi_dot


def _peak_of_half(half: ElementsPath, times: Floats, values: Floats, quantity: Quantity) -> float:
    """Return the value of largest magnitude between two extrema of phi, with its sign."""
    first, last = float(values[0]), float(values[-1])
    peak = first if abs(first) > abs(last) else last
    best = int(np.abs(values).argmax())
    # a sample no higher than the extremum beside it is only its shoulder
    if not np.isfinite(peak) or not abs(values[best]) > abs(peak) * (1 + SHOULDER):
        return peak
    peak = float(values[best])
    if not np.isfinite(peak):
        return peak
    left, right = times[[best - 1]], times[[best + 1]]
    return float(_refined(half, left, right, quantity, np.array([peak]))[0])


def _peaks(
    path: Path,
    track: Extrema,
    sampled: tuple[Floats, Floats],
    slices: list[slice],
    quantity: Quantity,
    *,
    symmetric: bool,
) -> Floats:
    """Return the value of largest magnitude in each bounce, with its sign."""
    times, values = sampled
    at_extrema = quantity(track.extrema)
    tops = np.flatnonzero(track.maximum)
    peak = np.empty(len(slices))
    owner: list[int] = []
    centres: list[int] = []
    for i, part in enumerate(slices):
        own = at_extrema[tops[i] : tops[i + 1] + 1]
        peak[i] = own[np.abs(own).argmax()]
        inside = np.abs(values[part])
        if not inside.size or not np.isfinite(peak[i]):
            continue
        if symmetric:
            # a sample no higher than the extremum beside it is only its shoulder
            highest = inside.max() > np.abs(peak[i]) * (1 + SHOULDER)
            tops_inside = [int(inside.argmax())] if highest else []
        else:
            tops_inside = humps(inside)
        owner += [i] * len(tops_inside)
        centres += [part.start + place for place in tops_inside]
    at, of = np.array(centres, dtype=np.intp), np.array(owner, dtype=np.intp)
    finite = np.isfinite(values[at])
    for i, value in zip(of[~finite].tolist(), values[at[~finite]].tolist(), strict=True):
        peak[i] = value  # where the plane would have to pull
    at, of = at[finite], of[finite]
    if at.size:
        left, right = times[np.maximum(at - 1, 0)], times[np.minimum(at + 1, times.size - 1)]
        # no further than the bounce: beyond its maxima is a peak of its neighbour
        edges = track.times[tops]
        left, right = np.maximum(left, edges[of]), np.minimum(right, edges[of + 1])
        refined = _refined(path, left, right, quantity, values[at])
        for i, value in zip(of.tolist(), refined.tolist(), strict=True):
            if abs(value) > abs(peak[i]):
                peak[i] = value
    return peak


def humps(magnitudes: Floats) -> list[int]:
    """Return the samples beside which the largest magnitude may be.

    Either side of the minimum a motion without mirror symmetry has a hump of its own, and which is
    higher is not for samples to say.
    """
    padded = np.pad(magnitudes, 1, constant_values=-np.inf)
    tops = (padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])
    return np.flatnonzero(tops & (magnitudes >= WORTH * magnitudes.max())).tolist()


def _refined(
    path: Path, left: Floats, right: Floats, quantity: Quantity, sign: Floats
) -> NDArray[np.float64]:
    """Return the peaks between two times each, all at once."""
    steps = np.linspace(0, 1, SAMPLES)
    rows = np.arange(left.size)
    best = np.abs(sign)
    for _ in range(MOST_ROUNDS):
        grid = left[:, None] + (right - left)[:, None] * steps
        values = np.abs(quantity(path.at(grid.ravel()))).reshape(grid.shape)
        peak = values.argmax(axis=1)
        best = np.maximum(best, values[rows, peak])
        left = grid[rows, np.maximum(peak - 1, 0)]
        right = grid[rows, np.minimum(peak + 1, SAMPLES - 1)]
        middle = np.clip(peak, 1, SAMPLES - 2)
        sides = np.minimum(values[rows, middle - 1], values[rows, middle + 1])
        level = sides >= (1 - LEVEL) * values[rows, middle]
        if level.all():
            break
    # the vertex of the parabola through the best sample and its neighbours: fourth order
    below, top, above = (values[rows, middle + step] for step in (-1, 0, 1))
    # a ratio is infinite where the plane would have to pull
    with np.errstate(invalid="ignore"):
        bend = 2 * top - below - above
        rise = np.divide((above - below) ** 2, 8 * bend, out=np.zeros_like(top), where=bend > 0)
    # what is never level jumps, at an impact: no parabola passes there
    inside = level & (top >= below) & (top >= above) & np.isfinite(rise)
    return np.sign(sign) * np.where(inside, np.maximum(best, top + rise), best)
