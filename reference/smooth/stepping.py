"""Integration of the rolling equations by long Picard-Chebyshev steps.

The regularised equations (`reference.equations.regularised`) are integrated by collocation
(`reference.smooth.picard_chebyshev`). A bounce costs about eight steps however hard it is. Since a
step may start from a guess and a rocking can repeats its motion, the steps of each bounce are the
guesses of the next; a step is accepted by its own residual, which does not depend on the guess.
"""

from dataclasses import dataclass, field
from math import atan, inf, sin, sqrt, tan

import numpy as np

from reference.equations.reaction_force import contact_from_centre
from reference.equations.regularised import (
    NUTATION_RATE,
    TANGENT,
    RegularEquations,
    regular_equations,
    sine_of,
)
from reference.equations.regularised import vector_field as rates
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, initial_states
from reference.smooth.dense_output import TIME, ElementsPath, Piece
from reference.smooth.extrema import Extrema, ExtremumRecorder, Run
from reference.smooth.picard_chebyshev import NODES, Element, Refused, advance, integral, shortened

# A step spans at most this many of the fastest time scale at its start: e-folds of the nutation.
LONGEST = 2.7
# Where nothing moves yet the can falls away from balance at about this rate, in sqrt(g/R).
PENDULUM = 0.4
# A step is sized so that this share of its harmonics is used.
SHARE = 0.8
LARGEST_GROWTH = 3.0
# Rounds of the fixed point beyond which shorter steps are cheaper.
MANY_ROUNDS = 26
# States as near as this are taken for the same point of the cycle.
SAME = 1e-6
# Nutation at which the can counts as flat: with first integrals that are zero it never stops
# falling.
FLAT = 1e-80
# phi' is zero when round-off is all there is of it.
STILL = 1e-14
# A step below this fraction of the fastest time scale means that no step is short enough.
SHORTEST = 1e-9


@dataclass(slots=True, kw_only=True)
class March:
    """An integration between two steps, or behind its last."""

    problem: Problem
    y: Floats
    time: float
    psi: float
    total: float
    contact: tuple[float, float] | None
    pieces: list[Piece] = field(default_factory=list)
    cycle: list[Element] = field(default_factory=list)
    guesses: list[Element] = field(default_factory=list)
    evaluations: int = 0

    def path(self) -> ElementsPath:
        """Return the steps that were taken as a path."""
        return ElementsPath.of(self.pieces, self.problem)

    def run(self, track: Extrema) -> Run:
        """Return the integration with its extrema and its ending."""
        steps = len(self.pieces)
        return Run(path=self.path(), track=track, steps=steps, evaluations=self.evaluations)


def integrate(problem: Problem, *, locus: bool, compiled: bool = False) -> Run:
    """Integrate the rolling equations to the horizon or an ending.

    Parameters
    ----------
    problem : Problem
    locus : bool
        Whether to integrate the contact point as well.
    compiled : bool
        Whether to take the steps by compiled code.

    Returns
    -------
    Run
    """
    watch = ExtremumRecorder(problem)
    return march(problem, watch, locus=locus, compiled=compiled).run(watch.track())


def march(
    problem: Problem, watch: ExtremumRecorder, *, locus: bool, compiled: bool = False
) -> March:
    """Integrate the rolling equations, as `integrate`, until a recorder decides the ending."""
    p = problem.parameters
    S = sin(problem.phi)
    equations = regular_equations(p, problem.phi, compiled=compiled)
    contact = None
    if locus:
        x, y = contact_from_centre(initial_states(problem), p)[0, :2].tolist()
        contact = (x, y)
    state = March(
        problem=problem,
        y=np.array(
            [
                tan(problem.phi / 2),
                problem.phi_dot,
                S * S * problem.psi_dot,
                problem.psi_dot + problem.theta_dot,
                0.0,
            ]
        ),
        time=0.0,
        psi=problem.psi,
        total=problem.psi + problem.theta,
        contact=contact,
    )
    length = inf
    while not watch.ended():
        if state.pieces and watch.t_end - state.time <= 8 * np.spacing(watch.t_end):
            # an extremum fell on the horizon: what is left is shorter than a step can be
            watch.end(state.time, Outcome.FINISHED)
            break
        length = _step(equations, state, watch, length)
        if not length > 0:
            watch.end(state.time, Outcome.STALLED)
    return state


def _step(
    equations: RegularEquations, state: March, watch: ExtremumRecorder, length: float
) -> float:
    """Take one step; return the length to try next, 0 if none is short enough."""
    guess = _guess(state)
    if guess is not None:
        length = guess.length
    if guess is None:
        length = min(length, LONGEST / _fastest(equations, state.y))
    while True:
        element = advance(equations, state.y, length, guess)
        state.evaluations += element.evaluations
        if isinstance(element, Element):
            break
        length *= element.shrink
        guess = None
        if length < SHORTEST / _fastest(equations, state.y):
            return 0.0
    following = _following(element)
    element = _onto_extremum(equations, state, element)
    piece = _piece(equations, state, element)
    piece, element = _cut_at_events(equations, state, watch, piece, element)
    _accept(state, piece, element)
    if watch.last_is_prominent_maximum and state.y[NUTATION_RATE] == 0:
        state.guesses, state.cycle = state.cycle, []
    return following


def _fastest(equations: RegularEquations, y: Floats) -> float:
    """Return the fastest rate at a state, in 1/sigma."""
    T, Phi, b, s, rise = y.tolist()
    sine = 2 * T / (1 + T * T)
    # the force on phi, in plain numbers: for one state they are faster than arrays
    G, _, Q, _, _, weight, _ = (equations.forms @ (T, sine, T * sine, 1.0)).tolist()
    q = b / sine
    pull = q * (q * G + s * Q) - weight * sin(equations.short - rise)
    return float(max(sqrt(Phi**2 + equations.swing * q * q + abs(pull)), PENDULUM * sine))


def _guess(state: March) -> Element | None:
    """Return the step of the previous bounce that started at this state, or None."""
    place = len(state.cycle)
    if place >= len(state.guesses):
        return None
    guess = state.guesses[place]
    apart = np.abs(guess.values[:, 0] - state.y) > SAME * guess.scale[:, 0]
    return None if apart.any() else guess


def _following(element: Element) -> float:
    growth = SHARE * (NODES - 1) / max(element.harmonics, 1)
    if element.evaluations > MANY_ROUNDS:
        growth = min(growth, 1.0)
    return element.length * min(max(growth, 0.5), LARGEST_GROWTH)


def _onto_extremum(equations: RegularEquations, state: March, element: Element) -> Element:
    """Stretch a step that ends just before or behind an extremum of phi so that it ends there.

    So the steps of one bounce, which ended on a maximum, end on the maximum of the next.
    """
    rate = element.values[NUTATION_RATE, -1]
    scale = element.scale[NUTATION_RATE, 0]
    if not STILL * scale < abs(rate) < SAME * scale:
        return element
    pull = rates(equations, element.values[:, -1:])[NUTATION_RATE, 0]
    if abs(rate) > SAME * element.length * abs(pull):
        return element
    better = advance(equations, state.y, element.length - rate / pull, element)
    state.evaluations += better.evaluations
    return element if isinstance(better, Refused) else better


def _piece(equations: RegularEquations, state: March, element: Element) -> Piece:
    """Return quadratures over a step: time, precession, precession plus rotation, contact point."""
    if equations.compiled:
        from reference.smooth import kernels

        origin = state.time, state.psi, state.total
        values = kernels.quadratures(element.values, element.length, origin)
    else:
        T, _, b, s, _ = element.values
        S = sine_of(T)
        rows = integral(element.length, np.stack([S, b / S, S * s]))
        rows += np.array([[state.time], [state.psi], [state.total]])
        values = np.concatenate([element.values, rows])
    if state.contact is not None:
        T, _, b, s, _, _, psi, _ = values
        S = sine_of(T)
        q = b / S
        along = S * s - q
        locus = integral(element.length, np.stack([-along * np.sin(psi), along * np.cos(psi)]))
        values = np.concatenate([values, locus + np.array(state.contact)[:, None]])
    return Piece(length=element.length, values=values, compiled=equations.compiled)


def _cut_at_events(
    equations: RegularEquations,
    state: March,
    watch: ExtremumRecorder,
    piece: Piece,
    element: Element,
) -> tuple[Piece, Element]:
    """Report extrema; shorten the step so that it ends at a maximum, an ending or the horizon."""
    Phi = piece.values[NUTATION_RATE]
    still = abs(Phi[-1]) < STILL * element.scale[NUTATION_RATE, 0] and Phi[-2] != 0
    if still:
        Phi[-1] = -np.copysign(np.finfo(float).tiny, Phi[-2])
    ending = _ending(watch, piece)
    cut = np.inf if ending is None else ending[0]
    outcome = None if ending is None else ending[1]
    for j in piece.sign_changes(NUTATION_RATE):
        at = 1.0 if still and j == NODES - 2 else piece.root(NUTATION_RATE, 0.0, j)
        if at >= cut:
            break
        column = piece.at(at)
        watch.extremum(column[TIME], snapshot(column), maximum=bool(Phi[j + 1] < 0))
        if watch.ended() or watch.last_is_prominent_maximum:
            cut, outcome = at, None
            break
    if cut >= 1 and outcome is None:
        watch.advance(piece.values[TIME, -1], 2 * atan(piece.values[TANGENT, -1]))
        return piece, element
    guess = shortened(element, (cut + 1) / 2, compiled=equations.compiled)
    short = advance(equations, state.y, guess.length, guess)
    state.evaluations += short.evaluations
    if isinstance(short, Refused):
        # a fraction of an accepted step, guessed from it, converges: only round-off can refuse it
        short = guess
    if outcome is None:
        short.values[NUTATION_RATE, -1] = 0.0
    piece = _piece(equations, state, short)
    if outcome is Outcome.FINISHED:
        # the time that was asked for, not what the root search left of it
        piece.values[TIME, -1] = watch.t_end
    if outcome is not None:
        watch.end(float(piece.values[TIME, -1]), outcome)
    return piece, short


def _ending(watch: ExtremumRecorder, piece: Piece) -> tuple[float, Outcome] | None:
    """Return the place within a step, on [-1, 1], at which the motion ends, and the outcome."""
    T, end = piece.values[TANGENT], piece.values[TIME, -1]
    if end < watch.t_end and T.max() < 1 and T[-1] > FLAT:
        return None
    endings = []
    for row, level, outcome in (
        (TANGENT, 1.0, Outcome.OVERTURNED),
        (TANGENT, FLAT, Outcome.FELL_FLAT),
        (TIME, watch.t_end, Outcome.FINISHED),
    ):
        above = piece.values[row] >= level
        crossed = np.flatnonzero(above[1:] != above[:-1])
        if crossed.size:
            endings.append((piece.root(row, level, int(crossed[0])), outcome))
    return min(endings, default=None, key=lambda item: item[0])


def snapshot(column: list[float]) -> Snapshot:
    """Return the state from the values (T, Phi, b, s, d, t, psi, psi + theta)."""
    T, Phi, b, s, _, _, psi, total = column[:8]
    phi = 2 * atan(T)
    psi_dot = b / sin(phi) ** 2
    return Snapshot(
        phi=phi,
        phi_dot=Phi,
        psi=psi,
        psi_dot=psi_dot,
        theta=total - psi,
        theta_dot=s - psi_dot,
        spin=s,
    )


def _accept(state: March, piece: Piece, element: Element) -> None:
    state.pieces.append(piece)
    state.cycle.append(element)
    state.y = piece.values[:TIME, -1].copy()
    if abs(state.y[NUTATION_RATE]) <= np.finfo(float).tiny:
        state.y[NUTATION_RATE] = 0.0
    state.time, state.psi, state.total = piece.values[TIME : TIME + 3, -1].tolist()
    if state.contact is not None:
        state.contact = (float(piece.values[-2, -1]), float(piece.values[-1, -1]))
