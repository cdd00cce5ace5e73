"""Newton-Euler equations of the can in plain scalars, for the rivals of the integrator.

In time and in the raw angles. The force of a can with friction alone is that of
`reference.equations.coulomb`, written out; with other effects it has a derivation of its own.
`tests/benchmarks/test_newton_euler.py` holds both against rotation matrices. Of one state plain
numbers are several times faster than arrays; in numpy's long doubles the same formulas give the
truth, and numba compiles them.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from reference import Problem

Numbers = tuple[Any, ...]
"""Of floats, or of long doubles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arithmetic:
    """A type of number and its functions."""

    number: Callable[[float], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    hypot: Callable[[Any, Any], Any]


DOUBLE = Arithmetic(number=float, sin=math.sin, cos=math.cos, hypot=math.hypot)
LONG_DOUBLE = Arithmetic(number=np.longdouble, sin=np.sin, cos=np.cos, hypot=np.hypot)


Force = Callable[[Numbers, Any, Any, bool], Numbers]
"""From (t, phi, w, psi, theta, u), sin phi, cos phi and whether the rim slips: the angular
acceleration in axes that stand, u' and the force."""
_CARRIED = frozenset({"slip", "tilt", "shake", "point_mass"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """A problem as its rivals integrate it.

    The state is phi, w2 = -phi', w1 = psi' sin phi, w3 = psi' cos phi + theta', psi, theta and the
    slip (u1, u2) along (cos psi, sin psi) and across.
    """

    problem: Problem
    given: Arithmetic
    force: Force
    rates: Callable[[Any, Numbers, bool], Numbers]
    field: Callable[[float, NDArray[np.float64], bool], Any]

    @classmethod
    def of(
        cls, problem: Problem, given: Arithmetic = DOUBLE, *, compiled: bool = False
    ) -> "Motion":
        """Return a problem with friction alone, or of a rim that never slips with other effects.

        Raises
        ------
        ValueError
            Of effects that these equations do not have.
        """
        declared = problem.effects.declared()
        if others := sorted(set(declared) - _CARRIED):
            raise ValueError(
                f"the rivals have no {', '.join(others)}: only {', '.join(sorted(_CARRIED))}"
            )
        alone = tuple(declared) == ("slip",)
        force = axisymmetric(problem, given) if alone else with_effects(problem, given)
        rates = rates_of(force, given)

        def field(t: float, y: NDArray[np.float64], slips: bool) -> Any:  # noqa: FBT001 - numba
            return rates(t, tuple(y.tolist()), slips)

        if compiled:
            force, rates, field = _compiled(force, given)
        return cls(problem=problem, given=given, force=force, rates=rates, field=field)

    @property
    def mu(self) -> float:
        """Coefficient of friction."""
        return math.inf if self.problem.effects.mu is None else self.problem.effects.mu

    def released(self) -> Numbers:
        """Return the state at the release."""
        p = self.problem
        phi, phi_dot, psi_dot, theta_dot, psi, theta, *slip = (
            self.given.number(value)
            for value in (p.phi, p.phi_dot, p.psi_dot, p.theta_dot, p.psi, p.theta, *p.slip)
        )
        S, C = self.given.sin(phi), self.given.cos(phi)
        return phi, -phi_dot, psi_dot * S, psi_dot * C + theta_dot, psi, theta, *slip

    def reserve(self, t: Any, y: Numbers) -> Any:
        """Return mu N less the friction, of a rim that sticks."""
        phi, w2, w1, w3, psi, theta, u1, u2 = y
        S, C = self.given.sin(phi), self.given.cos(phi)
        *_, F1, F2, N = self.force((t, phi, w1, w2, w3, psi, theta, u1, u2), S, C, False)  # noqa: FBT003
        return self.mu * N - self.given.hypot(F1, F2)


def rates_of(force: Force, given: Arithmetic) -> Callable[[Any, Numbers, bool], Numbers]:
    """Return the rates of a state at a time, as a function that numba can compile."""
    sin, cos = given.sin, given.cos

    def rates(t: Any, y: Numbers, slips: bool) -> Numbers:  # noqa: FBT001 - numba has no keywords
        phi, w2, w1, w3, psi, theta, u1, u2 = y
        S, C = sin(phi), cos(phi)
        a1, a2, a3, b1, b2, _, _, _ = force((t, phi, w1, w2, w3, psi, theta, u1, u2), S, C, slips)
        psi_dot = w1 / S
        theta_dot = w3 - psi_dot * C
        if slips:
            b1, b2 = b1 + psi_dot * u2, b2 - psi_dot * u1
        return -w2, a2 + theta_dot * w1, a1 - theta_dot * w2, a3, psi_dot, theta_dot, b1, b2

    return rates


def _compiled(force: Force, given: Arithmetic) -> tuple[Force, Any, Any]:
    """Return a force, the rates and the field, compiled."""
    from numba import njit  # noqa: PLC0415 - an extra

    own: Any = njit(force)
    rates: Any = njit(rates_of(own, given))

    @njit
    def field(t: float, y: NDArray[np.float64], slips: bool) -> Any:  # noqa: FBT001
        return np.array(rates(t, (y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7]), slips))

    return own, rates, field


Event = Callable[[Any, Numbers], Any]
"""A quantity of a time and a state that falls to zero."""


class Integrator(Protocol):
    """An integrator of a `Motion`, with where it is."""

    motion: Motion
    time: Any
    y: Any
    slips: bool

    def integrate(self, end: float, event: Event | None) -> bool:
        """Integrate to a time, or to where a quantity falls to zero; return whether it did."""
        ...


class Onset(Protocol):
    """How a slip begins."""

    @property
    def start(self) -> float:
        """Return when: 0.0 of a rim that slips from the release on."""
        ...

    @property
    def end(self) -> float:
        """Return the end of its first moments."""
        ...

    def gain(self, time: float) -> NDArray[np.float64]:
        """Return what the state gains from a time near the start to the end, shape (8,)."""
        ...


def follow(integrator: Integrator, end: float, onsets: Sequence[Onset], *, stopped: float) -> None:
    """Integrate a motion through its phases of sticking and slipping.

    A slip that begins is stiff for any explicit method, and where it begins from rest has no
    direction: its first moments are given. One that stops is followed as far as its speed is
    `stopped`, and from there to rest by the midpoint rule.
    """
    beginning, motion = iter(onsets), integrator.motion

    def sliding(_: Any, y: Numbers) -> Any:
        return motion.given.hypot(y[6], y[7]) - stopped

    def slip() -> None:
        onset = next(beginning)
        integrator.slips = True
        integrator.y = integrator.y + onset.gain(float(integrator.time))
        integrator.time = integrator.motion.given.number(onset.end)

    first = next(iter(onsets), None)
    if first is not None and first.start == 0.0:
        slip()
    while integrator.time < end:
        if integrator.slips and integrator.integrate(end, sliding):
            time, y = integrator.time, integrator.y
            rates = np.array(motion.rates(time, tuple(y), integrator.slips))
            half = y + _left_of_slip(y, rates) / 2 * rates
            rates = np.array(motion.rates(time, tuple(half), integrator.slips))
            left = _left_of_slip(y, rates)
            integrator.y = y + left * rates
            integrator.y[6:] = 0.0
            integrator.time, integrator.slips = time + left, False
        elif not integrator.slips and integrator.integrate(
            end, motion.reserve if motion.mu < math.inf else None
        ):
            slip()


def _left_of_slip(y: Any, rates: Any) -> Any:
    """Return the time after which a slip stops at its rates."""
    return -(y[6:] @ y[6:]) / (y[6:] @ rates[6:])


def axisymmetric(problem: Problem, given: Arithmetic) -> Force:
    """Return the force on a can with friction alone (`reference.equations.coulomb`)."""
    p, mu, hypot = problem.parameters, problem.effects.mu or 0.0, given.hypot
    a, c, h = given.number(p.a), given.number(p.c), given.number(p.h)
    a_p, c_p = a + h * h, c + 1
    det = a_p * c_p - h * h

    def force(state: Numbers, S: Any, C: Any, slips: bool) -> Numbers:  # noqa: FBT001
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


def with_effects(problem: Problem, given: Arithmetic) -> Force:
    """Return the force on a can that sticks, with a point mass, on a tilted or shaken plane.

    With a_G = -w' x p - w x dp/dt the force M (a_G - g) has the moment p x F about the centre of
    mass: (I + M (p p 1 - p p^T)) w' = -w x I w - M p x (g + w x dp/dt), solved by Cramer's rule.
    """
    p, e, sin, cos = problem.parameters, problem.effects, given.sin, given.cos
    mass = (0.0,) * 4 if e.mass is None else (e.mass.share, e.mass.x, e.mass.y, e.mass.z)
    a, c, h, q, mx, my, mz = (given.number(value) for value in (p.a, p.c, p.h, *mass))
    M = 1 + q
    share = q / M
    (gx, gy, gz), (sx, sy, sz) = e.gravity.constant, e.gravity.amplitude
    rate, phase = e.gravity.rate, e.gravity.phase

    def force(state: Numbers, S: Any, C: Any, slips: bool) -> Numbers:  # noqa: FBT001
        if slips:
            raise ValueError("with tilt, shaking or a point mass the rivals only stick")
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
