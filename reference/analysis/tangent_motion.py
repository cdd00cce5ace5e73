"""Derivatives of the first bounce of any can, by the variational equations along its motion.

A disturbance d of the state by a number p obeys d' = J d + df/dp
(`reference.analysis.variational`), and starts as the derivative of the release by p. At an extremum
of phi, whose instant moves, the state changes by d - f d_w2/f_w2: there w2 = -phi' is zero. Peaks
are maxima along the motion, of which only the derivative at a fixed place is left (envelope
theorem). Those by the constants of the can and of its effects:
`reference.analysis.stepped_constants`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from reference.analysis.bounces import humps
from reference.analysis.linearisation import (
    NUMBER,
    Quantity,
    UndecidedError,
    by_state,
    core_of,
)
from reference.analysis.release_tangents import OF_RELEASE, numbers, released_tangents
from reference.analysis.saltation import RESTS, PieceEnd, delay, jumps, touching
from reference.analysis.stepped_constants import by_varied, equations_of_contact, stepped
from reference.analysis.unilateral_tangents import UnilateralEquations, with_flights
from reference.analysis.variational import (
    Stretch,
    stretches,
    without_tangent,
)
from reference.equations.contact_laws import Mode
from reference.equations.frames import length
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import LEAN, PSI, SLIP, TIME, TURN, W1, W2, Angles
from reference.integrable.derivatives import PULLED, QUANTITIES
from reference.nonsmooth.segments import AHEAD, Segment, SegmentsPath
from reference.numerics.jets import Jet
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solution import Solution
from reference.solver import solve

# Places of a piece among which a peak is looked for, and halvings that find it to round-off.
PLACES = np.linspace(0.0, 1.0, 9)
HALVINGS = 60
NO_BOUNCE = "the motion has no bounce"
# A peak that was measured by sampling is this near, as a share of it.
SAME_PEAK = 1e-6
ANOTHER = "the peak could not be told from others"
KINK = "the peak is where the law of the contact changes, and differs on its two sides"


# Where phi turns by itself its rate is a round-off.
TURNS = 1e-6
# Accelerations of phi no larger than this are the round-off of none.
STAYS = 1e-13


def _precession(_: GeneralEquations, y: Floats, __: Mode) -> Floats:
    return np.asarray(y[W1] / Angles.of(y[LEAN]).S)


def _friction(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    if mode.flies:
        return np.zeros_like(y[0])
    force = equations.contact(y, mode).force
    return np.asarray(length(force[0], force[1]) / force[2])


Place = tuple[int, float]
"""Number of a piece, and where in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentMotion:
    """A motion of any length, with its derivatives along its pieces.

    Attributes
    ----------
    equations : GeneralEquations
    by : tuple of str
    varied : dict of int to GeneralEquations
        With one number of `by` stepped each, by its place there: of the can and of effects.
    pieces : tuple of Segment
    stretches : dict of int to Stretch
        By the number of the piece.
    """

    equations: GeneralEquations
    by: tuple[str, ...]
    varied: Mapping[int, GeneralEquations]
    pieces: tuple[Segment, ...]
    stretches: Mapping[int, Stretch]

    def state(self, number: int, c: float) -> Floats:
        """Return the state at a place, (rows, 1), with the direction of a slip that begins."""
        piece = self.pieces[number]
        y = piece.at(np.array([c]))
        begins = piece.mode.slips and not piece.mode.flies and not self.equations.patch
        if begins and not y[SLIP].any():
            y[SLIP] = piece.at(np.array([c + AHEAD]))[SLIP]
        return y

    def rates(self, number: int, c: float) -> Floats:
        """Return the rates of the core at a place, shape (k,)."""
        y, mode = self.state(number, c), self.pieces[number].mode
        return np.asarray(self.equations.rates(y, mode, along=False)[core_of(y), 0])

    def disturbances(self, number: int, c: float, *, turns: bool) -> Floats:
        """Return derivatives of the core; where phi turns those of that instant."""
        if number not in self.stretches:
            raise UndecidedError(KINK)
        d = self.stretches[number].at(c)
        if not turns:
            return d
        if abs(float(self.state(number, c)[W2, 0])) > TURNS:
            # phi turns where the rim lands, and its rate jumps there
            return self.at_switch((number, c))
        f = self.rates(number, c)
        turning = d[NUMBER[W2]]
        # nothing turns a can that falls without turning: its rate of phi stays what it was
        late = turning / f[NUMBER[W2]] if abs(f[NUMBER[W2]]) > STAYS else turning * np.inf
        late[turning == 0.0] = 0.0
        return np.asarray(d - np.outer(f, late))

    def switches(self, number: int) -> bool:
        """Return whether a touch, an impact or a lift is between a piece and the one before."""
        if not 0 < number < len(self.pieces):
            return False
        before, after = self.pieces[number - 1], self.pieces[number]
        jump = (after.start - before.end)[[*TURN, -1]] if before.mode.flies else np.zeros(1)
        return before.mode.flies != after.mode.flies or bool(np.abs(jump).max() > RESTS)

    def at_switch(self, place: Place) -> Floats:
        """Return derivatives of the core at the instant of a touch, an impact or a lift.

        Of the state before it at the end of a piece, and of that after it at the start of one.
        """
        number, c = place
        before = number if c > 0.0 else number - 1
        if before < 0 or not (self.switches(before + 1) or self.pieces[before].mode.flies):
            raise UndecidedError(KINK)
        stretch, cut = self.stretches[before], self.pieces[before].cut
        now, rates = stretch.at(cut), stretch.rates[:, -1]
        end = PieceEnd(self.pieces[before], rates, now, np.zeros(len(self.by)))
        tau = delay(self.equations, end, touching, partial(by_varied, self.varied, len(self.by)))
        if c == 0.0:
            now, rates = self.stretches[number].at(0.0), self.rates(number, 0.0)
        return np.asarray(now + np.outer(rates, tau))

    def value(self, quantity: Quantity, number: int, c: float) -> float:
        """Return a quantity at a place."""
        mode = self.pieces[number].mode
        return float(quantity(self.equations, self.state(number, c), mode)[0])

    def gradient(self, quantity: Quantity, number: int, c: float) -> tuple[float, Floats, Floats]:
        """Return a quantity at a place, and its derivatives by the core and by `by`."""
        y, mode = self.state(number, c), self.pieces[number].mode
        slope = by_state(quantity, self.equations, y, mode)
        explicit = by_varied(self.varied, len(self.by), quantity, y, mode)[:, 0]
        return self.value(quantity, number, c), slope, explicit


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
        path = path_in_pieces(problem, solution)
        reason = without_tangent(problem.effects, path.pieces)
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
    opens = problem.phi_dot < 0
    starts, ends = path.place(t0), path.place(t1)
    try:
        first = motion.disturbances(*starts, turns=not opens)
        last = motion.disturbances(*ends, turns=True)
        for name, row in (("period", TIME), ("angle_of_turn", PSI)):
            value = motion.state(*ends)[row, 0] - motion.state(*starts)[row, 0]
            jets[name] = Jet(np.asarray(value), last[NUMBER[row]] - first[NUMBER[row]])
        lowest = path.place(middle)
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


def model_of(problem: Problem) -> str:
    """Return the model whose path has derivatives along it."""
    laws = problem.effects.compliance, problem.effects.restitution
    return "auto" if any(law is not None for law in laws) else "general"


def path_in_pieces(problem: Problem, solution: Solution) -> SegmentsPath:
    """Return the path of a solution by the model of `model_of`, in pieces with derivatives.

    Raises
    ------
    UndecidedError
        If the motion has no derivatives that are known.
    """
    path = solution.path
    equations = equations_of_contact(problem.parameters, problem.effects)
    if isinstance(equations, UnilateralEquations):
        path = with_flights(solution, equations)
    if not isinstance(path, SegmentsPath):
        raise UndecidedError(f"{NO_BOUNCE}: {solution.outcome.value.rstrip('.')}")
    return path


def tangent_motion(problem: Problem, path: SegmentsPath) -> TangentMotion:
    """Return a motion with its derivatives along all of it.

    Parameters
    ----------
    problem : Problem
    path : SegmentsPath
        Of `path_in_pieces`.

    Raises
    ------
    UndecidedError
        If the release or an impact has no derivative.
    """
    by = numbers(problem)
    equations = equations_of_contact(problem.parameters, problem.effects)
    varied = {
        place: stepped(problem, name) for place, name in enumerate(by) if name not in OF_RELEASE
    }
    number = {id(piece): place for place, piece in enumerate(path.pieces)}
    start = released_tangents(problem, path.pieces[0], by)
    flow = stretches(equations, path.pieces, start, partial(by_varied, varied, len(by)))
    return TangentMotion(
        equations=equations,
        by=by,
        varied=varied,
        pieces=path.pieces,
        stretches={number[id(stretch.piece)]: stretch for stretch in flow},
    )


def _limit(motion: TangentMotion, starts: Place, ends: Place) -> Jet | None:
    """Return the coefficient of friction as the peak of its ratio, if a point of contact slips.

    It is the static one where the rim sticks before.
    """
    pieces = motion.pieces[starts[0] : ends[0] + 1]
    if motion.equations.patch or not any(_slides(piece) for piece in pieces):
        return None
    name, value = "slip.mu", motion.equations.mu
    if jumps(motion.equations.effects) and not all(piece.mode.slips for piece in pieces):
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
        places += [(number, float(left + (right - left) * share)) for share in PLACES]
    values = [abs(motion.value(quantity, *place)) for place in places]
    if not np.isfinite(values).all():
        raise UndecidedError(PULLED)
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
