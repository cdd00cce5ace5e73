"""Following a motion while it is computed: extrema of phi, and when to stop.

Every integrator reports what happens to phi; here it is decided what counts as a maximum, a
bounce, an ending.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from reference.problem import Problem
from reference.rolling import nutation_acceleration
from reference.states import Floats, initial_states

# A bounce must stand out from round-off: phi must fall by at least this fraction of its maximum.
PROMINENCE = 1e-9
# Ripples in a row before a motion is called steady.
RIPPLES = 4
# A motion without an extremum for this many pendulum times stands balanced: a fall from one double
# off
# the balancing angle takes ln(1e16) = 37 of them, and rolling at any rate slows it by less than 10.
LONGEST_WAIT = 400.0


class Ending(Enum):
    """Why an integration stopped."""

    HORIZON = auto()
    OVERTURNED = auto()
    FELL_FLAT = auto()
    STEADY = auto()
    STALLED = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """What was seen on the way."""

    ending: Ending
    t_end: float
    maxima: Floats
    minima: Floats
    marks: Floats
    steps: int
    evaluations: int


class Watch:
    """Collects the extrema of phi and decides the ending.

    A release that falls, or rests where phi'' < 0, counts as a maximum at t = 0.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self.ending: Ending | None = None
        self.t_end = 0.0
        self._ripples = 0
        self._last = 0.0
        self._extrema: list[tuple[float, float, bool]] = []
        release = initial_states(problem)
        fall = problem.phi_dot
        if fall == 0:
            fall = float(
                nutation_acceleration(
                    release.phi, release.psi_dot, release.spin, problem.parameters
                )[0]
            )
        if fall < 0:
            self._extrema.append((0.0, problem.phi, True))
        elif problem.phi_dot == 0:
            self._extrema.append((0.0, problem.phi, False))

    def extremum(self, time: float, phi: float, *, rises_after: bool) -> None:
        """Report that phi' changed sign."""
        self._last = time
        maximum = not rises_after
        if self._extrema:
            _, previous, previous_maximum = self._extrema[-1]
            if maximum == previous_maximum:
                # phi' touched zero and was seen twice: keep the first
                return
            if abs(phi - previous) < PROMINENCE * max(phi, previous):
                self._ripples += 1
                if self._ripples >= RIPPLES:
                    self._extrema.clear()
                    if self._problem.bounces is not None:
                        self.end(time, Ending.STEADY)
                    return
            else:
                self._ripples = 0
        self._extrema.append((time, phi, maximum))
        if maximum and self._problem.bounces is not None:
            maxima = sum(1 for *_, is_maximum in self._extrema if is_maximum)
            if maxima - 1 >= self._problem.bounces and self._ripples == 0:
                self.end(time, Ending.HORIZON)

    def advance(self, time: float) -> None:
        """Report that the motion was followed up to `time`."""
        wait = LONGEST_WAIT * np.sqrt(self._problem.parameters.pendulum_inertia)
        if self._problem.bounces is not None and time - self._last > wait:
            self.end(time, Ending.STEADY)

    def ended(self) -> bool:
        """Whether the motion has come to its end."""
        return self.ending is not None

    def end(self, time: float, ending: Ending) -> None:
        """Stop at `time`; what ended first stays."""
        if self.ending is not None:
            return
        self.t_end = time
        self.ending = ending

    def track(self, *, marks: Sequence[float], steps: int, evaluations: int) -> Track:
        """Sum up."""
        if self.ending is None:
            raise RuntimeError("the motion has not ended")
        inside = [e for e in self._extrema if e[0] <= self.t_end and self._prominent()]
        return Track(
            ending=self.ending,
            t_end=self.t_end,
            maxima=np.array([t for t, _, maximum in inside if maximum]),
            minima=np.array([t for t, _, maximum in inside if not maximum]),
            marks=np.array([t for t in marks if t <= self.t_end]),
            steps=steps,
            evaluations=evaluations,
        )

    def _prominent(self) -> bool:
        heights = [phi for _, phi, _ in self._extrema]
        return max(heights) - min(heights) > PROMINENCE * max(heights) or len(heights) == 1
