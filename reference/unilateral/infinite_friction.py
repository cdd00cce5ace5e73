"""Sliding under infinite friction: the limit of Coulomb's law as its coefficient grows.

Without declared slip friction is infinite: it holds the rim with any force in the plane, be the
normal force as small as it will. Where holding the rim would take a normal force below zero, and
the free rim would fall into the plane, the rim can neither stick nor fly. For every finite
coefficient mu it slides there, in a direction e, with

    F = -P e,    N = P/mu,    a(e) = s - P (D_tt e - D_tz/mu),    0 = n - P (D_zt e - D_zz/mu)

(`reference.nonsmooth.slip_onset`), and this has the limit N = 0 and P = n/(D_zt e): a friction that
keeps the rim out of the plane all by itself, where it slides so that friction lifts it. Motions
differ by a first order of 1/mu. On the edge, N = 0 of the rim that is held, the direction has no
length: the rim is held a little beyond it, as it is beyond the edge of every cone. Here P takes the
place of N where laws of the contact ask whether the plane pushes, and -D_zt e that of the normal
mobility. Moments that are proportional to the normal force are none.
"""

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from reference.equations.contact_laws import Contact, Mode
from reference.equations.frames import length
from reference.equations.newton_euler import NORMAL, SLIP_1, SLIP_2, GeneralEquations
from reference.equations.state_vector import SLIP, TIME, U1, U2
from reference.nonsmooth.events import Event, EventKind
from reference.nonsmooth.hybrid_integrator import HybridIntegrator
from reference.nonsmooth.segments import Segment, SegmentsPath
from reference.nonsmooth.slip_onset import BEYOND
from reference.nonsmooth.stopping import halted
from reference.problem.effects import Effects
from reference.problem.outcome import Outcome
from reference.problem.states import Floats, States

# A slip where P changes its sign: the roots of events are exact to the round-off of a step.
PASSED = 1e-12


class How(Enum):
    """How a rim goes on that can neither stick nor leave the plane."""

    HELD = "held a little longer"
    SLIDES = "slides without a normal force"


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingEquations(GeneralEquations):
    """The vector field of a rim that slides under infinite friction."""

    @property
    def mu(self) -> float:
        """None: this rim never sticks."""
        return 0.0

    @property
    def mu_static(self) -> float:
        """None: this rim never sticks."""
        return 0.0

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return the contact, with the size P of its friction in the place of a normal force."""
        found = GeneralEquations.contact(self, y, mode)
        if not mode.slips:
            return found
        along = (found.force[0] * y[U1] + found.force[1] * y[U2]) / length(y[U1], y[U2])
        return replace(found, force=np.array([found.force[0], found.force[1], -along]))

    def _law(self, y: Floats, mode: Mode, motion: Floats | None = None) -> Floats:
        """Return the force of a unit of friction; of a normal force where the rim is held."""
        law = super(SlidingEquations, self)._law(y, mode, motion)
        if mode.slips:
            law[[SLIP_1, SLIP_2]] = -y[[U1, U2]] / length(y[U1], y[U2])
            law[NORMAL] = 0.0
        return law


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldEquations(GeneralEquations):
    """The vector field of a rim held up to `BEYOND` its friction below a normal force of zero."""

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return the contact, with that much added to its normal force."""
        found = GeneralEquations.contact(self, y, mode)
        ahead, aside, up = found.force
        return replace(found, force=np.array([ahead, aside, up + BEYOND * length(ahead, aside)]))


def without_normal_force(effects: Effects) -> Effects:
    """Return the effects that a contact without a normal force has."""
    return replace(effects, drilling=0.0, rolling_resistance=0.0, contour=0.0)


class _SlidingPath(SegmentsPath):
    """A path on which the plane only rubs."""

    def _begun(
        self, y: Floats, number: np.ndarray[tuple[int, ...], np.dtype[np.intp]], mode: Mode
    ) -> Floats:
        """Return states in which a slip that has stopped has the direction of its last step."""
        y = super()._begun(y, number, mode)
        before = self._starts[number][:, SLIP].T
        stopped = (np.hypot(y[U1], y[U2]) < PASSED) & (np.hypot(*before) > 0)
        if stopped.any():
            y = y.copy()
            y[np.ix_(SLIP, stopped)] = before[:, stopped]
        return y

    def _states(self, y: Floats, number: np.ndarray[tuple[int, ...], np.dtype[np.intp]]) -> States:
        states = super()._states(y, number)
        if states.force is not None:
            states.force[:, 2] = 0.0
        return states


class _HeldPath(SegmentsPath):
    """A path whose normal force has a share of the friction added to it."""

    def _states(self, y: Floats, number: np.ndarray[tuple[int, ...], np.dtype[np.intp]]) -> States:
        states = super()._states(y, number)
        if states.force is not None:
            added = BEYOND * np.hypot(states.force[:, 0], states.force[:, 1])
            states.force[:, 2] = np.maximum(states.force[:, 2] - added, 0.0)
        return states


class HeldIntegrator(HybridIntegrator):
    """Integrates a rim that is held a little beyond a normal force of zero."""

    def _path(self, pieces: list[Segment]) -> SegmentsPath:
        end = float(self._y[TIME])
        return _HeldPath(pieces, self._equations, end, locus=self._locus)


class SlidingIntegrator(HybridIntegrator):
    """Integrates a slide under infinite friction until it stops, jams, or its friction is none."""

    def _path(self, pieces: list[Segment]) -> SegmentsPath:
        end = float(self._y[TIME])
        return _SlidingPath(pieces, self._equations, end, locus=self._locus)

    def _halt(self) -> None:
        """End the slide where it has stopped: what holds the rim then is for the caller to ask."""
        self._y, mode = halted(self._equations, self._y, self._mode)
        if not mode.slips:
            self.watch.end(float(self._y[TIME]), Outcome.LIFTED)

    def _switch(self, event: Event | None) -> None:
        """End the slide also where a step has passed its stop.

        The friction -P e is the same of e and of -e, so that a step does not notice the stop; P and
        the mobility change their signs there.
        """
        over = event is not None and event.what in {EventKind.JAMS, EventKind.LIFTS}
        if over and np.hypot(*self._y[SLIP]) < PASSED:
            self._y = self._y.copy()
            self._y[SLIP] = 0.0
            self.watch.end(float(self._y[TIME]), Outcome.LIFTED)
        else:
            super()._switch(event)
