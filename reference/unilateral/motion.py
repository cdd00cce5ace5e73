"""The motion of a can whose contact is unilateral: rolling, sliding, flight, impact, and rest.

On the rim it follows the equations of `reference.nonsmooth`; where the normal force falls to zero
it flies (`reference.unilateral.flight`), and where a rim meets the plane an impact
(`reference.unilateral.impact`) decides how it goes on. Of an infinite sequence of impacts
(`reference.unilateral.zeno`) the rest is one impact without restitution and the motion on the rim
after it, which differ from the sequence by the square of its time: round-off.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from reference.equations.compiled_equations import IMPACTS, CompiledEquations
from reference.equations.contact_laws import Equations, Impact, Kind, Phase
from reference.equations.coulomb import CoulombEquations
from reference.equations.frames import to_body
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    SLIP,
    TIME,
    TURN,
    U2,
    W1,
    W2,
    W3,
    Angles,
    released,
    snapshot_of,
)
from reference.nonsmooth.hybrid_integrator import MOST_WORK, HybridIntegrator
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.effects import Restitution
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.smooth.extrema import SHARE_OF_BOUNCE, ExtremumRecorder, Run
from reference.unilateral.flight import Flight, fall_of
from reference.unilateral.free_body import (
    Body,
    at_lowest,
    launch_of,
    moves_in_a_plane,
    on_rim,
    rises_of_face,
    rising,
)
from reference.unilateral.impact import Collision, collide
from reference.unilateral.impact_process import push
from reference.unilateral.infinite_friction import (
    HeldEquations,
    HeldIntegrator,
    How,
    SlidingEquations,
    SlidingIntegrator,
    without_normal_force,
)
from reference.unilateral.next_contact import NODES, next_contact
from reference.unilateral.path import FlightPath, UnilateralPath
from reference.unilateral.zeno import (
    ENDLESS,
    ENDLESS_ROCKING,
    STILL,
    acceleration,
    end_of_bounces,
    left_of_rocking,
    lies_flat,
)

# In g: more than the round-off of an acceleration.
FALLS = 1e-6
# Of a mobility along the normal: below it a rim jams, also by what rounds it.
JAMMED = 1e-4
# What lies on its face and slides or turns no faster is at rest, as exact as its rattling is.
SLIDES = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Onward:
    """How a can goes on.

    Attributes
    ----------
    y : ndarray, shape (13,)
        State of the rim.
    rise : float
        How fast the rim rises from the plane; zero of one that stays.
    how : How or None
        How a rim goes on that can neither stick nor leave the plane.
    """

    y: Floats
    rise: float = 0.0
    how: How | None = None


JAMS = frozenset({Outcome.JAMMED, Outcome.INCONSISTENT})


@dataclass(slots=True, eq=False)
class UnilateralMotion:
    """Follows one problem from its release to its horizon or ending.

    Attributes
    ----------
    problem : Problem
    compiled : bool
        Whether compiled code integrates the motion on the rim: as asked for, but for a law that no
        kernel carries, and for a can that slides in a plane.
    impacts : list of Impact
        So far.
    """

    problem: Problem
    compiled: bool = False
    impacts: list[Impact] = field(default_factory=list)
    _parts: list[SegmentsPath | FlightPath] = field(default_factory=list)
    _starts: list[float] = field(default_factory=list)
    _phases: list[Phase] = field(default_factory=list)
    _evaluations: int = 0
    _slides_from: float = -np.inf
    _steps: int = 0
    _watch: ExtremumRecorder = field(init=False)
    _body: Body = field(init=False)
    _general: GeneralEquations = field(init=False)
    _sliding: SlidingEquations = field(init=False)
    _equations: Equations = field(init=False)
    _law: Restitution = field(init=False)
    _planar: bool = field(init=False)

    def __post_init__(self) -> None:
        """Choose the equations of the rim."""
        p, e = self.problem.parameters, self.problem.effects
        self._planar = moves_in_a_plane(self.problem)
        self._law = e.restitution or Restitution(coefficient=0.0)
        self._body = Body.of(p, e)
        self._general = GeneralEquations(parameters=p, effects=e)
        self._sliding = SlidingEquations(parameters=p, effects=without_normal_force(e))
        plain: Equations = self._general
        if set(e.declared()) <= {"slip", "restitution"}:
            mu = np.inf if e.mu is None else e.mu
            plain = CoulombEquations(parameters=p, mu=mu, only_pushes=True, static=e.mu_static)
        # compiled sums of the general can leave a slip in the plane a round-off beside it
        leaves = self._planar and bool(e.mu)
        known = CompiledEquations.know(e, but=IMPACTS)
        self.compiled = self.compiled and known and not leaves
        self._equations = CompiledEquations.of(plain, self.problem) if self.compiled else plain

    def run(self) -> Run:
        """Follow the motion, and sum up."""
        y = released(self.problem)
        if self.problem.height > 0:
            fall = fall_of(self._body, y, self.problem.psi_dot)
            self._watch = ExtremumRecorder(self.problem, fall=fall)
            arrived = self._fly(y, 0.0, gap=self.problem.height)
        else:
            arrived = self._roll(y, new=True)
        while not self._watch.ended() and arrived is not None:
            y, rise = arrived.y, arrived.rise
            if self._evaluations > MOST_WORK:
                self._watch.end(float(y[TIME]), Outcome.OUTWORKED)
                break
            arrived = self._fly(y, rise) if rise > 0.0 else self._roll(y, how=arrived.how)
        path = UnilateralPath(self._parts, self._starts)
        track = self._watch.track()
        there = path.at(track.times)
        extrema = replace(
            track.extrema,
            x=there.x,
            y=there.y,
            slip=there.slip,
            force=there.force,
            gap=there.gap,
            rise=there.rise,
        )
        return Run(
            path=path,
            track=replace(track, extrema=extrema),
            steps=self._steps,
            evaluations=self._evaluations,
            phases=tuple(self._phases),
            impacts=tuple(self.impacts),
        )

    def _add(self, part: SegmentsPath | FlightPath, start: float, phases: Sequence[Phase]) -> None:
        """Append a part of the path."""
        self._parts.append(part)
        self._starts.append(start)
        for phase in phases:
            if self._phases and self._phases[-1].kind is phase.kind:
                self._phases[-1] = replace(self._phases[-1], end=phase.end)
            else:
                self._phases.append(phase)

    def _roll(self, y: Floats, *, new: bool = False, how: How | None = None) -> Onward | None:
        """Follow the rim on the plane; return how it goes on after what ends that, if it does.

        Parameters
        ----------
        y : ndarray, shape (13,)
        new : bool
            Whether this is the release.
        how : How, optional
            How a rim that never slips goes on that can neither stick nor leave the plane.
        """
        if np.isinf(self._equations.mu) and y[SLIP].any():
            how = How.SLIDES
        integrator = self._integrator(y, None if new else self._watch, how)
        path = integrator.follow()
        self._watch = integrator.watch
        state, evaluations = integrator.reached
        self._evaluations += evaluations + 1
        self._steps += len(path.pieces)
        self._add(path, float(y[TIME]), path.phases())
        y, outcome = state, self._watch.outcome
        if outcome is Outcome.LIFTED:
            self._watch.go_on()
            # a slide under infinite friction that has stopped is held, if that takes no pull
            stops = how is How.SLIDES and not y[SLIP].any()
            return Onward(y) if stops else self._lift(y, how)
        if outcome is Outcome.FELL_FLAT:
            self._watch.go_on()
            return self._land_flat(y)
        if outcome in JAMS and y[SLIP].any() and self._jams(y):
            self._watch.go_on()
            return self._hit(y, 0.0, jams=True)
        return None

    def _integrator(
        self, start: Floats, watch: ExtremumRecorder | None, how: How | None
    ) -> HybridIntegrator:
        """Return what follows the rim on the plane from a state."""
        problem, own = self.problem, self._equations
        if how is How.SLIDES:
            return SlidingIntegrator(problem, self._sliding, locus=True, start=start, watch=watch)
        if how is How.HELD:
            held = HeldEquations(parameters=problem.parameters, effects=problem.effects)
            return HeldIntegrator(problem, held, locus=True, start=start, watch=watch)
        if isinstance(own, CompiledEquations):
            from reference.nonsmooth.compiled_integrator import CompiledIntegrator

            return CompiledIntegrator(problem, own, locus=True, start=start, watch=watch)
        return HybridIntegrator(problem, own, locus=True, start=start, watch=watch)

    def _lift(self, y: Floats, how: How | None) -> Onward | None:
        """Leave the plane, or slide on it where the free rim would fall into it."""
        held, time = np.isinf(self._equations.mu) and not y[SLIP].any(), float(y[TIME])
        falls = acceleration(self._body, y, 0.0)
        if held and falls < -STILL * 1e3 and (how is not None or time != self._slides_from):
            self._slides_from = time if how is How.HELD else self._slides_from
            return Onward(y, how=How.HELD if how is None else How.SLIDES)
        if self._general.fluid and falls < -FALLS:
            # a moment that only a rim on the plane has keeps it from falling into the plane
            self._watch.end(time, Outcome.INCONSISTENT)
            return None
        return self._fly(y, 0.0, lifted=True)

    def _fly(
        self, y: Floats, rise: float, *, gap: float = 0.0, lifted: bool = False
    ) -> Onward | None:
        """Follow a flight to its landing; return how the can goes on."""
        launch = launch_of(y, self._body, rise=rise, gap=gap)
        flight = Flight(self._body, launch)
        most = self._watch.t_end - launch.time
        met = next_contact(flight, most, lifted=lifted)
        duration = most if met is None else met.after
        path = FlightPath(flight, duration, locus=True)
        cut = self._extrema(path)
        if cut is not None:
            path = FlightPath(flight, cut, locus=True)
        self._evaluations += NODES * (1 + int(path.duration * flight.rates()))
        self._steps += 1
        self._add(path, launch.time, [Phase(kind=Kind.FLIGHT, start=launch.time, end=path.t_end)])
        if met is None:
            self._watch.end(path.t_end, Outcome.FINISHED)
        elif not met.lower:
            self._watch.end(path.t_end, Outcome.OVERTURNED)
        self._watch.advance(path.t_end, path.snapshot(path.duration).phi)
        if self._watch.ended():
            return None
        landing = path.landing()
        there = on_rim(landing, self._body)
        if self._planar:
            there[[W1, W3, U2]] = 0.0
        return self._hit(there, min(rising(landing, self._body), 0.0))

    def _extrema(self, path: FlightPath) -> float | None:
        """Report the extrema of phi in a flight; return when the motion ends at one."""
        for after, maximum in path.extrema():
            self._watch.extremum(path.start + after, path.snapshot(after), maximum=maximum)
            if self._watch.ended():
                return after
        return None

    def _struck(
        self, y: Floats, rise: float, e: float, *, jams: bool = False
    ) -> tuple[Floats, Collision]:
        """Return a state after an impact, and the impact."""
        D = self._general.mobility(y)
        before = np.array([*y[SLIP], rise])
        mu = self._equations.mu
        struck = collide(D[3:, 3:], before, mu, e, self._law.law, jams=jams)
        after = y.copy()
        after[TURN] += to_body(D[:3, 3:] @ struck.impulse, Angles.of(y[LEAN]))
        after[SLIP] = struck.velocity[:2]
        after[DISSIPATED] += struck.energy_lost
        if self._planar:
            # round-off would turn the can, whose axis then passes the vertical instead of falling
            # flat
            after[[W1, W3, U2]] = 0.0
        return after, struck

    def _jams(self, y: Floats) -> bool:
        """Return whether it is friction that drives a sliding rim into the plane.

        Moments in proportion to the normal force do so, too, but give no impulse.
        """
        D, ahead = self._general.mobility(y)[5, 3:], y[SLIP] / np.hypot(*y[SLIP])
        return bool(D @ push(self._equations.mu, *ahead.tolist()) < JAMMED)

    def _hit(self, y: Floats, rise: float, *, jams: bool = False) -> Onward | None:
        """Take an impact of the lower rim, and return how the can goes on after it."""
        if rise == 0.0 and not jams:
            return Onward(y)
        after, struck = self._struck(y, rise, self._law.coefficient, jams=jams)
        ends = None if jams else end_of_bounces(self._body, after, rise, float(struck.velocity[2]))
        if ends is not None:
            after, struck = self._struck(y, rise, 0.0)
        self._record(y, rise, struck, ends)
        self._turned(y, after)
        up = float(struck.velocity[2])
        if self._watch.ended():
            return None
        if lies_flat(after, up):
            self._rest(after, 2 * abs(rise))
            return None
        return Onward(after, up if up > STILL * abs(rise) else 0.0)

    def _record(self, y: Floats, rise: float, struck: Collision, ends: float | None = None) -> None:
        """Append an impact to those of the motion, in which extrema now have to stand out."""
        self._watch.share = SHARE_OF_BOUNCE
        up = float(struck.velocity[2])
        self.impacts.append(
            Impact(
                time=float(y[TIME]),
                normal_impulse=float(struck.impulse[2]),
                restitution=-up / rise if rise < 0 else 0.0,
                energy_lost=struck.energy_lost,
                law=struck.law,
                made_energy=struck.made_energy,
                ends_at=ends,
            )
        )

    def _turned(self, before: Floats, after: Floats) -> None:
        """Report an extremum of phi at an impact."""
        one, other = float(before[W2]), float(after[W2])
        if one * other < 0:
            self._watch.extremum(float(after[TIME]), snapshot_of(after), maximum=one < 0)

    def _land_flat(self, y: Floats) -> Onward | None:
        """Take the impacts of a can that meets the plane with its whole face.

        The point of the rim that falls fastest hits first. Where this drives another point into the
        plane, that is hit in turn, and so on; the limit of these impacts, all at one instant, is
        the state from which the can goes on.
        """
        rise, before = 0.0, y
        there, fastest = rises_of_face(y, rise, self._body)
        falling = abs(there)
        while there < -STILL * falling:
            y = at_lowest(y, self._body)
            after, struck = self._struck(y, there, self._law.coefficient)
            self._record(y, there, struck)
            y, rise = after, float(struck.velocity[2])
            there, fastest = rises_of_face(y, rise, self._body)
        self._watch.extremum(float(y[TIME]), snapshot_of(before), maximum=False)
        if self._watch.ended():
            return None
        y = at_lowest(y, self._body)
        slides = np.isinf(self._equations.mu) and y[SLIP].any()
        rim = self._sliding if slides else self._general
        left = left_of_rocking(rim, y, there, fastest, falling)
        if there > STILL * falling and lies_flat(y, fastest):
            self._rest(y, left if left < np.inf else 0.0)
            return None
        rolls = there <= STILL * falling and not y[SLIP].any() and not before[SLIP].any()
        if left < (ENDLESS_ROCKING if rolls else ENDLESS):
            self._rest(y, left)
            return None
        return Onward(y, there if there > STILL * falling else 0.0)

    def _rest(self, y: Floats, left: float) -> None:
        """End a motion that lies flat: at rest, unless it slides or turns on its face."""
        moves = max(float(np.abs(y[SLIP]).max()), abs(float(y[W3]))) > SLIDES
        outcome = Outcome.FELL_FLAT if moves else Outcome.CAME_TO_REST
        self._watch.end(min(float(y[TIME]) + left, self._watch.t_end), outcome)
