"""The planar pendulum: the can pivots about its rim and nothing turns.

With psi' = theta' = 0 the nutation obeys (eq01:nonlin_pendulum), with the lean d = phi - phi*,

    d'' = w^2 sin d,      w^2 = sqrt(1 + h^2)/(a_p + 1).

With s = sin(|d|/2), u = |d'|/(2 w) and the constant of the motion m = s^2 - u^2,

    s = sqrt(m)/dn(w t | 1 - m)                          if m >= 0: it turns back on its own side,
    s = k' |sd(w t/k | k^2)|, k'^2 = 1 - k^2 = -m k^2    if m < 0: it goes over the top,

where t counts from the turning back or from the top. The time between two speeds is

    w t = int_y^x du/sqrt((u^2 + m)(1 - m - u^2)) = (x^2 - y^2) R_F(A^2, B^2, C^2),

with A = x s_x c_y + y s_y c_x, B = x c_x s_y + y c_y s_x and C = x s_y c_y + y s_x c_x, where
s and c are sin and cos of half the lean at either speed (DLMF 19.29.19): nothing in it cancels.

The paper's closed solution below eq01:nonlin_pendulum is misprinted twice: its scaled time has
sqrt(h^2 + 1) where the fourth root belongs, and it gives phi where the integral is the time.

The planar motion as a solution: the can falls flat or over, and nothing else moves.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipkm1, elliprf

from reference.equations.balancing_angle import short_of_one
from reference.equations.reaction_force import contact_from_centre
from reference.integrable.elliptic import squared_sn_cn
from reference.problem.can import Parameters
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, States, initial_states, states_of
from reference.smooth.extrema import Extrema, Run

# Where round-off says that the can would come to rest in balance, it comes this near, as m.
BALANCED = 1e-200


def frequency(parameters: Parameters) -> float:
    """Rate w at which the can falls away from balance, in sqrt(g/R)."""
    p = parameters
    return float(np.sqrt(np.sqrt(1 + p.h**2) / p.pendulum_inertia))


def lean_of(parameters: Parameters, phi: float) -> float:
    """Return phi - phi*, with all its digits near balance."""
    return -short_of_one(parameters.h, phi)


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """A speed u = |d'|/(2 w) of the motion, and sin and cos of half the lean there."""

    speed: float
    sine: float
    cosine: float


def instant(speed: float, lean: float) -> Instant:
    """Return the instant of a speed and a lean."""
    sine, cosine = abs(float(np.sin(lean / 2))), float(np.cos(lean / 2))
    return Instant(speed=float(speed), sine=sine, cosine=cosine)


def scaled_time(slow: Instant, fast: Instant, gained: float) -> float:
    """Return w t between two speeds; `gained` is the difference of their squares."""
    x, y = fast, slow
    first = x.speed * x.sine * y.cosine + y.speed * y.sine * x.cosine
    second = x.speed * x.cosine * y.sine + y.speed * y.cosine * x.sine
    third = x.speed * y.sine * y.cosine + y.speed * x.sine * x.cosine
    return gained * float(elliprf(first**2, second**2, third**2)) if gained else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Pendulum:
    """A planar motion in closed form.

    Attributes
    ----------
    parameters : Parameters
    constant : float
        m; negative where the can goes over its balancing angle.
    side : float
        Sign of the lean at release; if the can goes over, of phi'.
    since : float
        Time at release, in sqrt(R/g), from the turning back or the top.
    phi, phi_dot : float
        Release.
    """

    parameters: Parameters
    constant: float
    side: float
    since: float
    phi: float
    phi_dot: float

    def nutation(self, times: Floats) -> tuple[Floats, Floats]:
        """Return phi and phi' at the given times, shape (n,)."""
        w = frequency(self.parameters)
        m = self.constant if self.constant < 0 else max(self.constant, BALANCED)
        elapsed = w * (self.since + np.asarray(times))
        complementary = m if m > 0 else -m / (1 - m)
        scale = 1.0 if m > 0 else np.sqrt(1 - m)
        fraction = np.minimum(scale * np.abs(elapsed) / ellipkm1(complementary), 1.0)
        sn2, cn2 = (
            squares[:, 0] for squares in squared_sn_cn(fraction[:, None], np.array([complementary]))
        )
        dn2 = cn2 + complementary * sn2
        if m > 0:
            sine2, speed2 = m / dn2, (1 - m) * m * sn2 / dn2
            of_lean, of_speed = np.full_like(elapsed, self.side), self.side * np.sign(elapsed)
        else:
            sine2 = complementary * sn2 / dn2
            speed2 = sine2 - m
            of_lean, of_speed = self.side * np.sign(elapsed), np.full_like(elapsed, self.side)
        lean = 2 * of_lean * np.arcsin(np.minimum(np.sqrt(sine2), 1.0))
        lean_dot = 2 * w * of_speed * np.sqrt(speed2)
        return np.asarray(self.parameters.balancing_angle + lean), np.asarray(lean_dot)

    def time_at(self, phi: float) -> float:
        """Return when the nutation is `phi`, on the way away from the balancing angle."""
        w, m = frequency(self.parameters), self.constant
        start, lean = (lean_of(self.parameters, angle) for angle in (self.phi, phi))
        release = instant(abs(self.phi_dot) / (2 * w), start)
        # the difference of the squares of sines, as a product
        gained = float(np.sin((phi - self.phi) / 2) * np.sin((phi - self.phi) / 2 + start))
        if start * lean > 0 and self.phi_dot * lean >= 0:
            end = instant(np.sqrt(release.speed**2 + gained), lean)
            return scaled_time(release, end, gained) / w
        if m < 0:
            end = instant(np.sqrt(np.sin(lean / 2) ** 2 - m), lean)
        else:
            end = instant(np.sqrt(release.speed**2 + gained), lean)
        return _since_extremum(m, end) / w - self.since


def planar_motion(parameters: Parameters, phi: float, phi_dot: float = 0.0) -> Pendulum:
    """Return the planar motion from a release."""
    w = frequency(parameters)
    lean = lean_of(parameters, phi)
    release = instant(abs(phi_dot) / (2 * w), lean)
    m = (release.sine - release.speed) * (release.sine + release.speed)
    outward = 1.0 if lean * phi_dot > 0 else -1.0
    return Pendulum(
        parameters=parameters,
        constant=m,
        side=float(np.copysign(1.0, phi_dot if m < 0 else lean)),
        since=outward * _since_extremum(m, release) / w,
        phi=phi,
        phi_dot=phi_dot,
    )


def _since_extremum(m: float, end: Instant) -> float:
    """Return w t from the turning back, or from the top."""
    if m < 0:
        return scaled_time(
            Instant(speed=float(np.sqrt(-m)), sine=0.0, cosine=1.0), end, end.sine**2
        )
    least = max(m, BALANCED)
    turn = Instant(speed=0.0, sine=float(np.sqrt(least)), cosine=float(np.sqrt(1 - least)))
    return scaled_time(turn, end, end.speed**2)


SAMPLES = 200


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
    balanced = problem.phi == p.balancing_angle and problem.phi_dot == 0
    arrives = motion.constant == 0 and problem.phi_dot * motion.side < 0
    if problem.bounces is not None and (balanced or arrives):
        # a double is never quite in balance, and stays there as long as its last digit lets it
        outcome, t_end = Outcome.STEADY, 2 * np.pi / frequency(p)
    if problem.duration is not None and problem.duration < t_end:
        outcome, t_end = Outcome.FINISHED, problem.duration
    track = Extrema(
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
