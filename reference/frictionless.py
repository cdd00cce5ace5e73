"""The can on a plane without friction.

No force acts sideways, so the centre of mass only rises and falls, and both momenta of
`reference.momenta` are conserved: Psi = (H_G - C H_B)/(a S^2). What is left is

    (a + (C - h S)^2) Phi' = (C - h S)(S + h C) Phi^2 + (a - c) S C Psi^2 - c S Theta Psi - (C - h
    S).

The paper's equation of motion in its appendix on slipping prints Psi for Psi^2 in the second term.
For small nutation (app01:Phi_reduced_slip) the repulsion is alpha_3 epsilon/phi^3 with
alpha_3 = (zeta - 1)^2/(a (a + 1)), and the angle of turn pi sqrt((a + 1)/a).
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.contact import contact_from_centre
from reference.momenta import axial_momentum, vertical_momentum
from reference.parameters import Parameters
from reference.problem import Problem
from reference.run import Path, Run
from reference.states import Floats, States, initial_states
from reference.time_stepping import follow


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
    """Angle of turn in the limit of a hard bounce, pi sqrt((a + 1)/a), in rad."""
    return float(np.pi * np.sqrt((parameters.a + 1) / parameters.a))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingPath:
    """A path with the centre of mass over (0, 0): the contact point follows from the angles."""

    inner: Path
    parameters: Parameters
    H_B: float
    H_G: float

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        return self._with_contact(self.inner.at(times))

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states the solver itself has."""
        times, states = self.inner.nodes()
        return times, self._with_contact(states)

    def _with_contact(self, states: States) -> States:
        p, S, C = self.parameters, np.sin(states.phi), np.cos(states.phi)
        contact = contact_from_centre(states, p)
        psi_dot = (self.H_G - C * self.H_B) / (p.a * S**2)
        theta_dot = self.H_B / p.c - psi_dot * C
        spin = self.H_B / p.c + psi_dot * 2 * np.sin(states.phi / 2) ** 2
        return replace(
            states,
            psi_dot=psi_dot,
            theta_dot=theta_dot,
            spin=spin,
            x=contact[:, 0],
            y=contact[:, 1],
        )


def energy_without_friction(states: States, parameters: Parameters) -> Floats:
    """Energy over m g R of a can whose centre only rises and falls, shape (n,)."""
    p, S, C = parameters, np.sin(states.phi), np.cos(states.phi)
    turning = p.a * (states.psi_dot**2 * S**2 + states.phi_dot**2)
    axial = axial_momentum(states, p) ** 2 / p.c
    rising = (states.phi_dot * (C - p.h * S)) ** 2
    return np.asarray((turning + axial + rising) / 2 + S + p.h * C)


def solve_frictionless(problem: Problem, *, method: str, rtol: float) -> Run:
    """Integrate the can without friction, with the rates of psi and theta from the two momenta."""
    p = problem.parameters
    release = initial_states(problem)
    H_B = float(axial_momentum(release, p)[0])
    H_G = float(vertical_momentum(release, p)[0])

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
    run = follow(problem, field, [*start, problem.psi, problem.theta], method=method, rtol=rtol)
    return replace(run, path=SlidingPath(inner=run.path, parameters=p, H_B=H_B, H_G=H_G))
