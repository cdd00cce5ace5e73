"""Solution of a motion by two methods, and the answer where both agree.

A wrong answer is as smooth as a right one and does not show that it is wrong. So the quadrature
between turning points (`reference.integrable.exact_motion`), which does not follow the motion, is
compared with the integration (`reference.smooth.time_reversal`), which knows no turning point
beforehand. The motion is periodic: its first bounces up to the end of a full period stand for all.

The allowed difference is no fixed tolerance. Each of the n operations of the integration rounds,
so what it returns is, to within n roundings, the motion of numbers that are off by n eps at most
(its backward error). A quantity f of the numbers x_i may therefore be off by

    n eps |f| + sum_i max |f(x_i (1 +- n eps)) - f(x_i)|,

the differences taken by integration, infinite where a neighbour ends otherwise, and no more of them
than are enough. To it comes the share of the force on phi that is lost where its terms
cancel, at the extrema of phi: beside a steady motion no error of the x_i amounts to that.

Three cases follow. The methods agree: the answer is the closed one. They part by more: one of them
is wrong, and the answer is the integration's, which assumes less. Or fewer digits agree than are
promised, and one ulp of the numbers given decides the third of them, or the ending: then there is
no answer, from where the neighbours part, whatever round-off may explain.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol

import numpy as np

from reference.analysis.agreement import ENDING, USEFUL, Agreement
from reference.analysis.bounces import measure_bounces
from reference.analysis.conditioning import EPS, PROMISED, lost_of_force, neighbours
from reference.integrable.cycle import exact_bounces
from reference.integrable.exact_motion import ExactPath, exact_path, until_horizon
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, States, select_states
from reference.smooth.extrema import Run
from reference.smooth.time_reversal import integrate_by_symmetry
from reference.solution import Bounce

# Of one evaluation of the equations, each of which rounds.
OPERATIONS = 64
# An ulp that moves a motion by less than this share of what would be too much moves it as much the
# other way: before it decides an ending the time of the passage grows like the logarithm of what is
# left of the energy, which another ulp doubles or takes.
LINEAR = 0.1


class Bouncing(Protocol):
    """A motion and its bounces: a solution, or a motion before it becomes one."""

    @property
    def problem(self) -> Problem:
        """Return the problem that is solved."""
        ...

    @property
    def bounces(self) -> tuple[Bounce, ...]:
        """Return a bounce for each minimum of phi between two maxima."""
        ...

    @property
    def maxima(self) -> Floats:
        """Times of the maxima of phi."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """A motion and its bounces.

    Attributes
    ----------
    problem : Problem
    run : Run
    bounces : tuple of Bounce
    """

    problem: Problem
    run: Run
    bounces: tuple[Bounce, ...]

    @property
    def maxima(self) -> Floats:
        """Times of the maxima of phi."""
        return self.run.track.maxima


@dataclass(frozen=True, slots=True, kw_only=True)
class Confirmed:
    """A motion that was solved twice.

    Attributes
    ----------
    motion : Motion
    closed : bool
        Whether it is the closed solution's, and not the integration's.
    agreement : Agreement
    """

    motion: Motion
    closed: bool
    agreement: Agreement


def solve_twice(problem: Problem, *, locus: bool) -> Confirmed:
    """Solve a rolling can by the closed solution, and confirm it by integration.

    Parameters
    ----------
    problem : Problem
    locus : bool
        Whether the contact point is wanted.

    Returns
    -------
    Confirmed
    """
    # up to the end of a whole period: that of a release which falls already is the second
    short = replace(problem, bounces=2 if problem.phi_dot < 0 else 1, duration=None)
    path = exact_path(problem, locus=locus)
    if isinstance(path, Outcome):
        whole = _integrated(problem, locus=locus)
        if _ends_as(path, whole):
            agreement = Agreement(quantity=ENDING, discrepancy=0.0, allowed=0.0, evaluations=0)
            return Confirmed(motion=whole, closed=False, agreement=agreement)
        integrated = whole if problem == short else _integrated(short, locus=locus)
        apart = {ENDING: np.inf}
        if path is Outcome.UNRESOLVED:
            # the history has lost its digits; the integrals of a period may have kept theirs
            apart = _from_integrals(integrated)
    else:
        closed = _closed(short, path)
        integrated = _integrated(short, locus=locus)
        apart = _apart(closed, integrated)
    agreement, near = _compared(short, integrated, apart)
    if not agreement.resolved:
        motion = _up_to(problem, _parting(integrated, near), locus=locus)
    elif agreement.holds and isinstance(path, ExactPath):
        motion = closed if problem == short else _closed(problem, path)
        return Confirmed(motion=motion, closed=True, agreement=agreement)
    else:
        motion = integrated if problem == short else _integrated(problem, locus=locus)
    return Confirmed(motion=motion, closed=False, agreement=agreement)


def _compared(
    short: Problem, integrated: Motion, apart: dict[str, float]
) -> tuple[Agreement, list[Motion]]:
    """Return how the closed motion agrees with the integration, and the neighbours of the latter.

    Parameters
    ----------
    short : Problem
    integrated : Motion
        By integration.
    apart : dict of str to float
        By how much the closed motion differs from it, empty where that is lost in round-off.
    """
    evaluations = integrated.run.evaluations
    share = OPERATIONS * evaluations * EPS
    rounded = float(lost_of_force(integrated.run.track.extrema, short).max(initial=share))
    far = _Neighbours(integrated, share)
    allowed = {name: far.moved(off, share + rounded, name) for name, off in apart.items()}
    parted = [name for name, off in apart.items() if off > allowed[name]]
    if parted:
        worst = max(parted, key=lambda name: _over(apart[name], allowed[name]))
    else:
        worst = max(apart, key=lambda name: apart[name], default=ENDING)
    near, ulp = _Neighbours(integrated, EPS), 0.0
    if apart.get(worst, np.inf) > PROMISED:
        quantity = worst if apart else None
        ulp = near.moved(USEFUL, name=quantity, ways=1)
        if ulp > LINEAR * USEFUL:
            ulp = near.moved(USEFUL, name=quantity)
    agreement = Agreement(
        quantity=worst,
        discrepancy=apart.get(worst, np.inf),
        allowed=allowed.get(worst, 0.0),
        refused=not apart,
        ulp=ulp,
        evaluations=evaluations + far.evaluations + near.evaluations,
    )
    return agreement, list(near.solved.values())


def differences(one: Bouncing, other: Bouncing) -> dict[str, float]:
    """Return the largest relative differences of the bounces that two motions have in common.

    Angles are taken over 1 rad or over themselves, if they are larger, times over a period.
    """
    start = max(1.0, abs(other.problem.psi), abs(other.problem.theta))
    largest: dict[str, float] = {}
    rows = zip(
        one.bounces, other.bounces, pairwise(one.maxima), pairwise(other.maxima), strict=False
    )
    for mine, theirs, (left, right), (begin, end) in rows:
        period = end - begin
        scales = {
            "period": (right - left, period, period),
            "time of the bounce": (mine.time, theirs.time, max(period, theirs.time)),
            "least phi": (mine.phi_min, theirs.phi_min, theirs.phi_min),
            "angle of turn": (mine.angle_of_turn, theirs.angle_of_turn, start),
            "rotation": (mine.rotation_turn, theirs.rotation_turn, start),
            "peak precession rate": (mine.peak_psi_dot, theirs.peak_psi_dot, 0.0),
        }
        for name, (a, b, scale) in scales.items():
            off = abs(a - b) / max(scale, abs(b))
            largest[name] = max(largest.get(name, 0.0), off if np.isfinite(off) else np.inf)
    return largest


def _closed(problem: Problem, path: ExactPath) -> Motion:
    # what is wrong may be no number: the comparison says so
    with np.errstate(all="ignore"):
        return _measured(problem, until_horizon(problem, path))


def _integrated(problem: Problem, *, locus: bool) -> Motion:
    return _measured(problem, integrate_by_symmetry(problem, locus=locus))


def _measured(problem: Problem, run: Run) -> Motion:
    bounces = measure_bounces(run.path, run.track, problem.parameters)
    return Motion(problem=problem, run=run, bounces=bounces)


def _ends_as(ending: Outcome, motion: Motion) -> bool:
    """Return whether a motion without a bounce ends as predicted or has not ended yet."""
    foretold = ending is not Outcome.UNRESOLVED and not motion.bounces
    return foretold and motion.run.track.outcome in {ending, Outcome.FINISHED}


def _from_integrals(integrated: Motion) -> dict[str, float]:
    """Return the relative differences of a motion from the integrals of its period.

    Nothing where these are lost as well.
    """
    p, bounces = integrated.problem, integrated.bounces
    cycle = exact_bounces(
        a=p.parameters.a,
        c=p.parameters.c,
        h=p.parameters.h,
        phi=p.phi,
        phi_dot=p.phi_dot,
        psi_dot=p.psi_dot,
        theta_dot=p.theta_dot,
    )
    if cycle.outcome(0) is Outcome.UNRESOLVED:
        return {}
    if not cycle.bounced[0] or not bounces:
        same = cycle.outcome(0) is integrated.run.track.outcome
        return {ENDING: 0.0 if same else np.inf}
    last, period = bounces[-1], float(np.diff(integrated.maxima)[-1])
    pairs = {
        "period": (cycle.period, period, period),
        "least phi": (cycle.phi_min, last.phi_min, last.phi_min),
        "angle of turn": (cycle.angle_of_turn, last.angle_of_turn, 1.0),
        "rotation": (cycle.rotation_turn, last.rotation_turn, 1.0),
        "peak precession rate": (cycle.peak_psi_dot, last.peak_psi_dot, 0.0),
    }
    return {
        name: float(abs(value[0] - known) / max(scale, abs(known)))
        for name, (value, known, scale) in pairs.items()
    }


def _apart(one: Motion, other: Motion) -> dict[str, float]:
    """Return the relative difference of two motions in each quantity."""
    mine, theirs = one.run.track, other.run.track
    if mine.outcome is not theirs.outcome or len(one.bounces) != len(other.bounces):
        return {ENDING: np.inf}
    if not other.bounces:
        return {ENDING: 0.0}
    top, known = mine.extrema.phi[mine.maximum][-1], theirs.extrema.phi[theirs.maximum][-1]
    largest = differences(one, other) | {"greatest phi": abs(top / known - 1)}
    if mine.extrema.x is not None and theirs.extrema.x is not None:
        moved, truth = (_displacement(extrema) for extrema in (mine.extrema, theirs.extrema))
        largest["contact locus"] = abs(moved - truth) / max(1.0, abs(truth))
    return {name: float(off) if np.isfinite(off) else np.inf for name, off in largest.items()}


def _displacement(extrema: States) -> complex:
    """Return how far the contact point is from the last but one extremum to the last."""
    if extrema.x is None or extrema.y is None:
        raise ValueError("the contact locus was not asked for")
    return complex(np.diff(extrema.x)[-1], np.diff(extrema.y)[-1])


class _Neighbours:
    """The neighbours of a motion by a share of each number, integrated on demand.

    Attributes
    ----------
    solved : dict from (int, int) to Motion
        By the number that is moved and the way in which it is.
    """

    def __init__(self, own: Motion, share: float) -> None:
        self.solved: dict[tuple[int, int], Motion] = {}
        self._own = own
        self._problems = list(neighbours(own.problem, share))

    @property
    def evaluations(self) -> int:
        """Return the evaluations that the integration of the neighbours took."""
        return sum(motion.run.evaluations for motion in self.solved.values())

    def moved(
        self, enough: float, known: float = 0.0, name: str | None = None, ways: int = 2
    ) -> float:
        """Return the sum of the differences of a quantity in the neighbours.

        Parameters
        ----------
        enough : float
            Bound at which the sum ends early.
        known : float
            First term of the sum.
        name : str or None
            Of the quantity; if left out, the one with the largest difference in each neighbour.
        ways : int
            1 for neighbours with a larger number only, 2 for those with a smaller one as well.
        """
        total, number = known, 0
        while total < enough and number < len(self._problems):
            count = len(self._problems[number][:ways])
            apart = (_apart(self._solve(number, way), self._own) for way in range(count))
            total += max(
                max(off.values()) if name is None else off.get(name, off.get(ENDING, 0.0))
                for off in apart
            )
            number += 1
        return total

    def _solve(self, number: int, way: int) -> Motion:
        if (number, way) not in self.solved:
            locus = self._own.run.track.extrema.x is not None
            self.solved[number, way] = _integrated(self._problems[number][way], locus=locus)
        return self.solved[number, way]


def _parting(own: Motion, near: Sequence[Motion]) -> float:
    """Return the time up to which the neighbours of a motion are the same to three digits.

    Its end, where none parts from it by itself, and only all of them together do.
    """
    times, states = own.run.path.nodes()
    apart = np.zeros_like(times)
    for other in near:
        known = times <= other.run.track.t_end
        moved = other.run.path.at(times[known])
        mine = select_states(states, np.flatnonzero(known))
        total = moved.psi + moved.theta - mine.psi - mine.theta
        aside = np.sin(mine.phi) * (moved.psi - mine.psi)
        off = np.max(np.abs([moved.phi - mine.phi, aside, total]), axis=0)
        apart[known] = np.maximum(apart[known], off)
        apart[~known] = np.inf
    gone = np.flatnonzero(apart > USEFUL)
    return float(times[max(gone[0] - 1, 1)] if gone.size else times[-1])


def _over(off: float, allowed: float) -> float:
    """Return the ratio of a difference to the allowed one.

    Infinite where the difference is, and where none is allowed.
    """
    if np.isinf(off):
        return np.inf
    return off / allowed if allowed else np.inf


def _up_to(problem: Problem, parted: float, *, locus: bool) -> Motion:
    """Return a motion up to the time at which its neighbours differ from it, then unresolved.

    A motion whose horizon comes first is known to its end.
    """
    if problem.duration is not None and problem.duration <= parted:
        return _integrated(problem, locus=locus)
    run = integrate_by_symmetry(replace(problem, bounces=None, duration=parted), locus=locus)
    track = replace(run.track, outcome=Outcome.UNRESOLVED)
    return Motion(problem=problem, run=replace(run, track=track), bounces=())
