"""Derivatives of the rates of a motion by its state, along imaginary steps.

J v = Im f(y + i s v)/s is exact to round-off (Squire and Trapp, SIAM Review 40, 1998).
"""

from collections.abc import Callable

import numpy as np

from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import LEAN, PSI, ROWS, TIME, TOTAL, U1, U2, W1, W2, W3, sizes
from reference.problem.states import Floats

# What the rates depend on, and what they move: all but the place and the works.
CORE = np.array([LEAN, W1, W2, W3, PSI, TOTAL, TIME, U1, U2])
NUMBER = {row: place for place, row in enumerate(CORE.tolist())}
# Imaginary steps, over the size of what is stepped: nothing is subtracted, so as small as may be.
STEP = 1e-40
Quantity = Callable[[GeneralEquations, Floats, Mode], Floats]
"""From equations, states of shape (13, n), real or complex, and their mode to values (n,)."""


def by_state(quantity: Quantity, equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the derivatives of a quantity of a state, shape (13, 1), by the rows `CORE`, (9,)."""
    step = STEP * sizes(CORE, y[CORE])[:, 0]
    columns = np.repeat(y, CORE.size, axis=1).astype(complex)
    columns[CORE, np.arange(CORE.size)] += 1j * step
    return np.asarray(quantity(equations, columns, mode).imag / step)


def jacobian(equations: GeneralEquations, y: Floats, mode: Mode) -> tuple[Floats, Floats]:
    """Return rates of the rows `CORE`, shape (9, n), and their derivatives, shape (9, 9, n).

    Parameters
    ----------
    equations : GeneralEquations
    y : ndarray, shape (13, n)
    mode : Mode
    """
    k, n = CORE.size, y.shape[1]
    step = STEP * sizes(CORE, y[CORE])
    columns = np.repeat(y[:, None, :], k, axis=1).astype(complex)
    columns[CORE, np.arange(k)] += 1j * step
    values = equations.rates(columns.reshape(ROWS, k * n), mode, along=False)
    values = values.reshape(ROWS, k, n)[CORE]
    return values[:, 0].real, values.imag / step
