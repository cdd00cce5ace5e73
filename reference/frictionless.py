"""The can on a plane without friction.

No force acts sideways, so the centre of mass only rises and falls, and both momenta of
`reference.momenta` are conserved: Psi = (H_G - C H_B)/(a S^2). What is left is

    (a + (C - h S)^2) Phi' = (C - h S)(S + h C) Phi^2 + (a - c) S C Psi^2 - c S Theta Psi - (C - h S).

The paper's equation of motion in its appendix on slipping prints Psi for Psi^2 in the second term. For
small nutation (app01:Phi_reduced_slip) the repulsion is alpha_3 epsilon/phi^3 with
alpha_3 = (zeta - 1)^2/(a (a + 1)), and the angle of turn pi sqrt((a + 1)/a).
"""

import numpy as np
from scipy.integrate import DOP853

from reference.outcome import Outcome
from reference.parameters import Parameters
from reference.problem import Problem
from reference.run import Run
from reference.states import Floats, Snapshot
from reference.time_stepping import RightHandSide, follow


def nutation_acceleration_without_friction(
    phi: Floats, phi_dot: Floats, psi_dot: Floats, theta_dot: Floats, parameters: Parameters
) -> Floats:
    """phi'' without friction, shape (n,)."""
    p, S, C = parameters, np.sin(phi), np.cos(phi)
    reach, height = C - p.h * S, S + p.h * C
    drive = (
        reach * height * phi_dot**2
        + (p.a - p.c) * S * C * psi_dot**2
        - p.c * S * theta_dot * psi_dot
        - reach
    )
    return np.asarray(drive / (p.a + reach**2))


def leading_turn_without_friction(parameters: Parameters) -> float:
    """Angle of turn in the limit of a hard bounce, pi sqrt((a + 1)/a), in rad."""
    return float(np.pi * np.sqrt((parameters.a + 1) / parameters.a))
