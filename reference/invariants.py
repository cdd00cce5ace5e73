"""What rolling conserves: the energy.

Per m g R, with the spin s = Psi + Theta and the axial rate w = Psi cos phi + Theta:

    E = (a (Psi^2 S^2 + Phi^2) + c w^2 + |v_G|^2)/2 + S + h C.
"""

import numpy as np

from reference.parameters import Parameters
from reference.rolling import angular_velocity
from reference.states import Floats, States


def energy(states: States, parameters: Parameters) -> Floats:
    """Energy over m g R, zero of height in the plane.

    Parameters
    ----------
    states : States
        Fields of shape (n,).
    parameters : Parameters

    Returns
    -------
    ndarray, shape (n,)
    """
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    w = angular_velocity(states)
    aside = states.spin - states.psi_dot * (2 * np.sin(states.phi / 2) ** 2 + p.h * S)
    kinetic = (
        p.a * w[..., 0] ** 2 + (p.a + 1 + p.h**2) * w[..., 1] ** 2 + p.c * w[..., 2] ** 2 + aside**2
    ) / 2
    return np.asarray(kinetic + S + p.h * C, dtype=float)
