"""The planar pendulum: the can pivots about its rim and nothing turns.

With psi' = theta' = 0 the nutation obeys (eq01:nonlin_pendulum), with the lean d = phi - phi*,

    d'' = w^2 sin d,      w^2 = sqrt(1 + h^2)/(a_p + 1).

With m = sin^2(d/2) - (d'/(2 w))^2, a constant of the motion,

    sin(|d|/2) = sqrt(m)/dn(w t + x0 | 1 - m)      if m >= 0 (it turns back on its own side),
    (pi + d)/2 = am(u0 +- kappa w t | 1/kappa^2)   if m < 0 (it goes over the top), kappa^2 = 1 - m.

The paper's closed solution below eq01:nonlin_pendulum is misprinted twice: its scaled time has
sqrt(h^2 + 1) where the fourth root belongs, and it gives phi where the integral is the time.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj, ellipkinc, ellipkm1, elliprf

from reference.contact import contact_from_centre
from reference.elliptic import squared_sn_cn
from reference.outcome import Outcome
from reference.parameters import Parameters
from reference.problem import Problem
from reference.run import Run
from reference.states import Floats, States, initial_states, states_of
from reference.track import Track

SAMPLES = 200
# Of the lean at release: a fall that is shorter is timed by its speed.
SHORT = 0.1
# Points of a quadrature of a function that hardly changes.
POINTS = 16


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
    constant : float
        m; negative where the can goes over its balancing angle.
    side : float
        -1 if the can leans on the flat side of balance, 1 beyond it; 1 if it goes over.
    offset, rate : float
        Argument of the elliptic function at release, and its rate in time.
    phi, phi_dot : float
        Release.
    """

    parameters: Parameters
    constant: float
    side: float
    offset: float
    rate: float
    phi: float
    phi_dot: float

    def nutation(self, times: Floats) -> tuple[Floats, Floats]:
        """Return phi and phi' at the given times, shape (n,)."""
        x = self.offset + self.rate * np.asarray(times)
        m = self.constant
        if m < 0:
            _, _, slope, half = ellipj(x, 1 / (1 - m))
            lean, lean_dot = 2 * half - np.pi, 2 * slope * self.rate
        else:
            fraction = np.minimum(np.abs(x) / ellipkm1(m), 1.0)
            sn2, cn2 = squared_sn_cn(fraction[:, None], np.array([m]))
            dn = np.sqrt(cn2 + m * sn2)[:, 0]
            lean = 2 * self.side * np.arcsin(np.minimum(np.sqrt(m) / dn, 1.0))
            speed = 2 * np.sqrt((1 - m) * m * sn2[:, 0]) / dn * self.rate
            lean_dot = self.side * np.sign(x) * speed
        return np.asarray(self.parameters.balancing_angle + lean), np.asarray(lean_dot)

    def time_at(self, phi: float) -> float:
        """Return when the nutation is `phi`, on the way away from the balancing angle."""
        lean, m = phi - self.parameters.balancing_angle, self.constant
        if abs(phi - self.phi) < SHORT * abs(self.phi - self.parameters.balancing_angle):
            return self._short_time_to(phi)
        if m < 0:
            x = float(ellipkinc((np.pi + lean) / 2, 1 / (1 - m)))
        else:
            sine2 = np.sin(lean / 2) ** 2
            # sn^2, cn^2 and dn^2 at that point, none of them a difference of near numbers
            sn2 = max(1 - m / sine2, 0.0) / (1 - m)
            cn2 = m * (1 / sine2 - 1) / (1 - m)
            x = float(np.sqrt(sn2) * elliprf(cn2, m / sine2, 1.0))
        return (x - self.offset) / self.rate

    def _short_time_to(self, phi: float) -> float:
        """Return when the nutation is `phi`, near the release, from dt = dphi'/(w^2 sin d).

        Elliptic functions would give the time as a difference of near numbers; here the squares of
        speeds differ by 4 w^2 (sin^2(d/2) - sin^2(d0/2)), which is a product.
        """
        w, start = frequency(self.parameters), self.phi - self.parameters.balancing_angle
        near = np.sin((phi - self.phi) / 2) * np.sin((phi - self.phi) / 2 + start)
        end = float(np.copysign(np.sqrt(self.phi_dot**2 + 4 * w**2 * near), start))
        gained = end - self.phi_dot
        if end * self.phi_dot > 0:
            gained = 4 * w**2 * near / (end + self.phi_dot)
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        speed = self.phi_dot + gained * (nodes + 1) / 2
        sine2 = (
            np.sin(start / 2) ** 2 + (speed - self.phi_dot) * (speed + self.phi_dot) / (2 * w) ** 2
        )
        pull = w**2 * 2 * np.sqrt(sine2 * (1 - sine2)) * np.sign(start)
        return float(gained / 2 * (weights / pull).sum())


def planar_motion(parameters: Parameters, phi: float, phi_dot: float = 0.0) -> Pendulum:
    """Return the planar motion from a release."""
    w = frequency(parameters)
    lean = phi - parameters.balancing_angle
    sine, speed = abs(np.sin(lean / 2)), phi_dot / (2 * w)
    m = float((sine - speed) * (sine + speed))
    if m < 0:
        kappa = np.sqrt(1 - m)
        return Pendulum(
            parameters=parameters,
            constant=m,
            side=1.0,
            offset=float(ellipkinc((np.pi + lean) / 2, kappa**-2)),
            rate=float(np.copysign(kappa * w, phi_dot)),
            phi=phi,
            phi_dot=phi_dot,
        )
    side = 1.0 if lean > 0 else -1.0
    # sn(x0) = d'/(2 w kappa sin(d/2)), positive on the way out
    sn = 0.0 if phi_dot == 0 else side * speed / (sine * np.sqrt(1 - m))
    offset = float(sn * elliprf(1 - sn**2, 1 - (1 - m) * sn**2, 1.0))
    return Pendulum(
        parameters=parameters,
        constant=m,
        side=side,
        offset=offset,
        rate=w,
        phi=phi,
        phi_dot=phi_dot,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarPath:
    """The planar motion as states: psi, theta and the contact point stay what they were."""

    problem: Problem
    pendulum: Pendulum
    t_end: float

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        phi, phi_dot = self.pendulum.nutation(times)
        zero = np.zeros_like(phi)
        release = initial_states(self.problem)
        point = contact_from_centre(release, self.problem.parameters)[0]
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=zero + self.problem.psi,
            psi_dot=zero,
            theta=zero + self.problem.theta,
            theta_dot=zero,
            spin=zero,
            x=zero + point[0],
            y=zero + point[1],
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
    over = motion.constant < 0
    down = problem.phi_dot < 0 if over else motion.side < 0
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
