"""Integration of phases of sticking and slipping by compiled code, step after step.

The same motion as of `reference.nonsmooth.hybrid_integrator`, by the same rule of steps. Compiled
code marches through steps and extrema of phi by itself, and comes back where the law changes, where
friction is about to stop something, or where its fixed point fails and Newton's method goes on.

Needs numba (`reference.numerics.compiled`).
"""

import numpy as np

from reference.equations.compiled_equations import CompiledEquations, laws_of
from reference.equations.contact_laws import Mode
from reference.equations.state_vector import LEAN, ROWS, TIME, phi_of, released
from reference.nonsmooth import event_kernels, kernels
from reference.nonsmooth.events import compiled_events
from reference.nonsmooth.hybrid_integrator import MOST_WORK, HybridIntegrator
from reference.nonsmooth.radau_iia import STAGES, basis, coefficients, points
from reference.nonsmooth.segments import Segment
from reference.nonsmooth.stopping import ALL_BUT_FLAT, slows_turning
from reference.nonsmooth.transitions import ModeTransition, begin_on_rim
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.smooth.extrema import ExtremumRecorder

# In sigma, as `FIRST`: steps by fixed point cost next to nothing where they are refused.
FIRST_ROUNDS = 0.4
# Rounds of a fixed point that stand for an update of Newton's method, which does the same at less.
ROUNDS_A_UPDATE = 4
# Of ln tan(phi/2): so far above a disk that is all but flat its next nutations may be its last.
NUTATES = 7.0
# Steps that compiled code takes before it reports them.
STEPS_A_MARCH = 32
# Basis of a step at the first of its points.
FIRST_POINT = basis(points()[:1])[0]


class CompiledIntegrator(HybridIntegrator):
    """Integrates one problem by compiled code."""

    def __init__(
        self,
        problem: Problem,
        equations: CompiledEquations,
        *,
        locus: bool,
        start: Floats | None = None,
        watch: ExtremumRecorder | None = None,
    ) -> None:
        self._compiled = equations
        super().__init__(problem, equations, locus=locus, start=start, watch=watch)
        if not self._mode.slips and not self._now.at_once:
            self._length = FIRST_ROUNDS

    def _released(self, problem: Problem) -> tuple[Floats, ModeTransition]:
        return begin_on_rim(self._equations, released(problem, at=self._locus))

    def _most_work(self) -> int:
        """Return at how many evaluations the motion is given up."""
        return self._work_before + MOST_WORK * ROUNDS_A_UPDATE

    def _end(self, piece: Segment) -> Floats:
        return self._state_at(piece, piece.cut)

    def _state_at(self, piece: Segment, c: float) -> Floats:
        """Return the state, shape (13,), at one place of a step."""
        column = np.empty((ROWS, 1))
        event_kernels.state_at(piece.start, piece.coefficients, c, column)
        return column[:, 0]

    def _march(self) -> bool:
        """Take steps of compiled equations by fixed point; return whether any was taken."""
        now, equations = self._now, self._compiled
        if now.at_once and (equations.resistance > 0 or equations.drilling > 0):
            # what begins against several laws at once is for Newton's method
            return False
        most = self._most_work() - self._evaluations
        if most < 0:
            return False
        mode, resisted = self._mode, equations.resistance > 0
        last, before = self._pieces[-1] if self._pieces else None, self._length
        if not now.at_once and last is not None and last.mode == mode and last.length > 0:
            polynomial, scale, cut = last.coefficients, last.length, last.cut
        else:
            scale, cut = self._length, 0.0
            polynomial = coefficients(self._guess(scale))
        reason, self._length, rounds, starts, series, taken, extrema, met = kernels.march(
            equations.constants,
            laws_of(mode),
            self._y,
            equations.core(mode),
            (min(self._length, self._left()) if resisted else self._length, scale, cut),
            polynomial,
            (self.watch.t_end, equations.bilateral_normal),
            (1 if resisted else STEPS_A_MARCH, most // STAGES + 1),
            (self._locus, self._passes(), now.at_once),
        )
        self._evaluations += rounds * STAGES
        if now.at_once and (
            not len(taken) or not self._sets_out(series[0] @ FIRST_POINT, np.arange(ROWS))
        ):
            self._length = before
            return False
        self._now = ModeTransition(mode=mode)
        seen = resisted or reason == kernels.LOOK
        marched = starts, series, taken, extrema
        if self._report_march(marched, mode, met if seen else None):
            return True
        if reason == kernels.STOPS:
            self._halt()
        return reason != kernels.STUCK

    def _report_march(
        self,
        marched: tuple[Floats, Floats, Floats, Floats],
        mode: Mode,
        met: Floats | None,
    ) -> bool:
        """Take over compiled steps; return whether the motion has ended or changed its law.

        With the events of the last step, where these have to be looked at.
        """
        starts, series, taken, extrema = marched
        times, leans = starts[1:, TIME].tolist(), starts[1:, LEAN].tolist()
        last, seen = len(taken) - 1, 0
        steps = zip(starts, series, taken.tolist(), strict=False)  # of a start more
        for number, (start, polynomial, length) in enumerate(steps):
            piece = Segment(start=start, coefficients=polynomial, cut=1.0, length=length, mode=mode)
            if met is not None and number == last:
                self._see(piece, compiled_events(met))
                return True
            self._pieces.append(piece)
            while seen < len(extrema) and extrema[seen, 0] == number:
                maximum = bool(extrema[seen, 1] == kernels.MAXIMUM)
                self._report(extrema[seen, 2:], maximum=maximum)
                seen += 1
            self._y = starts[number + 1]
            if self._counts:
                self.watch.advance(times[number], phi_of(leans[number]))
            if self.watch.ended():
                return True
        return False

    def _passes(self) -> int:
        """Return how many of the next extrema of phi cannot end the motion."""
        if slows_turning(self._equations) and self._y[LEAN] < ALL_BUT_FLAT + NUTATES:
            return 0
        if not self._counts:
            return 2 * STEPS_A_MARCH
        # a minimum closes no bounce
        return 1 if self.watch.last_is_prominent_maximum else 0
