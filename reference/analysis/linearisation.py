"""Derivatives of the rates of a motion by its state, along imaginary steps.

J v = Im f(y + i s v)/s is exact to round-off (Squire and Trapp, SIAM Review 40, 1998).
"""

from collections.abc import Callable

import numpy as np

from reference.compliant.equations import DEPTH, RISE
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import (
    LEAN,
    PSI,
    ROWS,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
    Index,
    sizes,
)
from reference.problem.states import Floats

# What the rates depend on, and what they move: all but the place and the works.
CORE = np.array([LEAN, W1, W2, W3, PSI, TOTAL, TIME, U1, U2])
CORE_WITH_DEPTH = np.append(CORE, [DEPTH, RISE])
NUMBER = {row: place for place, row in enumerate(CORE_WITH_DEPTH.tolist())}
# Imaginary steps, over the size of what is stepped: nothing is subtracted, so as small as may be.
STEP = 1e-40


class UndecidedError(ArithmeticError):
    """A derivative that does not exist; says why."""


Quantity = Callable[[GeneralEquations, Floats, Mode], Floats]
"""From equations, states of shape (rows, n), real or complex, and their mode to values (n,)."""


def core_of(y: Floats) -> Index:
    """Return the rows of a state by which derivatives are taken: k = 9 of 13, or 11 of 15."""
    return CORE if len(y) == ROWS else CORE_WITH_DEPTH


def stepped_by_row(y: Floats) -> tuple[Floats, Floats]:
    """Return states of shape (rows, n), with each row of the core stepped.

    Returns
    -------
    columns : ndarray, shape (rows, k n)
        Complex; those of the first row first.
    step : ndarray, shape (k, n)
    """
    core, n = core_of(y), y.shape[1]
    step = np.full((core.size, n), STEP)
    step[: CORE.size] *= sizes(CORE, y[CORE].real)
    columns = np.repeat(y[:, None, :], core.size, axis=1).astype(complex)
    columns[core, np.arange(core.size)] += 1j * step
    return columns.reshape(len(y), -1), step


def by_state(quantity: Quantity, equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the derivatives of a quantity of a state, shape (rows, 1), by its core, (k,)."""
    columns, step = stepped_by_row(y)
    return np.asarray(quantity(equations, columns, mode).imag / step[:, 0])


def jacobian(equations: GeneralEquations, y: Floats, mode: Mode) -> tuple[Floats, Floats]:
    """Return rates of the core of states, shape (k, n), and their derivatives, shape (k, k, n).

    Parameters
    ----------
    equations : GeneralEquations
    y : ndarray, shape (rows, n)
    mode : Mode
    """
    core, n = core_of(y), y.shape[1]
    columns, step = stepped_by_row(y)
    values = equations.rates(columns, mode, along=False).reshape(len(y), core.size, n)[core]
    return values[:, 0].real, values.imag / step
