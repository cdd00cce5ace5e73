"""A motion with its derivatives along all of it, by the variational equations.

A disturbance d of the state by a number p obeys d' = J d + df/dp
(`reference.analysis.variational`), and starts as the derivative of the release by p
(`reference.analysis.release_tangents`). Where phi has an extremum, whose instant moves, the state
changes by d - f d_w2/f_w2: there w2 = -phi' is zero. Derivatives by the constants of the can and of
its effects: `reference.analysis.stepped_constants`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from reference.analysis.linearisation import NUMBER, Quantity, UndecidedError, by_state, core_of
from reference.analysis.release_tangents import OF_RELEASE, numbers, released_tangents
from reference.analysis.saltation import RESTS, PieceEnd, delay, lets_go, slack, touching
from reference.analysis.stepped_constants import by_varied, equations_of_contact, stepped
from reference.analysis.unilateral_tangents import UnilateralEquations, with_flights
from reference.analysis.variational import Stretch, stretches
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import TURN, W2
from reference.nonsmooth.patch_onset import hardly_moves, towards
from reference.nonsmooth.segments import AHEAD, Segment, SegmentsPath
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solution import Solution

NO_BOUNCE = "the motion has no bounce"
KINK = "the peak is where the law of the contact changes, and differs on its two sides"
# Where phi turns by itself its rate is a round-off.
TURNS = 1e-6
# Accelerations of phi no larger than this are the round-off of none.
STAYS = 1e-13

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
        slips = piece.mode.slips and not piece.mode.flies
        if slips and hardly_moves(self.equations, np.column_stack([piece.start, y])).all():
            y = towards(self.equations, y, piece.at(np.array([c + AHEAD])))
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
        turning, change = d[NUMBER[W2]], float(f[NUMBER[W2]])
        # of a can that falls without turning the rate of phi stays what it was
        late = np.where(turning == 0.0, 0.0, turning / change if abs(change) > STAYS else np.nan)
        return np.asarray(d - np.outer(f, late))

    def switches(self, number: int) -> bool:
        """Return whether a law, or the state, jumps between a piece and the one before.

        At a touch, an impact or a lift, and where static friction lets go.
        """
        if not 0 < number < len(self.pieces):
            return False
        before, after = self.pieces[number - 1], self.pieces[number]
        if lets_go(self.equations, before.mode, after.mode):
            return True
        jump = (after.start - before.end)[[*TURN, -1]] if before.mode.flies else np.zeros(1)
        return before.mode.flies != after.mode.flies or bool(np.abs(jump).max() > RESTS)

    def at_switch(self, place: Place) -> Floats:
        """Return derivatives of the core at the instant of such a switch.

        Of the state before it at the end of a piece, and of that after it at the start of one.
        """
        number, c = place
        before = number if c > 0.0 else number - 1
        if before < 0 or not (self.switches(before + 1) or self.pieces[before].mode.flies):
            raise UndecidedError(KINK)
        stretch, cut = self.stretches[before], self.pieces[before].cut
        now, rates = stretch.at(cut), stretch.rates[:, -1]
        end = PieceEnd(self.pieces[before], rates, now, np.zeros(len(self.by)))
        after = self.pieces[min(before + 1, len(self.pieces) - 1)]
        margin = slack if lets_go(self.equations, end.piece.mode, after.mode) else touching
        tau = delay(self.equations, end, margin, partial(by_varied, self.varied, len(self.by)))
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
