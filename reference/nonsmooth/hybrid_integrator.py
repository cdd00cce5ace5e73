"""Integration of a can through phases of sticking and slipping, up to its horizon or ending.

The motion is smooth between switches. Each switch is computed to round-off on the polynomial of the
step that contains it (`reference.nonsmooth.events`), the step is cut there, and the next step
begins with the other law.
"""

from dataclasses import replace

import numpy as np

from reference.equations.contact_laws import Equations, Mode
from reference.equations.state_vector import (
    ALONG,
    LEAN,
    TIME,
    W2,
    Index,
    released,
    sizes,
    snapshot_of,
    tail_of,
)
from reference.nonsmooth import stopping
from reference.nonsmooth.creep import creeping, creeps, crept
from reference.nonsmooth.events import ENDINGS, EXTREMA, Event, EventKind, events
from reference.nonsmooth.level_spin import HARDLY
from reference.nonsmooth.radau_iia import (
    STAGES,
    basis,
    basis_at,
    coefficients,
    integrator,
    points,
    step,
)
from reference.nonsmooth.segments import Segment, SegmentsPath
from reference.nonsmooth.stopping import halted, left_of_roll, left_of_slip, left_to_jam
from reference.nonsmooth.transitions import (
    ModeTransition,
    begin,
    begin_on_rim,
    begin_roll,
    begin_slip,
    land,
    settled,
    straight_on,
)
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.smooth.extrema import ExtremumRecorder, Run

# Chebyshev coefficients of a step fall geometrically: the last two below this leave no error that
# the roundings of the step itself would not.
RESOLVED = 3e-14
# Some round-offs: below it they say nothing of how long the next step may be.
NOISE = 2e-15
# In sigma. Longer steps are mostly refused, which costs more than they save, unless the step before
# left nothing but round-off: beside a fall that is flat for a long time they double.
LONGEST = 8.0
FIRST = 0.05
# A step shorter than this no longer moves a double.
SHORTEST = 1e-15
# A step that cannot be taken this near to where the rim jams cannot because of that.
JAMMED = 10 * SHORTEST
# Where a slip or a rolling is about to stop a step covers this share of what is left of it.
SHARE = 0.8
# Evaluations of the equations that a motion may call for. One that friction brings to rest, in ever
# faster nutations, may again each time that phi, or its maximum, has sunk by a fifth. `cusps` with
# friction takes 170 thousand.
MOST_WORK = 200_000
FIFTH = float(np.log(1.25))
# Coefficients of a step by which the next one is guessed.
EXTRAPOLATED = 8


class HybridIntegrator:
    """Integrates one problem, from its release or from a later state, shape (13,), on the rim."""

    def __init__(
        self,
        problem: Problem,
        equations: Equations,
        *,
        locus: bool,
        start: Floats | None = None,
        watch: ExtremumRecorder | None = None,
    ) -> None:
        self._equations = equations
        self._locus = locus
        self._counts = problem.bounces is not None
        self._length = FIRST
        self._evaluations = 0
        self._pieces: list[Segment] = []
        begun = self._released(problem) if start is None else begin_on_rim(equations, start)
        self._y, now = begun
        self._begun = float(self._y[LEAN])
        self._lowest = [self._begun, self._begun]
        self._work_before = 0
        if watch is None:
            rates = equations.rates(now.infinitesimal(self._y), now.mode)[:, 0]
            watch = self._recorder(problem, -float(rates[W2] / rates[TIME]))
        self.watch = watch
        self._go_on(now)

    def _released(self, problem: Problem) -> tuple[Floats, ModeTransition]:
        return begin_on_rim(self._equations, released(problem))

    def _recorder(self, problem: Problem, fall: float) -> ExtremumRecorder:
        return ExtremumRecorder(problem, fall=fall)

    @property
    def _mode(self) -> Mode:
        return self._now.mode

    def run(self) -> Run:
        """Integrate to the horizon or an ending, and sum up."""
        path = self.follow()
        track = self.watch.track()
        peaks = None
        if np.count_nonzero(track.maximum) > 1:
            peaks = path.peaks(track.times, np.flatnonzero(track.maximum))
            if peaks is None:  # then they are looked for in the forces, those at extrema too
                track = replace(track, extrema=track.extrema.with_contact(path.at(track.times)))
        return Run(
            path=path,
            peaks=peaks,
            track=track,
            steps=len(self._pieces),
            evaluations=self._evaluations,
            phases=path.phases(),
        )

    @property
    def reached(self) -> tuple[Floats, int]:
        """Return the state that is reached, shape (13,), and the evaluations that it took."""
        return self._y, self._evaluations

    def follow(self) -> SegmentsPath:
        """Integrate to the horizon or an ending."""
        while not self.watch.ended():
            self._sinks(float(self._y[LEAN]), maximum=False)
            if self._march():
                continue
            piece = self._step()
            if piece is None:
                self.watch.end(float(self._y[TIME]), self._stuck())
                break
            self._see(piece, self._events(piece))
        return self._path(self._pieces or [self._standing()])

    def _path(self, pieces: list[Segment]) -> SegmentsPath:
        end = float(self._y[TIME])
        return SegmentsPath(pieces, self._equations, end, locus=self._locus)

    def _stuck(self) -> Outcome:
        """Return why there is no next step."""
        if stopping.comes_to_rest(self._equations, self._y) or self._nearly_rests(self._y):
            return Outcome.CAME_TO_REST
        if self._evaluations > self._most_work():
            return Outcome.OUTWORKED
        jams = self._pieces and left_to_jam(self._equations, self._pieces[-1]) < JAMMED
        return Outcome.JAMMED if jams else Outcome.STALLED

    def _sinks(self, lean: float, *, maximum: bool) -> None:
        """Give a motion that friction brings to rest more work if it, or its maxima, have sunk."""
        if stopping.slows_turning(self._equations) and lean < self._lowest[maximum] - FIFTH:
            self._lowest[maximum], self._work_before = lean, self._evaluations

    def _nearly_rests(self, y: Floats) -> bool:
        return stopping.nearly_rests(self._equations, y, self._begun)

    def _step(self) -> Segment | None:
        """Take the longest step that is resolved, unless too much has been spent."""
        length = min(self._length, self._left())
        rows, most = self._equations.core(self._mode), self._most_work()
        while length > SHORTEST and self._evaluations <= most:
            taken = step(
                lambda core: self._rates(core, rows)[rows],
                self._y[rows],
                length,
                self._guess(length)[rows],
                lambda core: self._sizes(rows, core),
            )
            self._evaluations += taken.evaluations * STAGES
            if taken.change is None or not self._sets_out(taken.change[:, 0], rows):
                length /= 4
                continue
            series = self._completed(taken.change, rows, length)
            tail = self._tail(series)
            if tail > RESOLVED:
                length *= max(0.2, 0.8 * (RESOLVED / tail) ** (1 / STAGES))
                continue
            return self._taken(series, length, tail)
        return None

    def _sizes(self, rows: Index, core: Floats) -> Floats:
        """Return the size of each entry of the core, shape (rows, n)."""
        return sizes(rows, core, self._equations.patch)

    def _taken(self, series: Floats, length: float, tail: float) -> Segment:
        """Return a step that is resolved, and choose the length of the next."""
        # a tail of round-off says only that more is to be had
        grown = 0.9 * length * (RESOLVED / max(tail, NOISE)) ** (1 / STAGES)
        self._length = (
            2.0 * length
            if tail < NOISE
            else min(grown, LONGEST * stopping.pace(self._equations, self._y))
        )
        return Segment(start=self._y, coefficients=series, cut=1.0, length=length, mode=self._mode)

    def _most_work(self) -> int:
        """Return at how many evaluations the motion is given up."""
        return self._work_before + MOST_WORK

    def _march(self) -> bool:
        """Take steps all at once, where there is a way; return whether any was taken."""
        return False

    def _sets_out(self, change: Floats, rows: Index) -> bool:
        """Return whether what begins keeps its direction up to the first point of a step."""
        y = self._y.copy()
        y[rows] += change
        return self._now.keeps_direction(self._equations, y)

    def _left(self) -> float:
        """Return the longest step that does not pass the end of a slip or of a rolling."""
        if self._now.at_once:
            return LONGEST
        here = self._equations, self._y, self._mode
        stops = SHARE * min(left_of_slip(*here), left_of_roll(*here))
        return min(stops, stopping.left_of_fall(*here[:2]))

    def _rates(self, core: Floats, rows: Index) -> Floats:
        full = np.repeat(self._y[:, None], core.shape[1], axis=1).astype(core.dtype)
        full[rows] = core
        return self._equations.rates(full, self._mode, along=False)

    def _completed(self, core: Floats, rows: Index, length: float) -> Floats:
        """Return coefficients of all rows: the core, the quadratures of angles, the others.

        Only the place of the contact needs the angles before it; it and the works are left out
        where the contact locus is not asked for.
        """
        change = np.zeros((self._y.size, STAGES))
        change[rows] = core
        done = set(rows.tolist()) | (set() if self._locus else ALONG)
        others = [row for row in range(self._y.size) if row not in done]
        for _ in range(2 if self._locus else 1):
            y = self._y[:, None] + change
            rates = self._equations.rates(y, self._mode, along=self._locus)
            change[others] = length * rates[others] @ integrator().T
        return coefficients(change)

    def _tail(self, series: Floats) -> float:
        """Return the size of the last two coefficients of a step."""
        return tail_of(self._y, series, resisted=self._equations.resistance > 0)

    def _guess(self, length: float) -> Floats:
        """Return a guess of the change in a step: the last step continued, or linear in time."""
        c = length * points()
        last = self._pieces[-1] if self._pieces else None
        now = self._now
        if not now.at_once and last is not None and last.mode == now.mode:
            # on along the last step, as far as its polynomial means anything beyond its end
            head = last.coefficients[:, :EXTRAPOLATED]
            ahead = basis(last.cut + c / last.length)[:, :EXTRAPOLATED]
            here = (basis_at((1.0,)) if last.cut == 1.0 else basis(np.array([last.cut])))[
                :, :EXTRAPOLATED
            ]
            return np.asarray(head @ (ahead - here).T)
        return straight_on(self._equations, self._y, now, c)

    def _see(self, piece: Segment, met: list[Event]) -> None:
        """Report a step up to its first event, and continue from there."""
        cut, ending = 1.0, None
        for event in met:
            if event.what in EXTREMA:
                y = self._state_at(piece, event.c)
                maximum = event.what is EventKind.MAXIMUM
                self._report(y, maximum=maximum)
                if maximum and not self._equations.resistance and self._nearly_rests(y):
                    self.watch.end(float(y[TIME]), Outcome.CAME_TO_REST)
            else:
                ending = event
            if ending is not None or self.watch.ended():
                cut = event.c
                break
        if cut != 1.0:
            piece = replace(piece, cut=cut)
        self._pieces.append(piece)
        self._y, self._now = self._end(piece), ModeTransition(mode=self._mode)
        if self.watch.ended():
            return
        self._switch(ending)
        if self._counts and not self.watch.ended():
            phi = float(2 * np.arctan(np.exp(self._y[LEAN])))
            self.watch.advance(float(self._y[TIME]), phi)

    def _report(self, y: Floats, *, maximum: bool) -> None:
        if maximum:
            self._sinks(float(y[LEAN]), maximum=True)
        self.watch.extremum(float(y[TIME]), snapshot_of(y), maximum=maximum)

    def _events(self, piece: Segment) -> list[Event]:
        return events(piece, self._equations, self.watch.t_end)

    def _end(self, piece: Segment) -> Floats:
        """Return the state, shape (13,), at the cut of a step."""
        return piece.end

    def _state_at(self, piece: Segment, c: float) -> Floats:
        """Return the state, shape (13,), at one place of a step."""
        return piece.at(np.array([c]))[:, 0]

    def _switch(self, event: Event | None) -> None:
        """Change the law or end the motion, at an event."""
        if event is not None and self._mode.creeps:
            self._y = crept(self._equations, self._y, self._mode, event.what)
            if event.what is EventKind.FLAT:
                self._pieces.append(self._standing())
            self._now = ModeTransition(mode=replace(self._mode, creeps=False))
        if event is not None and event.what in ENDINGS:
            self.watch.end(float(self._y[TIME]), ENDINGS[event.what])
        elif event is not None and event.what is EventKind.SLIPS and self._nearly_rests(self._y):
            self.watch.end(float(self._y[TIME]), Outcome.CAME_TO_REST)
        elif event is not None and event.what is EventKind.SLIPS:
            now = begin_slip(self._equations, self._y, self._now)
            self._go_on(settled(self._equations, self._y, now))
        elif event is not None and event.what is EventKind.ROLLS:
            now = begin_roll(self._equations, self._y, self._now)
            self._go_on(settled(self._equations, self._y, now))
            self._turned(before=0.0)
        elif event is not None and event.what is EventKind.LANDS:
            self._y, now = land(self._equations, self._y, self._mode)
            self._go_on(now)
        elif event is not None and event.what is EventKind.LEAVES:
            self._go_on(begin(self._equations, self._y, replace(self._mode, lands=False)))
        elif event is not None:
            self._go_on(begin(self._equations, self._y, self._mode, event.what))
        else:
            self._halt()

    def _halt(self) -> None:
        """Hold a slip or rolling that has stopped but for round-off, if friction can hold it."""
        before = float(self._y[W2])
        self._y, mode = halted(self._equations, self._y, self._mode)
        if mode.rests and stopping.comes_to_rest(self._equations, self._y):
            self.watch.end(float(self._y[TIME]), Outcome.CAME_TO_REST)
        elif mode != self._mode:
            rests = mode.rests and not self._mode.rests
            # the steps of what stops are as short as what is left of it, not the next's
            self._length = FIRST * stopping.pace(self._equations, self._y)
            self._go_on(begin(self._equations, self._y, mode))
            if rests:
                self._turned(before=before)
        elif mode.creeps and before <= 0.0:
            # g - S N dies out in a fall alone
            self._y = crept(self._equations, self._y, mode, None)
            self._go_on(begin(self._equations, self._y, replace(mode, creeps=False)))
        elif not mode.creeps and creeps(self._equations, self._y, mode):
            self._y = creeping(self._equations, self._y, mode)
            self._go_on(ModeTransition(mode=replace(mode, creeps=True)))

    def _turned(self, *, before: float) -> None:
        """Report an extremum where phi comes to rest, or begins to move."""
        roll = self._now.roll
        after = 0.0 if roll is None else float(np.sin(roll.angle))
        if not self.watch.ended() and np.sign(before) != np.sign(after):
            maximum = before < 0 or (before == 0 and after > 0)
            self._report(self._y, maximum=maximum)

    def _go_on(self, now: ModeTransition) -> None:
        """Continue with a transition, or end the motion."""
        self._now = now
        if now.at_once:
            self._length = min(self._length, FIRST * stopping.pace(self._equations, self._y))
        if now.ending is not None:
            self.watch.end(float(self._y[TIME]), now.ending)

    def _standing(self) -> Segment:
        series = np.zeros((self._y.size, STAGES + 1))
        # what begins has its direction, though there is no step
        if self._now.at_once:
            series[:, 1] = HARDLY * self._guess(1.0)[:, -1]
        return Segment(start=self._y, coefficients=series, cut=1.0, length=0.0, mode=self._mode)
