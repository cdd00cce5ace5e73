"""The can on a plane without friction.

No force acts sideways, so the centre of mass keeps its horizontal velocity v, and both momenta of
`reference.equations.frictionless` are conserved: Psi = (H_G - C H_B)/(a S^2). What is left is

    (a + (C - h S)^2) Phi' = (C - h S)(S + h C) Phi^2 + (a - c) S C Psi^2 - c S Theta Psi - (C - h
    S).

The paper's equation of motion in its appendix on slipping prints Psi for Psi^2 in the second term.
For small nutation (app01:Phi_reduced_slip) the repulsion is alpha_3 epsilon/phi^3 with
alpha_3 = (zeta - 1)^2/(a (a + 1)), and the angle of turn pi sqrt((a + 1)/a).

The slip at the release, mostly none, sets v; the centre is over v t.

Angular momenta of the can, and their relation to the first integrals of rolling.

About the symmetry axis and about the vertical (eq01:ang_mom_B, eq01:ang_mom_G), per m R sqrt(g R):

    H_B = c (Psi C + Theta),        H_G = a Psi S^2 + C H_B.

Without friction both are conserved. Rolling conserves K and B of `reference.integrable.frobenius`
instead, and as phi goes to 0

    B_0 = k c_p/(2 c) H_B + O(phi),       B_{-2} = (H_G - H_B)/a + O(phi),

the one at finite rates, the other where Psi grows as phi^-2: the first integrals are the two
momenta of a nearly flat can. The paper prints the first, with Phi for Psi in eq01:ang_mom_B, and
finds the second less clear; here each is a limit with a test.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.equations.contact_laws import Contact, Kind, Mode, Phase
from reference.equations.reaction_force import contact_from_middle, middle_velocity
from reference.equations.state_vector import LEAN, PSI, ROWS, TIME, TOTAL, W2, Angles, Index
from reference.nonsmooth.hybrid_integrator import HybridIntegrator
from reference.problem.can import Parameters
from reference.problem.effects import IDEAL
from reference.problem.problem import Problem
from reference.problem.states import Floats, States, initial_states
from reference.smooth.extrema import Path, Run
from reference.smooth.scipy_ivp import SCIPY_METHODS, follow


def axial_momentum(states: States, parameters: Parameters) -> Floats:
    """H_B, shape (n,), in m R sqrt(g R)."""
    tilt = 2 * np.sin(states.phi / 2) ** 2
    return np.asarray(parameters.c * (states.spin - states.psi_dot * tilt))


def vertical_momentum(states: States, parameters: Parameters) -> Floats:
    """H_G, shape (n,), in m R sqrt(g R)."""
    S, C = np.sin(states.phi), np.cos(states.phi)
    own = parameters.a * states.psi_dot * S**2
    return np.asarray(own + C * axial_momentum(states, parameters))


CORE = np.array([LEAN, W2])


def nutation_acceleration_without_friction(
    phi: float, phi_dot: float, psi_dot: float, theta_dot: float, parameters: Parameters
) -> float:
    """Phi'' without friction."""
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    reach, height = C - p.h * S, S + p.h * C
    drive = (
        reach * height * phi_dot**2
        + (p.a - p.c) * S * C * psi_dot**2
        - p.c * S * theta_dot * psi_dot
        - reach
    )
    return float(drive / (p.a + reach**2))


def leading_turn_without_friction(parameters: Parameters) -> float:
    """Return the angle of turn in the limit of a hard bounce, pi sqrt((a + 1)/a), in rad.

    From the term alpha_3/phi^3 of app01:Phi_reduced_slip, as eq01:angle_of_turn follows from
    a_3/phi^3 of eq01:Phi_reduced.
    """
    return float(np.pi * np.sqrt((parameters.a + 1) / parameters.a))


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionlessEquations:
    """One degree of freedom, in the time of `reference.equations.state_vector`.

    Attributes
    ----------
    parameters : Parameters
    axial, momentum_gap : float
        H_B, and H_G - H_B, which sets the turn of a bounce.
    """

    parameters: Parameters
    axial: float
    momentum_gap: float

    @property
    def mu(self) -> float:
        """No cone to leave: where the rim slips follows from the angles."""
        return np.inf

    @property
    def mu_static(self) -> float:
        """No friction."""
        return 0.0

    @property
    def patch(self) -> float:
        """A point: turning about the normal meets no friction."""
        return 0.0

    @property
    def contour(self) -> float:
        """No friction along the rim."""
        return 0.0

    @property
    def fluid(self) -> bool:
        """Nothing else opposes motion along the rim."""
        return False

    @property
    def drilling(self) -> float:
        """No arm."""
        return 0.0

    @property
    def resistance(self) -> float:
        """No arm either."""
        return 0.0

    @property
    def bilateral_normal(self) -> bool:
        """Return whether the plane may pull: it may not."""
        return False

    def core(self, mode: Mode) -> Index:
        """Phi and its rate."""
        del mode
        return CORE

    def turning(self, y: Floats) -> Floats:
        """Return the angular velocity about the normal, shape (n,)."""
        at = Angles.of(y[LEAN])
        w1, w3 = self.momenta(at)
        return np.asarray(at.S * w1 + at.C * w3)

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return the normal force, times S."""
        del mode
        p, at, w2 = self.parameters, Angles.of(y[LEAN]), y[W2]
        w1, w3 = self.momenta(at)
        reach, height = at.C - p.h * at.S, at.S + p.h * at.C
        own = ((p.c / p.a) * at.S * w3 - at.C * w1) * w1
        normal_mobility = 1 + reach * reach / p.a
        N = (at.S - reach * own - at.S * height * w2 * w2) / normal_mobility
        zero = np.zeros_like(w2)
        return Contact(
            force=np.array([zero, zero, N]),
            moment=np.array([zero, zero, zero]),
            # of frame B too, which turns with it
            turning=np.array([zero, own + reach * N / p.a, zero]),
            slipping=np.array([zero, zero]),
            normal_mobility=normal_mobility,
        )

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (13, n); the place follows from the angles."""
        del along
        at = Angles.of(y[LEAN])
        w1, w3 = self.momenta(at)
        out = np.zeros_like(y)
        out[LEAN] = -y[W2]
        out[W2] = self.contact(y, mode).turning[1]
        out[PSI], out[TOTAL], out[TIME] = w1, at.S * (w3 + at.T * w1), at.S
        return out

    def momenta(self, at: Angles) -> tuple[Floats, float]:
        """W1 and w3."""
        return (self.momentum_gap / at.S + at.T * self.axial) / self.parameters.a, (
            self.axial / self.parameters.c
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingPath:
    """A path with the centre of mass over v t: the contact point follows from the angles."""

    inner: Path
    equations: FrictionlessEquations
    drift: Floats

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        return self._with_contact(np.asarray(times, dtype=float), self.inner.at(times))

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states the solver itself has."""
        times, states = self.inner.nodes()
        return times, self._with_contact(times, states)

    def _with_contact(self, times: Floats, states: States) -> States:
        p = self.equations.parameters
        lean = np.log(np.tan(states.phi / 2))
        at = Angles.of(lean)
        w1, w3 = self.equations.momenta(at)
        psi_dot = w1 / at.S
        states = replace(
            states, psi_dot=psi_dot, theta_dot=w3 - psi_dot * at.C, spin=w3 + w1 * at.T
        )
        contact = contact_from_middle(states, p)
        y = np.zeros((ROWS, lean.size))
        y[LEAN], y[W2] = lean, -states.phi_dot
        normal = self.equations.contact(y, Mode()).force[2] / at.S
        return replace(
            states,
            x=contact[:, 0] + self.drift[0] * times,
            y=contact[:, 1] + self.drift[1] * times,
            slip=self.drift - middle_velocity(replace(states, slip=None), p, IDEAL)[:, :2],
            force=np.stack([0 * normal, 0 * normal, normal], axis=-1),
        )


def solve_frictionless(problem: Problem, *, method: str, rtol: float) -> Run:
    """Integrate the can without friction, with the rates of psi and theta from the two momenta."""
    p = problem.parameters
    release = initial_states(problem)
    H_B = float(axial_momentum(release, p)[0])
    tilt = 2 * np.sin(problem.phi / 2) ** 2
    momentum_gap = p.a * problem.psi_dot * np.sin(problem.phi) ** 2 - tilt * H_B
    equations = FrictionlessEquations(parameters=p, axial=H_B, momentum_gap=float(momentum_gap))
    if method not in SCIPY_METHODS:
        run: Run = HybridIntegrator(replace(problem, slip=(0.0, 0.0)), equations, locus=False).run()
    else:
        run = _step_in_time(problem, H_B, method=method, rtol=rtol)
    drift = middle_velocity(release, p, problem.effects)[0, :2]
    path = SlidingPath(inner=run.path, equations=equations, drift=drift)
    there = path.at(run.track.times)
    extrema = replace(run.track.extrema, x=there.x, y=there.y, slip=there.slip, force=there.force)
    return Run(
        path=path,
        track=replace(run.track, extrema=extrema),
        steps=run.steps,
        evaluations=run.evaluations,
        phases=(Phase(kind=Kind.SLIP, start=0.0, end=run.track.t_end),),
    )


def _step_in_time(problem: Problem, H_B: float, *, method: str, rtol: float) -> Run:
    """Integrate with one of scipy's methods in the raw variables."""
    p = problem.parameters
    H_G = float(vertical_momentum(initial_states(problem), p)[0])

    def field(_t: float, y: Floats) -> Floats:
        phi, Phi = y[:2].tolist()
        S, C = np.sin(phi), np.cos(phi)
        Psi = (H_G - C * H_B) / (p.a * S * S)
        Theta = H_B / p.c - Psi * C
        Phi_dot = nutation_acceleration_without_friction(phi, Phi, Psi, Theta, p)
        # d/dt of the two rates, so that the state has the same six entries as rolling
        Psi_dot = Phi * (H_B / (p.a * S) - 2 * Psi * C / S)
        Theta_dot = Psi * S * Phi - Psi_dot * C
        return np.array([Phi, Phi_dot, Psi_dot, Theta_dot, Psi, Theta])

    start = [problem.phi, problem.phi_dot, problem.psi_dot, problem.theta_dot]
    start += [problem.psi, problem.theta]
    return follow(problem, field, start, method=method, rtol=rtol, unilateral=True)
