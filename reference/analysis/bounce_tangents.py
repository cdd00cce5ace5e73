"""Derivatives of the first bounce of any can, by the variational equations along its motion.

Peaks are maxima along the motion, of which only the derivative at a fixed place is left (envelope
theorem); one that a touch, an impact, a lift or a static friction that lets go cuts off moves with
that instant.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np

from reference.analysis.bounces import humps
from reference.analysis.linearisation import NUMBER, Quantity, UndecidedError
from reference.analysis.release_tangents import numbers
from reference.analysis.tangent_motion import (
    KINK,
    NO_BOUNCE,
    Place,
    TangentMotion,
    model_of,
    path_in_pieces,
    tangent_motion,
)
from reference.analysis.variational import without_tangent
from reference.equations.contact_laws import Mode
from reference.equations.frames import length
from reference.equations.newton_euler import GeneralEquations
from reference.equations.reaction_force import VANISHED
from reference.equations.state_vector import LEAN, PSI, TIME, W1, Angles
from reference.integrable.derivatives import PULLED, QUANTITIES
from reference.nonsmooth.segments import Segment, SegmentsPath
from reference.numerics.jets import Jet
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solution import Solution
from reference.solver import solve
from reference.unilateral.path import UnilateralPath

# Places of a piece among which a peak is looked for, and halvings that find it to round-off.
PLACES = 9
HALVINGS = 60
# A peak that was measured by sampling is this near, as a share of it.
SAME_PEAK = 1e-6
ANOTHER = (
    "the peak could not be told from others, or is after an impact that ends the bounce, and from "
    "which no motion is followed"
)
NO_BOUND = (
    "friction that holds the rim does not vanish with the normal force: its ratio has no bound"
)
# Of the time of a bounce that an impact ends: by so much more the motion is followed.
BEYOND = 1e-6
# Of a time.
ROUNDED = 1e-14


def motion_tangents(
    problem: Problem, solution: Solution | None = None
) -> tuple[tuple[str, ...], dict[str, Jet], dict[str, str]]:
    """Return the numbers of the first bounce in jets, of any can.

    Parameters
    ----------
    problem : Problem
        Its horizon does not matter.
    solution : Solution, optional
        Of its first bounce, by the model of `model_of`.

    Returns
    -------
    by : tuple of str
        What derivatives are taken by.
    jets : dict of str to Jet
        By the names `reference.integrable.derivatives.QUANTITIES`, dimensionless.
    why : dict of str to str
        Why there is no derivative, of the quantities that are left out.
    """
    by = numbers(problem)
    if solution is None:
        solution = solve(replace(problem, bounces=1, duration=None), model=model_of(problem))
    if not solution.bounces:
        reason = f"{NO_BOUNCE}: {solution.outcome.value.rstrip('.')}"
        return by, {}, dict.fromkeys(QUANTITIES, reason)
    try:
        path = _whole_path(problem, solution)
        reason = without_tangent(path.pieces)
        motion = None if reason else tangent_motion(problem, path)
    except UndecidedError as error:
        reason, motion = str(error), None
    if motion is None:
        return by, {}, dict.fromkeys(QUANTITIES, reason)
    jets: dict[str, Jet] = {}
    why: dict[str, str] = {}
    t0, t1 = float(solution.maxima[0]), float(solution.maxima[1])
    middle = float(solution.minima[(solution.minima > t0) & (solution.minima < t1)][0])
    # a release that falls opens the bounce itself
    opens = t0 == 0.0 and problem.phi_dot < 0
    starts, ends = _place(motion, path, t0), _place(motion, path, t1)
    try:
        first = motion.disturbances(*starts, turns=not opens)
        last = motion.disturbances(*ends, turns=True)
        for name, row in (("period", TIME), ("angle_of_turn", PSI)):
            value = motion.state(*ends)[row, 0] - motion.state(*starts)[row, 0]
            jets[name] = Jet(np.asarray(value), last[NUMBER[row]] - first[NUMBER[row]])
        lowest = _place(motion, path, middle)
        S = Angles.of(motion.state(*lowest)[LEAN]).S[0]
        slope = S * motion.disturbances(*lowest, turns=True)[NUMBER[LEAN]]
        jets["phi_min"] = Jet(np.asarray(solution.bounces[0].phi_min), slope)
    except UndecidedError as error:
        why |= {name: str(error) for name in QUANTITIES[:3] if name not in jets}
    for name, quantity in (("peak_psi_dot", _precession), ("peak_friction_ratio", _friction)):
        try:
            if name == "peak_friction_ratio" and (at_limit := _limit(motion, starts, ends)):
                jets[name] = at_limit
            else:
                known = getattr(solution.bounces[0], name)
                jets[name] = _peak(motion, quantity, known, starts, ends, opens=opens)
        except UndecidedError as error:
            why[name] = str(error)
    return by, jets, why


def _place(motion: TangentMotion, path: SegmentsPath, time: float) -> Place:
    """Return in which piece a time is, and where; just after a switch that is at this time."""
    number, c = path.place(time)
    for switch in (number, number + 1):
        if motion.switches(switch):
            begins = float(motion.pieces[switch].start[TIME])
            if abs(time - begins) <= ROUNDED * (1.0 + begins):
                return switch, 0.0
    return number, c


def _whole_path(problem: Problem, solution: Solution) -> SegmentsPath:
    """Return the path of a first bounce, with the state after an impact that ends it."""
    if isinstance(solution.path, UnilateralPath) and solution.path.flies_at_end:
        until = replace(problem, bounces=None, duration=solution.t_end * (1 + BEYOND))
        with suppress(UndecidedError):
            return path_in_pieces(problem, solve(until))
    return path_in_pieces(problem, solution)


def _precession(_: GeneralEquations, y: Floats, __: Mode) -> Floats:
    return np.asarray(y[W1] / Angles.of(y[LEAN]).S)


def _friction(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    if mode.flies:
        return np.zeros_like(y[0])
    if mode.slips:
        return np.asarray(length(*equations.sliding_friction(y, mode)))
    force = equations.contact(y, mode).force
    size = length(force[0], force[1])
    # where a soft contact begins there is neither; a friction that does not vanish has no bound
    none = np.where(size == 0, 0.0, np.inf).astype(size.dtype)
    pushed = np.abs(force[2]) > VANISHED * np.abs(size)
    return np.asarray(np.divide(size, force[2], out=none, where=pushed))


def _limit(motion: TangentMotion, starts: Place, ends: Place) -> Jet | None:
    """Return the coefficient of friction as the peak of its ratio, if a point of contact slips.

    It is the static one where the rim sticks before.
    """
    pieces = motion.pieces[starts[0] : ends[0] + 1]
    if motion.equations.patch or not any(_slides(piece) for piece in pieces):
        return None
    name, value = "slip.mu", motion.equations.mu
    own = motion.equations.effects.mu_static is not None
    if own and not all(piece.mode.slips for piece in pieces):
        name, value = "slip.mu_static", motion.equations.mu_static
        if not _begins(pieces):
            return None
    return Jet(np.asarray(value), np.array([float(name == each) for each in motion.by]))


def _begins(pieces: tuple[Segment, ...]) -> bool:
    """Return whether a rim that sticks begins to slip."""
    return any(_slides(piece) and not before.mode.slips for before, piece in pairwise(pieces))


def _slides(piece: Segment) -> bool:
    return piece.mode.slips and not piece.mode.flies


def _peak(
    motion: TangentMotion,
    quantity: Quantity,
    known: float,
    starts: Place,
    ends: Place,
    *,
    opens: bool,
) -> Jet:
    """Return the value of largest magnitude of a quantity within the bounce, in a jet.

    It is `known` from samples, more roughly, which says which of several peaks it is.
    """
    places: list[Place] = []
    for number in range(starts[0], ends[0] + 1):
        left = starts[1] if number == starts[0] else 0.0
        right = ends[1] if number == ends[0] else motion.pieces[number].cut
        places += [(number, float(c)) for c in np.linspace(left, right, PLACES)]
    values = [abs(motion.value(quantity, *place)) for place in places]
    if not np.isfinite(values).all():
        rigid = type(motion.equations) is GeneralEquations
        raise UndecidedError(PULLED if rigid else NO_BOUND)
    edges = {0: (starts, not opens), len(places) - 1: (ends, True)}

    def rising(place: Place) -> bool:
        value, by_row, _ = motion.gradient(quantity, *place)
        return bool(np.sign(value) * (by_row @ motion.rates(*place)) > 0)

    for best in sorted(humps(np.array(values)), key=values.__getitem__, reverse=True):
        # the end of a piece is the start of the next: two places further it is another instant
        low, high = (_beside(motion, places, best, step) for step in (-1, 1))
        if best in edges and rising(low) == rising(high):
            at, turns = edges[best]
        else:
            at, turns = _top(motion, rising, low, high), False
        number, c = at
        cut_off = motion.switches(number if c == 0.0 else number + 1)
        cut_off = cut_off and not turns and c in {0.0, motion.pieces[number].cut}
        _, by_row, by_constants = motion.gradient(quantity, *at)
        value = motion.value(quantity, *at)
        if abs(value - known) <= SAME_PEAK * abs(known):
            break
    else:
        raise UndecidedError(ANOTHER)
    disturbances = motion.at_switch(at) if cut_off else motion.disturbances(*at, turns=turns)
    slope = by_row @ disturbances + by_constants
    return Jet(np.asarray(value), slope)


def _beside(motion: TangentMotion, places: list[Place], best: int, step: int) -> Place:
    """Return the place two further, or the last before a switch of the contact."""
    at = best
    for _ in range(2):
        if not 0 <= at + step < len(places):
            break
        here, there = places[at][0], places[at + step][0]
        if here != there and motion.switches(max(here, there)):
            break
        at += step
    return places[at]


def _top(motion: TangentMotion, rising: Callable[[Place], bool], low: Place, high: Place) -> Place:
    """Return the place between two at which a quantity stops rising, in a piece in between."""
    for number in range(low[0], high[0] + 1):
        left = low if number == low[0] else (number, 0.0)
        right = high if number == high[0] else (number, motion.pieces[number].cut)
        if not rising(left):
            before = motion.pieces[max(number - 1, low[0])].mode
            if motion.pieces[number].mode != before:
                raise UndecidedError(KINK)
            return left
        if rising(right):
            continue
        for _ in range(HALVINGS):
            middle = (number, (left[1] + right[1]) / 2)
            left, right = (middle, right) if rising(middle) else (left, middle)
        return left
    return high
