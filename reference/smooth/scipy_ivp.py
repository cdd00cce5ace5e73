"""Rolling, stepped in time by scipy in the raw variables.

State y = (phi, phi', psi', theta', psi, theta[, x, y]). Nothing is done about the
singularity at phi = 0, so that each bounce costs hundreds of steps. The module is the yardstick for
the other methods, by methods that are widely known.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import cos, sin
from typing import TYPE_CHECKING

import numpy as np
import scipy

from reference.equations.reaction_force import contact_from_centre
from reference.problem.can import Parameters
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, States, initial_states
from reference.smooth.extrema import ExtremumRecorder, Run

if TYPE_CHECKING:
    from scipy.integrate import DenseOutput

SCIPY_METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA")
# The absolute tolerance beside the relative one: angles and rates of interest go down to 1e-5.
ABSOLUTE_OVER_RELATIVE = 1e-3
# Samples of a step among which peaks are looked for.
SAMPLES = 4
# Instants of a step at which the normal force is looked at: implicit methods step half a bounce.
LOOKS = 17
RightHandSide = Callable[[float, Floats], Floats]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepsPath:
    """Dense output of a time stepper: one interpolant a step."""

    times: tuple[float, ...]
    pieces: tuple["DenseOutput", ...]

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states at `SAMPLES` instants of each step."""
        edges = np.array(self.times)
        parts = np.arange(SAMPLES) / SAMPLES
        inside = edges[:-1, None] + np.diff(edges)[:, None] * parts
        times = np.append(inside.ravel(), edges[-1])
        return times, self.at(times)

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        if not self.pieces:
            raise ValueError("the path has no steps")
        order = np.argsort(times, kind="stable")
        sorted_times = times[order]
        cuts = np.searchsorted(sorted_times, np.array(self.times[1:-1]), side="right")
        chunks = [
            piece(chunk)
            for piece, chunk in zip(self.pieces, np.split(sorted_times, cuts), strict=True)
            if chunk.size
        ]
        values = np.empty((self.pieces[0](self.times[0]).size, times.size))
        if chunks:
            values[:, order] = np.concatenate(chunks, axis=1)
        return states_from(values)


def states_from(y: Floats) -> States:
    """Return states from the raw variables, shape (6, n) or (8, n)."""
    phi, Phi, Psi, Theta, psi, theta = y[:6]
    x, locus_y = (y[6], y[7]) if len(y) > 6 else (None, None)  # noqa: PLR2004 - six, or eight
    return States(
        phi=phi,
        phi_dot=Phi,
        psi=psi,
        psi_dot=Psi,
        theta=theta,
        theta_dot=Theta,
        spin=Psi + Theta,
        x=x,
        y=locus_y,
    )


def right_hand_side(parameters: Parameters, *, locus: bool) -> RightHandSide:
    """Return y' of eq01:non_dimensionalised_eom as printed, for one state; fast, not vectorised."""
    p = parameters
    a_p, c_p, k, h = p.a_p, p.c_p, p.k, p.h
    kc, hk = k * c_p, h * k

    def rate(_t: float, y: Floats) -> Floats:
        phi, Phi, Psi, Theta, psi, *_ = y.tolist()
        S, C = sin(phi), cos(phi)
        gain = Phi / S
        cos2, sin2 = C * C - S * S, 2 * S * C
        dy = [
            Phi,
            (
                ((a_p - c_p) * S * C - h * cos2) * Psi * Psi
                - (c_p * S + h * C) * Theta * Psi
                + h * S
                - C
            )
            / (a_p + 1),
            gain * (kc * Theta + ((kc - 2) * C - hk * S) * Psi),
            gain
            * ((hk * S - kc * C) * Theta + (2 - kc * C * C - k * a_p * S * S + hk * sin2) * Psi),
            Psi,
            Theta,
        ]
        if locus:
            dy += [-Theta * sin(psi), Theta * cos(psi)]
        return np.array(dy)

    return rate


def step_in_time(problem: Problem, *, method: str, rtol: float, locus: bool) -> Run:
    """Integrate the rolling equations in time with one of scipy's methods.

    Raises
    ------
    KeyError
        If `method` is not one of `SCIPY_METHODS`.
    """
    start = [problem.phi, problem.phi_dot, problem.psi_dot, problem.theta_dot]
    start += [problem.psi, problem.theta]
    if locus:
        release = initial_states(problem)
        start += contact_from_centre(release, problem.parameters)[0, :2].tolist()
    field = right_hand_side(problem.parameters, locus=locus)
    return follow(problem, field, start, method=method, rtol=rtol)


def follow(
    problem: Problem,
    field: RightHandSide,
    start: list[float],
    *,
    method: str,
    rtol: float,
    unilateral: bool = False,
) -> Run:
    """Integrate a field of (phi, phi', psi', theta', psi, theta, ...) to its end.

    Where the contact is `unilateral` the motion ends as lifted where the normal force (eq01:normal)
    comes down to zero.
    """
    watch = ExtremumRecorder(problem)
    solver = getattr(scipy.integrate, method)(
        field,
        0.0,
        np.array(start),
        watch.t_end,
        rtol=rtol,
        atol=rtol * ABSOLUTE_OVER_RELATIVE,
    )
    times: list[float] = [0.0]
    pieces: list[DenseOutput] = []
    while not watch.ended():
        with np.errstate(over="ignore"):  # in the differences of implicit methods, beside phi = 0
            solver.step()
        if solver.status == "failed":
            watch.end(times[-1], Outcome.STALLED)
            break
        pieces.append(solver.dense_output())
        lift = None
        if unilateral:
            lift = _first_lift(problem.parameters, field, pieces[-1], times[-1], solver.t)
        _watch_step(watch, pieces[-1], times[-1], solver.t, lift)
        times.append(min(solver.t, watch.t_end))
        if solver.status == "finished":
            watch.end(solver.t, Outcome.FINISHED)
    path = StepsPath(times=tuple(times), pieces=tuple(pieces))
    return Run(path=path, track=watch.track(), steps=len(pieces), evaluations=solver.nfev)


def _first_lift(
    parameters: Parameters, field: RightHandSide, piece: "DenseOutput", left: float, right: float
) -> float | None:
    """Return the first time within a step at which the normal force is not positive, or None."""
    h = parameters.h

    def normal(t: float) -> float:
        y = piece(t)
        S, C = sin(y[0]), cos(y[0])
        return float(1 + (C - h * S) * field(t, y)[1] - (S + h * C) * y[1] * y[1])

    before = left
    for t in np.linspace(left, right, LOOKS).tolist():
        if normal(t) <= 0:
            return _root(normal, before, t) if t > left else left
        before = t
    return None


def _watch_step(
    watch: ExtremumRecorder, piece: "DenseOutput", left: float, right: float, lift: float | None
) -> None:
    """Report what happens to phi within one step, up to where the can lifts if it does."""
    right = right if lift is None else lift
    before, after = piece(left), piece(right)
    if before[1] * after[1] < 0:
        crossing = _root(lambda t: float(piece(t)[1]), left, right)
        phi, Phi, Psi, Theta, psi, theta = piece(crossing)[:6].tolist()
        snapshot = Snapshot(
            phi=phi,
            phi_dot=Phi,
            psi=psi,
            psi_dot=Psi,
            theta=theta,
            theta_dot=Theta,
            spin=Psi + Theta,
        )
        watch.extremum(crossing, snapshot, maximum=bool(after[1] < 0))
    if watch.ended():
        return
    for level, outcome in ((np.pi / 2, Outcome.OVERTURNED), (0.0, Outcome.FELL_FLAT)):
        if (before[0] - level) * (after[0] - level) < 0:
            watch.end(_root(partial(_above, piece, level), left, right), outcome)
            return
    if lift is not None:
        watch.end(lift, Outcome.LIFTED)
    watch.advance(right, float(after[0]))


def _above(piece: "DenseOutput", level: float, time: float) -> float:
    return float(piece(time)[0]) - level


def _root(f: Callable[[float], float], left: float, right: float) -> float:
    return float(
        scipy.optimize.brentq(f, left, right, xtol=np.spacing(max(left, 1e-300)), rtol=1e-15)
    )
