"""Extrema of phi during an integration, and the decision to stop.

Every integrator reports extrema of phi; this module decides which of them count as a maximum, as a
bounce and as an ending. The result of an integrator is a `Run`: its path and its extrema.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Protocol

import numpy as np

from reference.equations.contact_laws import Impact, Phase
from reference.equations.nonholonomic import EPS, nutation_acceleration, stands_still
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, States, states_of

# A bounce must stand out from round-off: phi must fall by at least this fraction of its maximum.
PROMINENCE = 1e-9
# The same of a motion with impacts, over the largest phi: as bounces of engines are measured.
SHARE_OF_BOUNCE = 0.01
# Ripples in a row before a motion is called steady.
RIPPLES = 4
# A motion in which phi stays within `PROMINENCE` for this many pendulum times is steady: beside a
# saddle with the rate s per pendulum time what an ulp leaves takes ln(1e7)/s = 16/s to be seen.
# Where steady motions merge s is next to nothing; there the pull of the release says how long.
LONGEST_WAIT = 400.0
# Times in which a constant pull moves phi by `PROMINENCE`: a pull that grows takes less than one,
# and a small oscillation goes half round in pi/2.
PULLED = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Extrema:
    """Extrema of phi and the ending of an integration.

    Attributes
    ----------
    outcome : Outcome
    t_end : float
    times : ndarray, shape (n,)
        Of the extrema of phi.
    extrema : States
        There, shape (n,).
    maximum : ndarray of bool, shape (n,)
        Which of them are maxima.
    """

    outcome: Outcome
    t_end: float
    times: Floats
    extrema: States
    maximum: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]

    @property
    def maxima(self) -> Floats:
        """Times of the maxima."""
        return self.times[self.maximum]

    @property
    def minima(self) -> Floats:
        """Times of the minima."""
        return self.times[~self.maximum]


def prominent(heights: Sequence[float], share: float) -> list[int]:
    """Return which extrema count, between which phi changes by a share of the largest, or more.

    Of two neighbours that are nearer to each other neither counts; of the first two, the second is
    kept, and of the last two the first.

    Parameters
    ----------
    heights : sequence of float
        phi at maxima and minima in turn, rad.
    share : float
        Of the largest of them.
    """
    kept, phi = list(range(len(heights))), np.array(heights)
    least = share * float(phi.max(initial=0.0))
    while len(kept) > 1:
        swings = np.abs(np.diff(phi[kept]))
        smallest, last = int(swings.argmin()), len(kept) - 2
        if swings[smallest] >= least:
            break
        if smallest == last:
            del kept[-1]
        else:
            del kept[smallest : smallest + (2 if smallest else 1)]
    return kept


class ExtremumRecorder:
    """Collects the extrema of phi and decides the ending.

    A release that falls, or rests where phi'' < 0, counts as a maximum at t = 0. Of a can that does
    not simply roll, phi'' there is given as `fall`.

    Where bounces are asked for a motion in which phi no longer moves ends as steady. One that
    moves, however slowly, is followed: near a fold of the steady motions a bounce takes any time.

    Attributes
    ----------
    share : float
        Of the largest phi: where it is not zero, only extrema count that stand out by so much, for
        impacts turn phi' at any time.
    """

    def __init__(self, problem: Problem, fall: float | None = None) -> None:
        self.share = 0.0
        self._problem = problem
        self._outcome: Outcome | None = None
        self.t_end = np.inf if problem.duration is None else problem.duration
        self._ripples = 0
        self._seen = (0.0, problem.phi)
        self._closed = 0
        self._extrema: list[tuple[float, Snapshot, bool]] = []
        rolls = fall is None
        if fall is None:
            p = problem
            # of numbers: for one instant they are several times faster than arrays
            spin = p.psi_dot + p.theta_dot
            fall = float(nutation_acceleration(p.phi, p.psi_dot, spin, p.parameters))
        still = rolls and stands_still(problem, fall)
        self._wait = _longest_wait(problem, fall, still=still)
        falls = (problem.phi_dot or fall) < 0
        if falls or problem.phi_dot == 0:
            self._extrema.append((0.0, Snapshot.of(problem), falls))

    @property
    def last_is_prominent_maximum(self) -> bool:
        """Return whether the last extremum is a maximum that stands out."""
        return bool(self._extrema) and self._extrema[-1][2] and self._ripples == 0

    def extremum(self, time: float, snapshot: Snapshot, *, maximum: bool) -> None:
        """Report that phi' changed sign."""
        self._seen = (time, snapshot.phi)
        if self._extrema:
            _, previous, previous_maximum = self._extrema[-1]
            if maximum == previous_maximum:
                # phi' touched zero and was seen twice: keep the first
                return
            if abs(snapshot.phi - previous.phi) < PROMINENCE * max(snapshot.phi, previous.phi):
                self._ripples += 1
                if self._ripples >= RIPPLES:
                    self._extrema.clear()
                    if self._problem.bounces is not None:
                        self.end(time, Outcome.STEADY)
                    return
            else:
                self._ripples = 0
        self._extrema.append((time, snapshot, maximum))
        if maximum and self._ripples == 0 and len(self._extrema) > 1:
            asked = self._problem.bounces
            if self.share == 0.0:
                self._closed += len(self._extrema) > 2  # noqa: PLR2004 - max, min, max
            elif asked is not None:
                kinds = [kind for _, _, kind in self._counted(self._extrema)]
                self._closed = sum(kinds) - 1 if kinds and kinds[-1] else 0
            if asked is not None and self._closed >= asked:
                self.end(time, Outcome.FINISHED)

    def _counted(
        self, seen: Sequence[tuple[float, Snapshot, bool]]
    ) -> list[tuple[float, Snapshot, bool]]:
        """Return the extrema that stand out."""
        if self.share == 0.0:
            return list(seen)
        return [seen[k] for k in prominent([snapshot.phi for _, snapshot, _ in seen], self.share)]

    def advance(self, time: float, phi: float) -> None:
        """Report that the motion is integrated up to `time`, and phi there."""
        since, place = self._seen
        if abs(phi - place) > PROMINENCE * max(phi, place):
            self._seen = (time, phi)
        elif self._problem.bounces is not None and time - since > self._wait:
            self.end(time, Outcome.STEADY)

    def ended(self) -> bool:
        """Return whether the motion has ended."""
        return self._outcome is not None

    def end(self, time: float, outcome: Outcome) -> None:
        """End the motion at `time`, unless it has ended before."""
        if self._outcome is None:
            self.t_end = time
            self._outcome = outcome

    def go_on(self) -> None:
        """Take back an ending: the motion goes on by another law."""
        self._outcome = None
        self.t_end = np.inf if self._problem.duration is None else self._problem.duration

    @property
    def outcome(self) -> Outcome | None:
        """Return how the motion ended, None of one that has not."""
        return self._outcome

    def track(self) -> Extrema:
        """Sum up.

        Raises
        ------
        RuntimeError
            If the motion has not ended.
        """
        if self._outcome is None:
            raise RuntimeError("the motion has not ended")
        seen = self._counted([e for e in self._extrema if e[0] <= self.t_end])
        heights = [snapshot.phi for _, snapshot, _ in seen]
        if len(seen) > 1 and max(heights) - min(heights) < PROMINENCE * max(heights):
            seen = []
        return Extrema(
            outcome=self._outcome,
            t_end=self.t_end,
            times=np.array([time for time, _, _ in seen], dtype=float),
            extrema=states_of([snapshot for _, snapshot, _ in seen]),
            maximum=np.array([maximum for _, _, maximum in seen], dtype=bool),
        )


def _longest_wait(problem: Problem, pull: float, *, still: bool) -> float:
    """Return for how long phi of a moving can may stay within `PROMINENCE`."""
    if still:
        # round-off grows by e^(2 pi) or less meanwhile: nothing to see
        return 2 * pi
    wait = LONGEST_WAIT * sqrt(problem.parameters.pendulum_inertia)
    if pull == 0:
        return wait
    return max(wait, PULLED * sqrt(2 * PROMINENCE * problem.phi / max(abs(pull), EPS)))


class Path(Protocol):
    """A motion known at every instant up to its end."""

    def at(self, times: Floats) -> States:
        """States at the given times."""
        ...

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states the solver itself has, from the start to the end."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A finished integration.

    Attributes
    ----------
    path : Path
    track : Extrema
    steps, evaluations : int
        Solver work.
    phases : tuple of Phase
        Of sticking and slipping, where the law of contact may change.
    peaks : ndarray, shape (2, bounces), or None
        Of each bounce the largest rate of precession, with its sign, and the largest friction
        ratio, where compiled code has measured them.
    impacts : tuple of Impact
        Of a can that leaves the plane, in order.
    """

    path: Path
    track: Extrema
    steps: int
    evaluations: int
    phases: tuple[Phase, ...] = ()
    peaks: Floats | None = None
    impacts: tuple[Impact, ...] = ()
