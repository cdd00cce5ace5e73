"""Kernels of the hybrid integrator: collocation steps, one after another, through extrema.

Imported where a caller asks for compiled code.
"""

from math import inf, log

import numpy as np

from reference.equations.compiled_equations import CONTACT_ROWS, Laws
from reference.equations.kernels import false_and_zero
from reference.equations.state_vector import ROWS, U1, U2, Index
from reference.nonsmooth.collocation_kernels import (
    collocate,
    evaluate,
    extrapolated,
    tail_and_present,
)
from reference.nonsmooth.event_kernels import located, state_at
from reference.nonsmooth.events import EventKind
from reference.nonsmooth.hybrid_integrator import LONGEST, NOISE, RESOLVED, SHARE, SHORTEST
from reference.nonsmooth.radau_iia import STAGES
from reference.nonsmooth.stopping import STOPPED
from reference.numerics.compiled import inner, jit
from reference.problem.states import Floats

# Halvings of a step that does not converge before Newton's method for all has to take it, and by
# how much more the steps after it may be longer, each than the one before.
_MOST_SHORTER, _RELAXED = 4, 1.2
# The same where few rounds were enough, and after how many refusals no more.
_EASY, _FREED, _TRIES = 7, 2.0, 3
# How much faster a slip has to be, for the length of its step, than where it was stiff to be tried
# without Newton's method.
_FASTER = 2.0
# Where a step leaves nothing but round-off its harmonics fall faster than they have to, and as a
# power of its length: the next one is as much longer as lets them just fall, but for a margin.
_USED, _MORE = 0.9, 8.0
_FALL = -log(RESOLVED)
MAXIMUM, MINIMUM = (tuple(EventKind).index(kind) for kind in (EventKind.MAXIMUM, EventKind.MINIMUM))
_LONGEST, _NOISE, _RESOLVED, _SHARE, _SHORTEST = LONGEST, NOISE, RESOLVED, SHARE, SHORTEST
_STOPPED = STOPPED

GOES_ON, LOOK, STUCK, STOPS = range(4)
"""Why a march returns: nothing, an event in its last step, no fixed point, the end of a slip."""


@inner
def _left_of_slip(E: Floats, laws: Laws, y: Floats, work: tuple[Floats, Floats]) -> float:
    """Return sigma until a slip stops at its rate, as `stopping.left_of_slip`."""
    column, f = np.empty((ROWS, 1)), np.empty((ROWS, 1))
    for i in range(ROWS):
        column[i, 0] = y[i]
    along, _ = false_and_zero(E)
    evaluate(E, laws, column, f, work, along)
    speed = np.hypot(y[U1], y[U2])
    slowing = -(y[U1] * f[U1, 0] + y[U2] * f[U2, 0]) / speed
    return float(speed / slowing) if slowing > 0 else inf


@jit
def march(
    E: Floats,
    laws: Laws,
    start: Floats,
    core: Index,
    lengths: tuple[float, float, float],
    last: Floats,
    limits: tuple[float, bool],
    most: tuple[int, int],
    choices: tuple[bool, int, bool],
) -> tuple[int, float, int, Floats, Floats, Floats, Floats, Floats]:
    """Take steps until something has to be looked at.

    Parameters
    ----------
    E : ndarray
    laws : tuple
    start : ndarray, shape (13,)
    core : ndarray of int
    lengths : tuple of float
        Of the first step to try; of the last one that was taken, and where it was cut.
    last : ndarray, shape (13, STAGES + 1)
        Coefficients of the last step, or of a guess.
    limits : tuple
        The horizon, and whether the plane may pull.
    most : tuple of int
        Steps to take, and rounds to spend.
    choices : tuple
        Whether the place of the contact and the works are wanted; how many extrema of phi are
        reported before one has to be looked at; and whether a slip begins from rest.

    Returns
    -------
    reason : int
    length : float
        Of the step to try next.
    rounds : int
    starts : ndarray, shape (count + 1, 13)
        The last of them where the march ends.
    series : ndarray, shape (count, 13, STAGES + 1)
    taken : ndarray, shape (count,)
        Lengths of the steps.
    extrema : ndarray, shape (m, 15)
        In which step, which kind of event, and the state there; without those of the last step
        where that has to be looked at.
    events : ndarray, shape (e, 2)
        Of the last step.
    """
    capacity, budget = most
    along, passes, begins = choices
    alone = E[16] == 0 and E[17] == 0
    stiff, slow, refused = begins, 0.0, 0
    extrema, seen = np.empty((2 * capacity, 2 + ROWS)), 0
    column = np.empty((ROWS, 1))
    length, last_length, cut = lengths
    starts, taken = np.empty((capacity + 1, ROWS)), np.empty(capacity)
    series = np.empty((capacity, ROWS, STAGES + 1))
    D, here = np.empty((10, 6)), np.empty(CONTACT_ROWS)
    change, trial = np.empty((ROWS, STAGES)), np.empty((ROWS, STAGES + 1))
    y, f = np.empty((ROWS, STAGES)), np.empty((ROWS, STAGES))
    arrays = change, trial, y, f, D, here
    for i in range(ROWS):
        starts[0, i] = start[i]
    rounds, count, reason = 0, 0, GOES_ON
    # a variable: for a constant the extrapolation would be compiled once more
    all_of_them = last.shape[1] - 1
    harmonics, polynomial, at, scale = all_of_them, last, cut, last_length
    shortened, longest = 0, inf
    left, events = inf, np.empty((0, 2))
    if laws[0] and not begins:
        left = _left_of_slip(E, laws, start, (D, here))
    while count < capacity and rounds < budget and reason == GOES_ON:
        length = min(length, _SHARE * left)
        if not length > _SHORTEST:
            reason = STUCK
            break
        extrapolated(polynomial, harmonics, at, length / scale, change)
        spent = collocate(E, laws, starts[count], core, length, arrays, (along, stiff))
        rounds += abs(spent)
        if spent < 0 and laws[0] and alone and not stiff:
            stiff, slow = True, np.hypot(starts[count, U1], starts[count, U2]) / length
            continue
        if spent < 0 and alone and shortened < _MOST_SHORTER:
            shortened, refused = shortened + 1, refused + 1
            length /= 2
            longest = length
            continue
        if spent < 0:
            length *= 2**shortened
            reason = STUCK
            break
        longest *= _FREED if spent <= _EASY and refused < _TRIES else _RELAXED
        shortened = 0
        tail, present = tail_and_present(E, starts[count], trial)
        if tail > _RESOLVED:
            # what was too long is the guess of what is shorter
            polynomial, harmonics, at, scale = trial.copy(), all_of_them, 0.0, length
            length *= max(0.2, 0.8 * (_RESOLVED / tail) ** (1 / STAGES))
            continue
        for i in range(ROWS):
            for k in range(STAGES + 1):
                series[count, i, k] = trial[i, k]
        taken[count] = length
        polynomial, harmonics, at, scale = series[count], present, 1.0, length
        for i in range(ROWS):
            total = 0.0
            for k in range(1, STAGES + 1, 2):
                total += trial[i, k]
            starts[count + 1, i] = starts[count, i] + 2 * total
        events = located(E, laws, starts[count], trial, limits)
        for number in range(events.shape[0]):
            kind = events[number, 0]
            if seen + number >= passes or kind not in (MINIMUM, MAXIMUM):
                reason = LOOK
        if events.shape[0] > extrema.shape[0] - seen:
            reason = LOOK
        if reason == GOES_ON:
            for number in range(events.shape[0]):
                state_at(starts[count], trial, events[number, 1], column)
                extrema[seen, 0], extrema[seen, 1] = count, events[number, 0]
                for i in range(ROWS):
                    extrema[seen, 2 + i] = column[i, 0]
                seen += 1
        count += 1
        grown = 0.9 * length * (_RESOLVED / max(tail, _NOISE)) ** (1 / STAGES)
        # a tail of round-off says that more is to be had: how much, the harmonics before it say
        more = _USED * np.exp(_FALL * (1 / (present + 1) - 1 / (STAGES - 1)))
        more = min(_MORE, max(1.0, more)) * length
        length = min(more if tail < _NOISE else min(grown, _LONGEST), longest)
        if laws[0]:
            left = _left_of_slip(E, laws, starts[count], (D, here))
            speed = np.hypot(starts[count, U1], starts[count, U2])
            # friction turns with a slip the less the faster it is
            stiff = stiff and speed < _FASTER * slow * length
            if reason == GOES_ON and (left <= _STOPPED or (speed <= _STOPPED and left < inf)):
                reason = STOPS
    done = starts[: count + 1], series[:count], taken[:count]
    return reason, length, rounds, done[0], done[1], done[2], extrema[:seen], events
