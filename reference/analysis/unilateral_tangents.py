"""Motions through flights and impacts, in the pieces along which disturbances are followed.

A rim on the plane has pieces already. A flight, of which the closed form is known, is integrated in
pieces as well, by the equations of a contact that does not push, with the height of the rim above
the plane and its rate as two rows more: its disturbances then obey the same equations as all
others.

An impact is an algebraic change of the state (`reference.unilateral.impact`) whose way through
sticking and sliding has branches. Along a direction it is differentiated by extrapolated
differences (Richardson), central ones or at the bound of a coefficient those of one side, and
refused beside a branch.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import scipy

from reference.analysis.linearisation import STEP, UndecidedError
from reference.compliant.equations import DEPTH, RISE, ROWS, CompliantEquations
from reference.compliant.integrator import FLIGHT
from reference.equations.contact_laws import Mode
from reference.equations.frames import to_body
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import LEAN, SLIP, TIME, TURN, Angles, Index
from reference.equations.state_vector import ROWS as RIGID_ROWS
from reference.nonsmooth.radau_iia import STAGES, basis, coefficients, step
from reference.nonsmooth.segments import Segment, SegmentsPath
from reference.problem.effects import Compliance
from reference.problem.states import Floats
from reference.solution import Solution
from reference.unilateral.free_body import on_rim
from reference.unilateral.impact import collide
from reference.unilateral.infinite_friction import HeldEquations, SlidingEquations
from reference.unilateral.path import FlightPath, UnilateralPath

# Of a contact in flight, which asks nothing of it.
_NONE = Compliance(stiffness=1.0)
# Last coefficients of a step, over the size of the state.
TAIL = 1e-15
MOST_STEPS = 1000
# Steps of differences of impacts, over what they change: no smaller ones than the last.
STEPS = (1e-2, 1e-3, 1e-4)
# By which two extrapolations agree where no branch is near, over the size of the velocities.
AGREE = 1e-8
ImpactKind: TypeAlias = tuple[str, bool]
"""Of an impact: its law, and whether the rim slips after it."""
BRANCH = "an impact is beside one of another kind"
FACE = "the can lands on its face, jams, or slides without a normal force"
VERTICAL = "the axis of the flying can passes the vertical"


@dataclass(frozen=True, slots=True, kw_only=True)
class UnilateralEquations(GeneralEquations):
    """The vector fields of a can on the plane and above it, with rows of depth and rise.

    On the plane these two are zero.
    """

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on, in flight the depth and its rate the last."""
        rows = GeneralEquations.core(self, mode)
        return np.append(rows, [DEPTH, RISE]) if mode.flies else rows

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (15, n)."""
        if mode.flies:
            air = CompliantEquations(parameters=self.parameters, effects=self.effects, law=_NONE)
            return air.rates(y, mode, along=along)
        out = np.zeros_like(y)
        out[:RIGID_ROWS] = GeneralEquations.rates(self, y[:RIGID_ROWS], mode, along=along)
        return out

    def touching(self, y: Floats, mode: Mode) -> Floats:
        """Return the margin that is zero where the rim leaves the plane, or meets it, shape (n,).

        Of a rim on the plane the normal force, of a flying one its depth.
        """
        return np.asarray(y[DEPTH] if mode.flies else self.contact(y, mode).force[2])

    def struck(self, y: Floats, *, flies: bool) -> Floats:
        """Return a state, shape (15,), after an impact, complex as it may be before.

        Parameters
        ----------
        y : ndarray, shape (15,)
        flies : bool
            Whether the rim leaves the plane again: an impact that ends an infinite sequence gives
            nothing back, whatever is declared.
        """
        law, D = self.effects.restitution, self.mobility(y)
        assert law is not None  # noqa: S101 - without it there is no impact
        before = np.array([*y[SLIP], y[RISE]])
        e = law.coefficient if flies else 0.0
        impulse, velocity = _collided(D[3:, 3:], before, self.mu, e, law.law)
        out = y.copy()
        out[TURN] += to_body(D[:3, 3:] @ impulse, Angles.of(y[LEAN]))
        out[SLIP], out[RISE] = velocity[:2], velocity[2] if flies else 0.0
        return out


def _collided(D: Floats, u: Floats, mu: float, e: float, law: str) -> tuple[Floats, Floats]:
    """Return impulse and velocity after an impact, with the imaginary parts of its numbers.

    Raises
    ------
    UndecidedError
        If an impact of other numbers, however near, is of another kind.
    """
    given = np.array([*D.ravel(), *u, *([] if np.isinf(mu) else [mu]), e])
    at, along = given.real, given.imag / STEP
    # how much each may change at most: the normal velocity stays one of an impact
    level, normal = np.abs(u[:2]).max(), np.abs(u[2])
    sizes = np.array([*np.full(9, np.abs(D).max()), *np.full(2, level + normal), normal, *at[12:]])
    relative = np.abs(along) / np.where(sizes > 0, np.abs(sizes), 1.0)

    def outcome(values: Floats) -> tuple[Floats, ImpactKind]:
        own_mu = np.inf if np.isinf(mu) else float(values[12])
        hit = collide(values[:9].reshape(3, 3), values[9:12], own_mu, float(values[-1]), law)
        found = np.concatenate([hit.impulse, hit.velocity])
        return found, (hit.law, bool(hit.velocity[:2].any()))

    value, kind = outcome(at)
    largest = float(relative.max())
    if largest == 0.0:
        return value[:3], value[3:]
    for size in STEPS:
        step = size / largest
        sides = [side for side in (1, -1) if _allowed(at + side * step * along)]
        if not sides:
            continue
        slope, error, kinds = _slope(outcome, at, step * along, sides)
        slope, error = slope / step, error / step / np.abs(value).max()
        if kinds <= {kind} and error <= AGREE * largest:
            complete = value + 1j * STEP * slope
            return complete[:3], complete[3:]
    raise UndecidedError(BRANCH)


def _allowed(values: Floats) -> bool:
    """Return whether there are impacts with these coefficients, friction and restitution."""
    return bool((values[12:] >= 0.0).all() and values[-1] <= 1.0)


def _slope(
    outcome: Callable[[Floats], tuple[Floats, ImpactKind]],
    at: Floats,
    step: Floats,
    sides: list[int],
) -> tuple[Floats, float, set[ImpactKind]]:
    """Return a derivative along a step by extrapolated differences, its error, and what was met.

    Central where both sides are allowed, else of one.
    """
    kinds: set[ImpactKind] = set()

    def met(h: float) -> Floats:
        found, kind = outcome(at + h * step)
        kinds.add(kind)
        return found

    orders: tuple[float, ...]
    if len(sides) > 1:
        orders = (4.0, 16.0)
        estimates = [(met(h) - met(-h)) / (2 * h) for h in (1.0, 0.5, 0.25)]
    else:
        orders, here = (2.0, 4.0, 8.0), met(0.0)
        estimates = [(met(sides[0] * h) - here) / (sides[0] * h) for h in (1.0, 0.5, 0.25, 0.125)]
    for order in orders:
        last = estimates[-1]
        estimates = [(order * b - a) / (order - 1) for a, b in pairwise(estimates)]
    return estimates[-1], float(np.abs(estimates[-1] - last).max()), kinds


def with_flights(solution: Solution, equations: UnilateralEquations) -> SegmentsPath:
    """Return the path of a solution in pieces of 15 rows, with its flights integrated.

    Raises
    ------
    UndecidedError
        If something happens on its way of which no derivatives are known.
    """
    path = solution.path
    assert isinstance(path, UnilateralPath)  # noqa: S101 - of the unilateral model
    pieces: list[Segment] = []
    landings, on_plane = 0, False
    for part in path.parts:
        if isinstance(part, FlightPath):
            pieces += _flight(equations, part)
            landings += 1
            on_plane = False
        elif part.pieces and part.t_end > part.pieces[0].start[TIME]:
            if on_plane or isinstance(part.equations, (SlidingEquations, HeldEquations)):
                raise UndecidedError(FACE)
            pieces += [_with_depth(piece) for piece in part.pieces]
            on_plane = True
    # every flight but one that the horizon ends is ended by one impact, and there are no others
    times = [impact.time for impact in solution.impacts]
    landings -= path.flies_at_end and (not times or times[-1] < path.t_end)
    if len(times) != landings:
        raise UndecidedError(FACE)
    return SegmentsPath(pieces, equations, path.t_end, locus=False)


def _with_depth(piece: Segment) -> Segment:
    """Return a piece on the plane with the rows of depth and rise."""
    return replace(
        piece,
        start=np.append(piece.start, [0.0, 0.0]),
        coefficients=np.pad(piece.coefficients, ((0, 2), (0, 0))),
    )


def _flight(equations: UnilateralEquations, path: FlightPath) -> Sequence[Segment]:
    """Return the pieces of a flight."""
    launch = path.flight.launch
    y = np.append(on_rim(launch, path.flight.body), [-launch.gap, launch.rise])
    y[TIME] = path.start
    length = float(path.duration / Angles.of(y[LEAN]).S)
    pieces: list[Segment] = []
    for _ in range(MOST_STEPS):
        done = step(
            lambda state: equations.rates(state, FLIGHT, along=False),
            y,
            length,
            np.zeros((ROWS, STAGES)),
            lambda state: np.maximum(np.abs(state.real), 1.0),
        )
        series = None if done.change is None else coefficients(done.change)
        tail = np.inf if series is None else float(np.abs(series[:, -2:]).max())
        if series is None or tail > TAIL * max(1.0, float(np.abs(y).max())):
            length /= 2
            continue
        piece = Segment(start=y, coefficients=series, cut=1.0, length=length, mode=FLIGHT)
        left, elapsed = float(path.t_end - y[TIME]), series[TIME]
        if left <= 0.0:
            return pieces
        if basis(np.ones(1))[0] @ elapsed >= left:
            return [*pieces, replace(piece, cut=_when(elapsed, left))]
        pieces.append(piece)
        y = piece.end
    raise UndecidedError(VERTICAL)


def _when(series: Floats, change: float) -> float:
    """Return where in a step a row has changed by so much."""

    def beyond(c: float) -> float:
        return float(basis(np.array([c]))[0] @ series) - change

    return float(scipy.optimize.brentq(beyond, 0.0, 1.0, xtol=1e-16, rtol=1e-15))
