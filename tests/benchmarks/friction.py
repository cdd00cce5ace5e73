"""Friction, tilt, shaking and an off-centre mass: the integrator against scipy's DOP853.

The rival integrates the same equations in time, in plain numbers, which for one state are several
times faster than arrays; it finds where the rim begins to slip, and where it sticks again, by the
events of `solve_ivp`, and so the extrema of phi. Both are held against the integrator without
compiled code: other equations and another iteration, but the same rule of steps, so that our error
is what compiling adds. The rival lets a slip begin with a velocity of its own, and where the rim
slips its error is that velocity's, at any tolerance.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import cos, hypot, inf, sin

import numpy as np
import scipy

from harness.engines.reference.to_reference_problem import problem as posed
from models.catalogue import load
from reference import Kind, Problem, Solution, solve
from reference.numerics.compiled import available
from tests.benchmarks.clock import Ratio, in_turns, seconds

# The least that scipy takes is a hundred roundings.
_TIGHT, _LOOSE = 3e-14, 1e-12
# Errors below this are those of the last digits of angles of size one.
_ROUNDINGS = 16 * float(np.finfo(float).eps)
# Velocity with which the rival lets a slip begin, and below which it holds one, in sqrt(g R): its
# error is as large, and each tenth of it costs the rival seven times as long.
_LEAST_SLIP = 1e-7
_REPEATS = 3
# How many times faster than DOP853 the integrator is to be, of every piece.
_FASTER = 10.0
# Strength, in units of the can, of laws that are declared for what they cost.
_WEAK = 1e-9
# Time after which a slip that begins at the release has its direction to see.
_BEGUN = 1e-6

Numbers = tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A piece of a scene of the catalogue.

    Attributes
    ----------
    scene : str
    duration : float
        In sqrt(R/g).
    what : str
        What the rim does in it.
    """

    scene: str
    duration: float
    what: str

    def problem(self) -> Problem:
        """Return the piece as a problem."""
        return replace(posed(load(self.scene)), bounces=None, duration=self.duration)


PIECES = (
    Piece(scene="slipping-rock", duration=1.9, what="sticks"),
    Piece(scene="slipping-rock", duration=3.4, what="sticks, then slips"),
    Piece(scene="friction-below", duration=6.5, what="sticks, slips and sticks"),
    Piece(scene="friction-above", duration=6.5, what="sticks"),
    Piece(scene="rim-slips-all-round", duration=1.8, what="slips"),
    Piece(scene="sliding-rim", duration=2.6, what="slips"),
    Piece(scene="tilted-plane", duration=14.6, what="sticks"),
    Piece(scene="shaken-plane", duration=14.6, what="sticks"),
    Piece(scene="off-centre-mass", duration=16.2, what="sticks"),
    Piece(scene="chaotic-can", duration=32.0, what="sticks"),
)


def friction_ratios() -> Iterator[Ratio]:
    """Measure the claims about friction, tilt and an off-centre mass, one by one."""
    yield from (_against_scipy(piece) for piece in PIECES)
    yield _without_what_is_not_declared()


def _without_what_is_not_declared() -> Ratio:
    """Time a scene of friction, and the same with laws that are too weak to move it."""
    piece = PIECES[0]
    plain = piece.problem()
    weak = {"contour_damping": _WEAK, "patch": _WEAK}
    laden = replace(plain, effects=replace(plain.effects, **weak))  # type: ignore[arg-type]
    own, with_laws = in_turns(lambda: solve(plain), lambda: solve(laden), repeats=_REPEATS)
    apart = float(np.abs(_end(solve(laden)) - _end(solve(plain))).max())
    return Ratio(
        what=f"{piece.scene} ({piece.what}) without laws that are not declared",
        ratio=with_laws / own,
        claim="costs no more than with them",
        holds=with_laws >= own,
        first_s=own,
        second_s=with_laws,
        note=f"a patch and viscous contour friction of strength {_WEAK:g} move the end by "
        f"{apart:.1e}; without them the model is {solve(plain).model!r}",
    )


def _against_scipy(piece: Piece) -> Ratio:
    """Time a piece by the integrator, compiled where it can be, and by DOP853."""
    problem, compiled = piece.problem(), available()
    # what cannot stick at the release: the rival is told in which direction it slips
    onset = _onset(problem)
    own, scipy_s = in_turns(
        lambda: solve(problem, compiled=compiled),
        lambda: by_scipy(problem, _TIGHT, onset),
        repeats=_REPEATS,
    )
    loose_s = min(seconds(lambda: by_scipy(problem, _LOOSE, onset)) for _ in range(_REPEATS))
    truth = _end(solve(problem))
    own_error = float(np.abs(_end(solve(problem, compiled=compiled)) - truth).max())
    scipy_error, loose_error = (
        float(np.abs(by_scipy(problem, rtol, onset)[:4] - truth).max()) for rtol in (_TIGHT, _LOOSE)
    )
    claim = f"at least {_FASTER:g} times faster, and at least as accurate" if compiled else ""
    return Ratio(
        what=f"{piece.scene} ({piece.what}) against DOP853 at rtol {_TIGHT:g}",
        ratio=scipy_s / own,
        claim=claim,
        holds=not compiled
        or (scipy_s >= _FASTER * own and own_error <= max(scipy_error, _ROUNDINGS)),
        first_s=own,
        second_s=scipy_s,
        note=f"error at the end {own_error:.1e} against {scipy_error:.1e}; DOP853 at rtol "
        f"{_LOOSE:g}: ratio {loose_s / own:.1f}, error {loose_error:.1e}",
    )


def _end(solution: Solution) -> np.ndarray:
    """Return phi, phi', psi and theta at the end of a solution."""
    there = solution.at(solution.t_end)
    return np.concatenate([there.phi, there.phi_dot, there.psi, there.theta])


def by_scipy(  # noqa: C901 - a rival in one place
    problem: Problem, rtol: float, onset: Numbers | None = None
) -> np.ndarray:
    """Return phi, phi', psi, theta, psi', the axial turning and the slip at the end of a problem.

    By DOP853 in time, with an event for each change of the law of contact; of a rim that cannot
    stick at the release `onset` is the slip with which it begins.

    Raises
    ------
    RuntimeError
        If scipy gives up.
    """
    mu = inf if problem.effects.mu is None else problem.effects.mu
    if problem.effects.declared() == ("slip",):
        force = axisymmetric(problem)
    else:
        force = with_effects(problem)
    S, C = sin(problem.phi), cos(problem.phi)
    y = np.array(
        [
            problem.phi,
            -problem.phi_dot,
            problem.psi_dot * S,
            problem.psi_dot * C + problem.theta_dot,
            problem.psi,
            problem.theta,
            *problem.slip,
        ]
    )
    slips, time, end = problem.slip != (0.0, 0.0), 0.0, float(problem.duration or 0.0)
    if onset is not None:
        slips, y[6:] = True, onset

    def field(t: float, y: np.ndarray) -> Numbers:
        phi, w2, w1, w3, psi, theta, u1, u2 = y.tolist()
        S, C = sin(phi), cos(phi)
        a1, a2, a3, b1, b2, *_ = force((t, phi, w1, w2, w3, psi, theta, u1, u2), S, C, slips)
        psi_dot = w1 / S
        theta_dot = w3 - psi_dot * C
        if not slips:
            return -w2, a2 + theta_dot * w1, a1 - theta_dot * w2, a3, psi_dot, theta_dot, 0.0, 0.0
        b1, b2 = b1 + psi_dot * u2, b2 - psi_dot * u1
        return -w2, a2 + theta_dot * w1, a1 - theta_dot * w2, a3, psi_dot, theta_dot, b1, b2

    def reaction(t: float, y: np.ndarray) -> Numbers:
        phi, w2, w1, w3, psi, theta, u1, u2 = y.tolist()
        return force((t, phi, w1, w2, w3, psi, theta, u1, u2), sin(phi), cos(phi), slips)[5:]

    def reserve(t: float, y: np.ndarray) -> float:
        F1, F2, N = reaction(t, y)
        return mu * N - hypot(F1, F2)

    def sliding(_t: float, y: np.ndarray) -> float:
        return hypot(y[6], y[7]) - _LEAST_SLIP / 2

    def nutation_rate(_t: float, y: np.ndarray) -> float:
        return float(y[1])

    for event in (reserve, sliding):
        vars(event).update(terminal=True, direction=-1.0)
    while time < end:
        watched = [sliding] if slips else [reserve] if mu < inf else []
        part = scipy.integrate.solve_ivp(
            field,
            (time, end),
            y,
            method="DOP853",
            rtol=rtol,
            atol=rtol * 1e-3,
            # the extrema of phi are of the answer, with them the bounces
            events=[*watched, nutation_rate],
        )
        if not part.success:
            raise RuntimeError(part.message)
        time, y = float(part.t[-1]), part.y[:, -1]
        if part.status == 1 and slips:
            slips, y[6:] = False, 0.0
        elif part.status == 1:
            F1, F2, _ = reaction(time, y)
            size = hypot(F1, F2)
            slips, y[6:] = True, (-_LEAST_SLIP * F1 / size, -_LEAST_SLIP * F2 / size)
    return np.array([y[0], -y[1], *y[4:6], *y[2:4], *y[6:]])


def _onset(problem: Problem) -> Numbers | None:
    """Return a small slip in the direction in which the rim of a release begins to, if it does."""
    if solve(problem).phases[0].kind is not Kind.SLIP or problem.slip != (0.0, 0.0):
        return None
    there = solve(replace(problem, duration=_BEGUN)).at(_BEGUN)
    if there.slip is None:
        raise ValueError("nothing slips")
    (x, y), angle = there.slip[0], there.psi[0]
    u1, u2 = x * cos(angle) + y * sin(angle), y * cos(angle) - x * sin(angle)
    size = hypot(u1, u2)
    return _LEAST_SLIP * u1 / size, _LEAST_SLIP * u2 / size


Force = Callable[[Numbers, float, float, bool], Numbers]
"""From (t, phi, w, psi, theta, u), S, C and whether the rim slips: w' in axes that stand, u', F."""


def axisymmetric(problem: Problem) -> Force:
    """Return the force on a can with friction alone (`reference.equations.coulomb`)."""
    p, mu = problem.parameters, problem.effects.mu or 0.0
    a, c, h = p.a, p.c, p.h
    a_p, c_p = a + h * h, c + 1
    det = a_p * c_p - h * h

    def force(state: Numbers, S: float, C: float, slips: bool) -> Numbers:  # noqa: FBT001
        _, _, w1, w2, w3, _, _, u1, u2 = state
        q1, q2, q3 = -h * w2, w1 * (h - C / S), w2
        k1, k2, k3 = w2 * q3 - w3 * q2, w3 * q1 - w1 * q3, w1 * q2 - w2 * q1
        if not slips:
            e1, e2, e3 = S - k1, -k2, C - k3
            b1 = (a - c) * w2 * w3 + h * e2
            b2 = (c - a) * w1 * w3 - h * e1 + e3
            a1, a2, a3 = (c_p * b1 - h * e2) / det, b2 / (a_p + 1), (h * b1 - a_p * e2) / det
            F1, F2, F3 = h * a2 + e1, a3 - h * a1 + e2, e3 - a2
            return a1, a2, a3, 0.0, 0.0, C * F1 - S * F3, F2, S * F1 + C * F3
        speed = hypot(u1, u2)
        n1, n2 = mu * u1 / speed, mu * u2 / speed
        reach, height = C - h * S, S + h * C
        own = (c - a) * w1 * w3 / a
        N = (1 - reach * own - (S * k1 + C * k3)) / (1 + reach * (reach + n1 * height) / a)
        F1, F2 = -N * n1, -N * n2
        a1 = (a - c) * w2 * w3 / a + h * F2 / a
        a2, a3 = own + (reach * N - height * F1) / a, -F2 / c
        b1, b2 = F1 - height * a2 + (C * k1 - S * k3), F2 - (a3 - h * a1) + k2
        return a1, a2, a3, b1, b2, F1, F2, N

    return force


def with_effects(problem: Problem) -> Force:
    """Return the force on a can that sticks, with a point mass, on a tilted or shaken plane.

    With a_G = -w' x p - w x dp/dt the force M (a_G - g) has the moment p x F about the centre of
    mass: (I + M (p p 1 - p p^T)) w' = -w x I w - M p x (g + w x dp/dt), solved by Cramer's rule.
    """
    p, e = problem.parameters, problem.effects
    a, c, h = p.a, p.c, p.h
    q, mx, my, mz = (0.0,) * 4 if e.mass is None else (e.mass.share, e.mass.x, e.mass.y, e.mass.z)
    M = 1 + q
    share = q / M
    (gx, gy, gz), (sx, sy, sz) = e.gravity.constant, e.gravity.amplitude
    rate, phase = e.gravity.rate, e.gravity.phase

    def force(state: Numbers, S: float, C: float, slips: bool) -> Numbers:  # noqa: FBT001, ARG001
        t, _, w1, w2, w3, psi, theta, _, _ = state
        ct, st, cp, sp = cos(theta), sin(theta), cos(psi), sin(psi)
        d1, d2, d3 = mx * ct - my * st, mx * st + my * ct, mz
        p1, p2, p3 = -1 - share * d1, -share * d2, -h - share * d3
        wave = sin(rate * t + phase)
        x, y, z = gx + sx * wave, gy + sy * wave, gz + sz * wave
        x, y = cp * x + sp * y, cp * y - sp * x
        g1, g2, g3 = C * x + S * z, y, C * z - S * x
        l1, l2, l3 = w2 * p3 - w3 * p2, w3 * p1 - w1 * p3, w1 * p2 - w2 * p1
        k1, k2, k3 = l1, l2 + w3 - C * w1 / S, l3
        e1, e2, e3 = g1 + w2 * k3 - w3 * k2, g2 + w3 * k1 - w1 * k3, g3 + w1 * k2 - w2 * k1
        I11, I22 = a + share * (d2 * d2 + d3 * d3), a + share * (d1 * d1 + d3 * d3)
        I33 = c + share * (d1 * d1 + d2 * d2)
        I12, I13, I23 = -share * d1 * d2, -share * d1 * d3, -share * d2 * d3
        H1 = I11 * w1 + I12 * w2 + I13 * w3
        H2 = I12 * w1 + I22 * w2 + I23 * w3
        H3 = I13 * w1 + I23 * w2 + I33 * w3
        t1 = w3 * H2 - w2 * H3 - M * (p2 * e3 - p3 * e2)
        t2 = w1 * H3 - w3 * H1 - M * (p3 * e1 - p1 * e3)
        t3 = w2 * H1 - w1 * H2 - M * (p1 * e2 - p2 * e1)
        J11, J22 = I11 + M * (p2 * p2 + p3 * p3), I22 + M * (p1 * p1 + p3 * p3)
        J33 = I33 + M * (p1 * p1 + p2 * p2)
        J12, J13, J23 = I12 - M * p1 * p2, I13 - M * p1 * p3, I23 - M * p2 * p3
        A11, A12, A13 = J22 * J33 - J23 * J23, J13 * J23 - J12 * J33, J12 * J23 - J13 * J22
        A22, A23, A33 = J11 * J33 - J13 * J13, J12 * J13 - J11 * J23, J11 * J22 - J12 * J12
        det = J11 * A11 + J12 * A12 + J13 * A13
        a1 = (A11 * t1 + A12 * t2 + A13 * t3) / det
        a2 = (A12 * t1 + A22 * t2 + A23 * t3) / det
        a3 = (A13 * t1 + A23 * t2 + A33 * t3) / det
        F1 = -M * (a2 * p3 - a3 * p2 + e1)
        F2 = -M * (a3 * p1 - a1 * p3 + e2)
        F3 = -M * (a1 * p2 - a2 * p1 + e3)
        return a1, a2, a3, 0.0, 0.0, C * F1 - S * F3, F2, S * F1 + C * F3

    return force
