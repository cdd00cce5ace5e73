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
from itertools import pairwise

import numpy as np

from reference.analysis.bounces import humps
from reference.analysis.linearisation import CORE, NUMBER, STEP, Quantity, by_state
from reference.analysis.saltation import jumps, slack
from reference.analysis.stepped_constants import constants, stepped
from reference.analysis.variational import (
    Stretch,
    release_disturbances,
    stretches,
    without_tangent,
)
from reference.equations.contact_laws import Mode
from reference.equations.frames import length
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import LEAN, PSI, SLIP, TIME, W1, W2, Angles
from reference.integrable.derivatives import PULLED, QUANTITIES
from reference.integrable.tangents import BY
from reference.nonsmooth.segments import AHEAD, Segment, SegmentsPath
from reference.numerics.jets import Jet
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solver import solve

# Places of a piece among which a peak is looked for, and halvings that find it to round-off.
PLACES = np.linspace(0.0, 1.0, 9)
HALVINGS = 60
NO_BOUNCE = "the motion has no bounce"
# A peak that was measured by sampling is this near, as a share of it.
SAME_PEAK = 1e-6
ANOTHER = "the peak could not be told from others"
KINK = "the peak is where the law of the contact changes, and differs on its two sides"


class UndecidedError(ArithmeticError):
    """A derivative that does not exist; says why."""


def _released(problem: Problem, count: int) -> Floats:
    """Return the derivatives of the state at the release, rows `CORE`, shape (9, count)."""
    out = np.zeros((CORE.size, count))
    # of those of `release_disturbances`: phi, psi' and theta'; phi' has the place of theta
    out[:, [0, 2, 3]] = release_disturbances(problem)[:, [0, 2, 3]]
    out[NUMBER[W2], 1] = -1.0
    return out


def _precession(_: GeneralEquations, y: Floats, __: Mode) -> Floats:
    return np.asarray(y[W1] / Angles.of(y[LEAN]).S)


def _friction(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    force = equations.contact(y, mode).force
    return np.asarray(length(force[0], force[1]) / force[2])


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentMotion:
    """A motion of any length, with its derivatives along its pieces.

    Attributes
    ----------
    equations : GeneralEquations
    varied : tuple of GeneralEquations
        With one constant of `by` stepped each; the last of `by`.
    by : tuple of str
    pieces : tuple of Segment
    stretches : dict of int to Stretch
        By the number of the piece.
    """

    equations: GeneralEquations
    varied: tuple[GeneralEquations, ...]
    by: tuple[str, ...]
    pieces: tuple[Segment, ...]
    stretches: Mapping[int, Stretch]

    def state(self, number: int, c: float) -> Floats:
        """Return the state at a place, shape (13, 1), with the direction of a slip that begins."""
        piece = self.pieces[number]
        y = piece.at(np.array([c]))
        begins = piece.mode.slips and not self.equations.patch
        if begins and not y[SLIP].any():
            y[SLIP] = piece.at(np.array([c + AHEAD]))[SLIP]
        return y

    def rates(self, number: int, c: float) -> Floats:
        """Return the rates of the rows `CORE` at a place, shape (9,)."""
        y, mode = self.state(number, c), self.pieces[number].mode
        return np.asarray(self.equations.rates(y, mode, along=False)[CORE, 0])

    def disturbances(self, number: int, c: float, *, turns: bool) -> Floats:
        """Return derivatives of the state, rows `CORE`; where phi turns those of that instant."""
        if number not in self.stretches:
            raise UndecidedError(KINK)
        d = self.stretches[number].at(c)
        if not turns:
            return d
        f = self.rates(number, c)
        return np.asarray(d - np.outer(f / f[NUMBER[W2]], d[NUMBER[W2]]))

    def value(self, quantity: Quantity, number: int, c: float) -> float:
        """Return a quantity at a place."""
        mode = self.pieces[number].mode
        return float(quantity(self.equations, self.state(number, c), mode)[0])

    def gradient(self, quantity: Quantity, number: int, c: float) -> tuple[float, Floats, Floats]:
        """Return a quantity at a place, and its derivatives by the rows `CORE` and by `by`."""
        y, mode = self.state(number, c), self.pieces[number].mode
        slope = by_state(quantity, self.equations, y, mode)
        by_constants = [
            float(quantity(each, y.astype(complex), mode)[0].imag) / STEP for each in self.varied
        ]
        value = self.value(quantity, number, c)
        none = np.zeros(len(self.by) - len(by_constants))
        return value, slope, np.concatenate([none, by_constants])


def motion_tangents(problem: Problem) -> tuple[tuple[str, ...], dict[str, Jet], dict[str, str]]:
    """Return the numbers of the first bounce in jets, of any can.

    Parameters
    ----------
    problem : Problem
        Its horizon does not matter.

    Returns
    -------
    by : tuple of str
        What derivatives are taken by.
    jets : dict of str to Jet
        By the names `reference.integrable.derivatives.QUANTITIES`, dimensionless.
    why : dict of str to str
        Why there is no derivative, of the quantities that are left out.
    """
    by = (*BY, *constants(problem.effects))
    solution = solve(replace(problem, bounces=1, duration=None), model="general")
    path = solution.path
    if not solution.bounces or not isinstance(path, SegmentsPath):
        reason = f"{NO_BOUNCE}: {solution.outcome.value.rstrip('.')}"
        return by, {}, dict.fromkeys(QUANTITIES, reason)
    if reason := without_tangent(problem.effects, path.pieces):
        return by, {}, dict.fromkeys(QUANTITIES, reason)
    motion = tangent_motion(problem, path, by)
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


def tangent_motion(problem: Problem, path: SegmentsPath, by: tuple[str, ...]) -> TangentMotion:
    """Return a motion that was solved with its derivatives along all of it.

    Parameters
    ----------
    problem : Problem
    path : SegmentsPath
        Of its solution by the general model.
    by : tuple of str
        The names `BY` and the constants of its effects.
    """
    equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
    varied = tuple(stepped(problem, name) for name in by[by.index("a") :])
    fixed = len(by) - len(varied)

    def forcing(y: Floats, mode: Mode) -> Floats:
        out = np.zeros((CORE.size, len(by), y.shape[1]))
        for place, each in enumerate(varied):
            rates = each.rates(y.astype(complex), mode, along=False)
            out[:, fixed + place] = rates[CORE].imag / STEP
        return out

    def slack_by(y: Floats, mode: Mode) -> Floats:
        by_varied = [float(slack(each, y.astype(complex), mode)[0].imag) / STEP for each in varied]
        return np.concatenate([np.zeros(fixed), by_varied])

    number = {id(piece): place for place, piece in enumerate(path.pieces)}
    flow = stretches(equations, path.pieces, _released(problem, len(by)), forcing, slack_by)
    return TangentMotion(
        equations=equations,
        varied=varied,
        by=by,
        pieces=path.pieces,
        stretches={number[id(stretch.piece)]: stretch for stretch in flow},
    )


Place = tuple[int, float]


def _limit(motion: TangentMotion, starts: Place, ends: Place) -> Jet | None:
    """Return the coefficient of friction as the peak of its ratio, if a point of contact slips.

    It is the static one where the rim sticks before.
    """
    pieces = motion.pieces[starts[0] : ends[0] + 1]
    if motion.equations.patch or not any(piece.mode.slips for piece in pieces):
        return None
    name, value = "slip.mu", motion.equations.mu
    if jumps(motion.equations.effects) and not all(piece.mode.slips for piece in pieces):
        name, value = "slip.mu_static", motion.equations.mu_static
        if not _begins(pieces):
            return None
    return Jet(np.asarray(value), np.array([float(name == each) for each in motion.by]))


def _begins(pieces: tuple[Segment, ...]) -> bool:
    """Return whether a rim that sticks begins to slip."""
    return any(piece.mode.slips and not before.mode.slips for before, piece in pairwise(pieces))


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
        low, high = places[max(best - 2, 0)], places[min(best + 2, len(places) - 1)]
        if best in edges and rising(low) == rising(high):
            at, turns = edges[best]
        else:
            at, turns = _top(motion, rising, low, high), False
        _, by_row, by_constants = motion.gradient(quantity, *at)
        value = motion.value(quantity, *at)
        if abs(value - known) <= SAME_PEAK * abs(known):
            break
    else:
        raise UndecidedError(ANOTHER)
    slope = by_row @ motion.disturbances(*at, turns=turns) + by_constants
    return Jet(np.asarray(value), slope)


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
