"""Integration of a can on a contact that gives way: through contact, flight, and contact again.

The steps and the switches between sticking and slipping are those of
`reference.nonsmooth.hybrid_integrator`. Two more are located here to round-off: where the force of
the law falls to zero the can flies, and where it is pushed again the contact begins. Impacts are
smooth, for the contact takes a time to be pressed and to spring back.

A bounce is a fall and a rise of phi that a hundredth of the largest phi so far is less than: what
the contact's own vibration does to phi is none. That is the prominence by which bounces of engines
are measured, too.
"""

from dataclasses import replace

import numpy as np

from reference.compliant.equations import DEPTH, RISE, ROWS, CompliantEquations
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import ROLLING_1, SLIP_1, SLIP_2, GeneralEquations
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    QUIET,
    TIME,
    Angles,
    Index,
    X,
    Y,
    released,
    sizes,
    tail_of,
)
from reference.equations.state_vector import ROWS as RIGID_ROWS
from reference.nonsmooth.events import LIMITS, LOOKS, OF_THE_STATE, Event, EventKind, events
from reference.nonsmooth.hybrid_integrator import FIRST, LONGEST, SHORTEST, HybridIntegrator
from reference.nonsmooth.level_spin import stands
from reference.nonsmooth.patch_onset import moving
from reference.nonsmooth.segments import Segment, SegmentsPath
from reference.nonsmooth.stopping import LANDING, STOPPED
from reference.nonsmooth.transitions import (
    ModeTransition,
    begin,
    begin_on_rim,
    running,
    slips_or_rests,
    turning,
)
from reference.problem.effects import LINEAR
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, States
from reference.smooth.extrema import Extrema, ExtremumRecorder, Run

# Of the largest phi so far: a smaller fall or rise of phi is no half of a bounce.
SHARE_OF_BOUNCE = 0.01
# A force of the law that begins at a depth is this share of it above zero: more than its round-off.
BEGUN = 1e-14
# Of a step: contact that is lost before it asks for a shorter one.
HALF = 0.5
# Of a step: events as near as this to the end of a contact are one with it.
AS_ONE = 1e-9
# Turns of the depth after which too much work is said to be that of vibrations.
VIBRATIONS = 10
FLIGHT = Mode(slips=True, flies=True)


class VibrationFilter(ExtremumRecorder):
    """Collects the extrema of phi that stand out by `SHARE_OF_BOUNCE`.

    An extremum is reported to the base class once phi has left it by so much, or at the end.
    """

    def __init__(self, problem: Problem, fall: float) -> None:
        super().__init__(problem, fall=fall)
        self._pending: tuple[float, Snapshot, bool] | None = None
        # the highest maximum since a release that is a minimum, before phi has left either
        self._risen: tuple[float, Snapshot, bool] | None = None
        if self._extrema:
            self._pending = self._extrema.pop()
        self._largest = problem.phi

    def extremum(self, time: float, snapshot: Snapshot, *, maximum: bool) -> None:
        """Report that phi' changed sign."""
        self.advance(time, snapshot.phi)
        if self.ended():
            return
        now = (time, snapshot, maximum)
        if self._pending is None:
            self._pending = now if self._apart(snapshot.phi) else None
            return
        _, extreme, kind = self._pending
        further = snapshot.phi - extreme.phi
        if maximum == kind and (further > 0) == maximum and further:
            self._pending = now
        elif maximum and not self._extrema and further > 0:
            self._risen = now if self._risen is None else max(self._risen, now, key=_phi_of)

    def advance(self, time: float, phi: float) -> None:
        """Report that the motion is integrated up to `time`, and phi there."""
        self._largest = max(self._largest, phi)
        if self._risen is not None and self._left(self._risen, phi):
            self._pending, self._risen = self._risen, None
        if self._pending is not None and self._left(self._pending, phi):
            self._confirm()
        if not self.ended():
            super().advance(time, phi)

    def track(self) -> Extrema:
        """Sum up."""
        if self._pending is not None:
            self._confirm()
        return super().track()

    def _left(self, extremum: tuple[float, Snapshot, bool], phi: float) -> bool:
        """Return whether phi has left an extremum."""
        _, extreme, maximum = extremum
        left = extreme.phi - phi if maximum else phi - extreme.phi
        return left >= SHARE_OF_BOUNCE * self._largest

    def _apart(self, phi: float) -> bool:
        """Return whether phi stands out from the last extremum that counts."""
        last = self._extrema[-1][1].phi if self._extrema else -np.inf
        return abs(phi - last) >= SHARE_OF_BOUNCE * self._largest

    def _confirm(self) -> None:
        if self._pending is not None:
            time, extreme, maximum = self._pending
            self._pending = self._risen = None
            super().extremum(time, extreme, maximum=maximum)


def on_rigid_plane(problem: Problem) -> tuple[GeneralEquations, Floats, ModeTransition]:
    """Return the equations of the rigid contact, and how a release on it begins, shape (13,)."""
    at_a_point = replace(problem.effects, patch=0.0)
    rigid = GeneralEquations(parameters=problem.parameters, effects=at_a_point)
    return rigid, *begin_on_rim(rigid, released(problem))


def bears(now: ModeTransition) -> bool:
    """Return whether a rigid contact has one normal force, of either sign."""
    return now.ending in {None, Outcome.LIFTED}


def load_of(rigid: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the normal force of a rigid contact over m g, shape (n,)."""
    return np.asarray(rigid.contact(y, mode).force[2] / Angles.of(y[LEAN]).S)


def _phi_of(extremum: tuple[float, Snapshot, bool]) -> float:
    return extremum[1].phi


class CompliantPath(SegmentsPath):
    """A sequence of pieces in contact and in flight."""

    def _states(self, y: Floats, number: np.ndarray[tuple[int, ...], np.dtype[np.intp]]) -> States:
        states = super()._states(y, number)
        return replace(states, gap=-y[DEPTH], rise=y[RISE])


class CompliantIntegrator(HybridIntegrator):
    """Integrates one problem on a contact that gives way."""

    def __init__(self, problem: Problem, equations: CompliantEquations, *, locus: bool) -> None:
        self._law = equations
        # of a contact that bears the weight: depth, and the velocity of a vibration of that size
        self._rest = equations.law.depth_under(1.0)
        self._pace = np.sqrt(self._rest)
        super().__init__(problem, equations, locus=locus)

    def run(self) -> Run:
        """Integrate to the horizon or an ending, and no further than its last bounce."""
        run = super().run()
        path, t_end = run.path, run.track.t_end
        if not isinstance(path, SegmentsPath) or path.t_end <= t_end:
            return run
        last, c = path.place(t_end)
        pieces = [*path.pieces[:last], replace(path.pieces[last], cut=c)]
        path = self._path(pieces)
        return replace(run, path=path, phases=path.phases())

    def _released(self, problem: Problem) -> tuple[Floats, ModeTransition]:
        """Return the release: above the plane, or as deep in it as bears the rigid normal force.

        Where a rigid contact has no motion, or several, the depth is that of the weight. The rigid
        contact is at a point: a patch that turns and does not slip yet has no force along the
        plane, for the time that it takes to creep alone, and a force then as that of a point.
        """
        law = self._law
        y = np.zeros(ROWS)
        y[:RIGID_ROWS] = released(problem)
        y[DEPTH] = -problem.height
        if problem.height > 0:
            return y, ModeTransition(mode=FLIGHT)
        rigid, start, now = on_rigid_plane(problem)
        load = 1.0
        if bears(now):
            load = float(load_of(rigid, now.infinitesimal(start), now.mode)[0])
        if load <= 0:
            return y, ModeTransition(mode=FLIGHT)
        y[:RIGID_ROWS], y[DEPTH] = start, law.law.depth_under(load)
        y, mode = slips_or_rests(law, y)
        mode = replace(mode, rests=now.mode.rests and now.roll is None)
        return y, begin(law, y, self._rests(y, mode))

    def _rests(self, y: Floats, mode: Mode) -> Mode:
        """Return the mode in which all is held that is at rest."""
        return replace(mode, rests=bool(self._law.resistance and stands(y[:, None])[0]))

    def _sinks(self, lean: float, *, maximum: bool) -> None:
        """Give no more work: a contact vibrates however near to rest the can comes."""

    def _stuck(self) -> Outcome:
        outcome = super()._stuck()
        if outcome is Outcome.OUTWORKED:
            rises = np.sign([piece.start[RISE] for piece in self._pieces])
            turns = np.count_nonzero(rises[1:] * rises[:-1] < 0)
            return Outcome.VIBRATES if turns >= VIBRATIONS else outcome
        return outcome

    def _recorder(self, problem: Problem, fall: float) -> ExtremumRecorder:
        return VibrationFilter(problem, fall)

    def _path(self, pieces: list[Segment]) -> SegmentsPath:
        end = float(self._y[TIME])
        return CompliantPath(pieces, self._equations, end, locus=self._locus)

    def _sizes(self, rows: Index, core: Floats) -> Floats:
        own = np.array([self._rest, self._pace])[:, None]
        return np.concatenate(
            [sizes(rows[:-2], core[:-2], self._law.patch), np.maximum(np.abs(core[-2:]), own)]
        )

    def _tail(self, series: Floats) -> float:
        own = np.array([self._rest, self._pace])
        size = np.abs(self._y[RIGID_ROWS:]) + np.abs(series[RIGID_ROWS:]).sum(axis=1)
        tail = np.abs(series[RIGID_ROWS:, -2:]).max(axis=1) / np.maximum(size, own)
        resisted = self._equations.resistance > 0
        # the place of a rim above the plane begins at zero, and is none that need be known so well
        start = self._y[:RIGID_ROWS].copy()
        start[[X, Y]] = np.maximum(np.abs(start[[X, Y]]), QUIET)
        rigid = tail_of(start, series[:RIGID_ROWS], resisted=resisted)
        return max(rigid, float(tail.max()))

    def _step(self) -> Segment | None:
        """Take a step that does not go on for long where the plane would have to pull.

        What it is there is of no use, and how large it is says nothing of how exact it must be.
        """
        piece = super()._step()
        while piece is not None and not self._mode.flies:
            pulled = np.flatnonzero(self._law.touching(piece.looked_at(LOOKS)) < 0)
            if not pulled.size or LOOKS[pulled[0]] >= HALF or piece.length <= SHORTEST:
                break
            self._length = piece.length * LOOKS[max(pulled[0], 1)]
            piece = super()._step()
        return piece

    def _left(self) -> float:
        return LONGEST if self._mode.flies else super()._left()

    def _events(self, piece: Segment) -> list[Event]:
        met = events(
            piece,
            self._equations,
            self.watch.t_end,
            pushes=lambda seen: self._law.touching(seen.y),
        )
        lifts = [event.c for event in met if event.what is EventKind.LIFTS]
        # the limits of friction vanish with the force: what they let go with it goes with the rim
        return [
            event
            for event in met
            if event.what is EventKind.LIFTS
            or event.what not in LIMITS - OF_THE_STATE
            or not lifts
            or abs(event.c - lifts[0]) > AS_ONE
        ]

    def _switch(self, event: Event | None) -> None:
        """Change the law or end the motion, at an event."""
        if event is not None and event.what is EventKind.LIFTS and self._neither_holds_nor_leaves():
            self.watch.end(float(self._y[TIME]), Outcome.INDETERMINATE)
        elif event is not None and event.what is EventKind.LIFTS:
            self._lift()
        elif event is not None and event.what is EventKind.TOUCHES:
            self._touch()
        elif not (event is None and self._mode.flies):
            super()._switch(event)

    def _halt(self) -> None:
        """Hold a slip that has stopped but for round-off: by the impulse that takes what is left.

        Of the decelerations of a stiff contact that is not what a double of a velocity leaves.
        """
        before, slipped = self._y, self._mode.slips
        super()._halt()
        if slipped and not self._mode.slips and not self._law.patch:
            stopped = [*self._law.moments_that_hold(self._mode), SLIP_1, SLIP_2]
            self._y = self._law.landed(before, FLIGHT, stopped)

    def _go_on(self, now: ModeTransition) -> None:
        if now.ending is Outcome.LIFTED:
            self._lift()
        else:
            super()._go_on(now)

    def _lift(self) -> None:
        """Let the can fly; the elastic energy that is left in the contact is lost."""
        y = self._y.copy()
        if self._at_the_surface(y):
            y[DEPTH] = 0.0
        y[DISSIPATED] += self._law.stored(y[DEPTH])
        self._y = y
        self._length = FIRST
        self._go_on(ModeTransition(mode=FLIGHT))

    def _neither_holds_nor_leaves(self) -> bool:
        """Return whether the friction that holds a rim for ever is what takes the force from it.

        Without declared slip friction does not vanish with the normal force. Where the damper alone
        has made that zero, the end of friction may press the rim again at once: contact falls into
        ever shorter flights and impulses backwards in time, of which any sequence is a motion.
        """
        law, y = self._law.law, self._y
        if self._mode.slips or np.isfinite(self._law.mu) or self._at_the_surface(y):
            return False
        rates = self._law.rates(y[:, None], FLIGHT, along=False)[:, 0]
        pressed = law.stiffness * rates[DEPTH] if law.exponent == LINEAR else 0.0
        return bool(pressed > law.damping * rates[RISE])

    def _touch(self) -> None:
        """Begin a contact, with a force that is not below zero by its round-off."""
        y, law = self._y.copy(), self._law.law
        if law.exponent == LINEAR:
            surface = law.damping * y[RISE] / law.stiffness
            y[DEPTH] = max(surface, 0.0) * (1 + BEGUN)
        elif self._at_the_surface(y):
            y[DEPTH] = 0.0
        else:
            y[RISE] = law.stiffness / law.damping * (1 - BEGUN)
        y[DISSIPATED] -= self._law.stored(y[DEPTH])
        slips = bool(np.isfinite(self._law.mu) and np.hypot.reduce(moving(self._law, y)) > STOPPED)
        # fluid in so thin a gap stops the contact point at once
        lands = bool(self._law.fluid and y[LEAN] < LANDING)
        stopped = [*([ROLLING_1] if lands else []), *([] if slips else [SLIP_1, SLIP_2])]
        if stopped:
            y = self._law.landed(y, FLIGHT, stopped)
        mode = self._rests(y, Mode(slips=slips, lands=lands))
        self._y = y
        # the contact has its own time, which the steps of the flight say nothing of
        self._length = min(FIRST, FIRST * self._pace / float(Angles.of(y[LEAN]).S))
        margin = float(self._law.touching(y[:, None])[0])
        if margin < 0 or (margin == 0 and y[RISE] > 0):
            # the impulse that stops the rim throws it up
            self._lift()
        elif self._law.pressing(y) > 0:
            self._go_on(begin(self._law, y, mode))
        else:
            mode = turning(self._law, y[:, None], mode)
            self._go_on(ModeTransition(mode=running(self._law, y[:, None], mode)))

    def _at_the_surface(self, y: Floats) -> bool:
        """Return whether it is the depth that makes the force zero, and not the rate."""
        law = self._law.law
        if law.exponent == LINEAR:
            return law.damping == 0
        return float(y[DEPTH]) / self._rest <= 1 - law.damping / law.stiffness * float(y[RISE])
