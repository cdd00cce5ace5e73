"""Angular momenta of the can, and what the first integrals of rolling have to do with them.

About the symmetry axis and about the vertical (eq01:ang_mom_B, eq01:ang_mom_G), per m R sqrt(g R):

    H_B = c (Psi C + Theta),        H_G = a Psi S^2 + C H_B.

Without friction both are conserved. Rolling conserves K and B of `reference.frobenius` instead,
and as phi goes to 0

    B_0 = k c_p/(2 c) H_B + O(phi),       B_{-2} = (H_G - H_B)/a + O(phi):

the first integrals are the two momenta of a nearly flat can. The paper prints the first, with
Phi for Psi in eq01:ang_mom_B, and finds the second less clear; here it is a limit with a test.
"""

import numpy as np

from reference.parameters import Parameters
from reference.states import Floats, States


def axial_momentum(states: States, parameters: Parameters) -> Floats:
    """H_B, shape (n,), in m R sqrt(g R)."""
    tilt = 2 * np.sin(states.phi / 2) ** 2
    return np.asarray(parameters.c * (states.spin - states.psi_dot * tilt))


def vertical_momentum(states: States, parameters: Parameters) -> Floats:
    """H_G, shape (n,), in m R sqrt(g R)."""
    S, C = np.sin(states.phi), np.cos(states.phi)
    own = parameters.a * states.psi_dot * S**2
    return np.asarray(own + C * axial_momentum(states, parameters))
