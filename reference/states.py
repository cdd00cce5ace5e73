"""The states of a can at many instants."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from reference.problem import Problem

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class States:
    """States on a grid of n instants; every field has shape (n,).

    Angles in rad, rates in sqrt(g/R), lengths in R. `spin` is psi' + theta': near the flat state
    each of the two rates is huge and their sum is not, so it is carried by itself; formulas that
    need the sum must use it and not add the rates. `x`, `y` locate the contact point, with the
    centre of mass above (0, 0) at release; they are None unless the contact locus was asked for.
    """

    phi: Floats
    phi_dot: Floats
    psi: Floats
    psi_dot: Floats
    theta: Floats
    theta_dot: Floats
    spin: Floats
    x: Floats | None = None
    y: Floats | None = None


def initial_states(problem: Problem) -> States:
    """State at release, shape (1,), without the contact point."""

    def one(value: float) -> Floats:
        return np.array([value], dtype=float)

    return States(
        phi=one(problem.phi),
        phi_dot=one(problem.phi_dot),
        psi=one(problem.psi),
        psi_dot=one(problem.psi_dot),
        theta=one(problem.theta),
        theta_dot=one(problem.theta_dot),
        spin=one(problem.psi_dot + problem.theta_dot),
    )
