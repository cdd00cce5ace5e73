"""The planar pendulum: the can pivots about its rim and nothing turns.

With psi' = theta' = 0 the nutation obeys (eq01:nonlin_pendulum)

    phi'' = w^2 sin(phi - phi*),      w^2 = sqrt(1 + h^2)/(a_p + 1).

Measured from the hanging position, chi = pi - (phi* - phi), this is the pendulum chi'' = -w^2 sin
chi:

    sin(chi/2) = kappa sn(w t + u0 | kappa^2)          if kappa <= 1 (it turns back),
    chi/2      = am(kappa w t + u0 | 1/kappa^2)        if kappa > 1 (it goes over the top),
    kappa^2    = sin^2(chi_0/2) + (chi_0'/(2 w))^2.

The paper's closed solution below eq01:nonlin_pendulum is misprinted twice: its scaled time has
sqrt(h^2 + 1) where the fourth root belongs, and it gives phi where the integral is the time.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

from reference.outcome import Outcome
from reference.parameters import Parameters
from reference.problem import Problem
from reference.run import Run
from reference.states import Floats, States, states_of
from reference.track import Track

SAMPLES = 200


def frequency(parameters: Parameters) -> float:
    """Rate w at which the can falls away from balance, in sqrt(g/R)."""
    p = parameters
    return float(np.sqrt(np.sqrt(1 + p.h**2) / p.pendulum_inertia))


@dataclass(frozen=True, slots=True, kw_only=True)
class Pendulum:
    """A planar motion in closed form.

    Attributes
    ----------
    parameters : Parameters
    modulus : float
        kappa; above 1 the can goes over its balancing angle.
    side : float
        1 if the can leans on the flat side of balance (or goes over), -1 beyond it: a mirror image.
    offset, rate : float
        Argument of the elliptic function at release, and its rate in time.
    """

    parameters: Parameters
    modulus: float
    side: float
    offset: float
    rate: float

    def nutation(self, times: Floats) -> tuple[Floats, Floats]:
        """Return phi and phi' at the given times, shape (n,)."""
        u = self.offset + self.rate * np.asarray(times)
        if self.modulus <= 1:
            sn, cn, _, _ = ellipj(u, self.modulus**2)
            half = np.arcsin(np.clip(self.modulus * sn, -1, 1))
            # d(chi/2)/dt = kappa cn dn rate/cos(chi/2), and cos(chi/2) = dn
            slope = self.modulus * cn
        else:
            _, _, slope, half = ellipj(u, self.modulus**-2)
        lean = self.side * (2 * half - np.pi)
        return (
            np.asarray(self.parameters.balancing_angle + lean),
            np.asarray(self.side * 2 * slope * self.rate),
        )

    def time_at(self, phi: float) -> float:
        """Return when the nutation is `phi`, on the way away from the balancing angle."""
        half = (np.pi + self.side * (phi - self.parameters.balancing_angle)) / 2
        if self.modulus <= 1:
            argument = np.arcsin(np.clip(np.sin(half) / self.modulus, -1, 1))
            u = 2 * ellipk(self.modulus**2) - ellipkinc(argument, self.modulus**2)
        else:
            u = ellipkinc(half, self.modulus**-2)
        return float((u - self.offset) / self.rate)


def planar_motion(parameters: Parameters, phi: float, phi_dot: float = 0.0) -> Pendulum:
    """Return the planar motion from a release."""
    w = frequency(parameters)
    lean = phi - parameters.balancing_angle
    modulus = float(np.hypot(np.cos(lean / 2), phi_dot / (2 * w)))
    if modulus > 1:
        return Pendulum(
            parameters=parameters,
            modulus=modulus,
            side=1.0,
            offset=float(ellipkinc((np.pi + lean) / 2, modulus**-2)),
            rate=float(np.copysign(modulus * w, phi_dot)),
        )
    side = -1.0 if lean > 0 else 1.0
    argument = np.arcsin(np.clip(np.cos(lean / 2) / modulus, -1, 1))
    u = float(ellipkinc(argument, modulus**2))
    if side * phi_dot <= 0:
        u = 2 * float(ellipk(modulus**2)) - u
    return Pendulum(parameters=parameters, modulus=modulus, side=side, offset=u, rate=w)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarPath:
    """The planar motion as states: psi and theta stay what they were."""

    problem: Problem
    pendulum: Pendulum
    t_end: float

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        phi, phi_dot = self.pendulum.nutation(times)
        zero = np.zeros_like(phi)
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=zero + self.problem.psi,
            psi_dot=zero,
            theta=zero + self.problem.theta,
            theta_dot=zero,
            spin=zero,
        )

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states on an even grid."""
        times = np.linspace(0, self.t_end, SAMPLES)
        return times, self.at(times)


def solve_pendulum(problem: Problem) -> Run:
    """Follow the planar motion until the can lies flat, its side meets the plane, or time is up.

    Rates of precession and rotation are left out: this is the model in which they have no effect.
    """
    p = problem.parameters
    motion = planar_motion(p, problem.phi, problem.phi_dot)
    over = motion.modulus > 1
    down = problem.phi_dot < 0 if over else motion.side > 0
    outcome = Outcome.FELL_FLAT if down else Outcome.OVERTURNED
    t_end = motion.time_at(0.0 if down else np.pi / 2)
    if not np.isfinite(t_end) or (problem.phi == p.balancing_angle and problem.phi_dot == 0):
        outcome, t_end = Outcome.STEADY, 2 * np.pi / frequency(p)
    if problem.duration is not None and problem.duration < t_end:
        outcome, t_end = Outcome.FINISHED, problem.duration
    track = Track(
        outcome=outcome,
        t_end=float(t_end),
        times=np.empty(0),
        extrema=states_of([]),
        maximum=np.empty(0, dtype=bool),
    )
    return Run(
        path=PlanarPath(problem=problem, pendulum=motion, t_end=float(t_end)),
        track=track,
        steps=0,
        evaluations=0,
    )
