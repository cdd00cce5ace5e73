"""The release of the paper and others of its can, as problems of `reference`, each solved once."""

import math
from functools import cache

import numpy as np

from harness.core.trajectory import Floats
from reference import PAPER_CAN, Problem, Solution, States, solve
from reference.asymptotic.expansions import expansions

SECOND = math.sqrt(0.037 / 9.81)
"""sqrt(R/g) in s: the paper prints releases in rad/s, and no g."""
PHI = math.pi / 100
PSI_DOT, THETA_DOT = 0.1001, -0.1
INNER = 0.1
"""The paper colours phi < phi_0/10 as the inner region."""
STEEP = (1e-8, 1e-10)
"""Values of eps between which a rate is observed."""


def problem(
    psi_dot: float = PSI_DOT,
    phi: float = PHI,
    theta_dot: float = THETA_DOT,
    *,
    phi_dot: float = 0.0,
    bounces: int | None = None,
    duration: float | None = None,
) -> Problem:
    """Return a release of the paper's can, rates in rad/s."""
    return Problem(
        parameters=PAPER_CAN,
        phi=phi,
        phi_dot=phi_dot * SECOND,
        psi_dot=psi_dot * SECOND,
        theta_dot=theta_dot * SECOND,
        bounces=bounces,
        duration=duration,
    )


@cache
def of_constants(
    epsilon: float, zeta: float, *, bounces: int | None = None, duration: float | None = None
) -> Problem:
    """Return the release at pi/100 with B_-2 = eps^(1/2) and B_0 = zeta eps^(1/2)."""
    known, at, two = expansions(PAPER_CAN), np.array([PHI]), math.sqrt(epsilon)
    pairs = ((known.psi_zero, known.psi_minus_two), (known.spin_zero, known.spin_minus_two))
    rate, spin = (two * (zeta * float(x.at(at)[0]) + float(y.at(at)[0])) for x, y in pairs)
    return Problem(
        parameters=PAPER_CAN,
        phi=PHI,
        psi_dot=rate,
        theta_dot=spin - rate,
        bounces=bounces,
        duration=duration,
    )


@cache
def solved(posed: Problem, model: str = "rolling", *, locus: bool = False) -> Solution:
    """Solve a problem once."""
    outputs = frozenset({"contact_locus"}) if locus else frozenset[str]()
    return solve(posed, model=model, outputs=outputs)


def bounce() -> Solution:
    """Return one bounce of the paper's release, with the contact locus."""
    return solved(problem(bounces=1), locus=True)


def contact_locus(states: States) -> tuple[Floats, Floats]:
    """Return the place of the contact point on the plane.

    Raises
    ------
    ValueError
        If the states are of a solution without the contact locus.
    """
    if states.x is None or states.y is None:
        raise ValueError("the contact locus was asked for and is missing")
    return states.x, states.y


def reduced_bounce() -> Solution:
    """Return one bounce of the same release by the reduced equation."""
    return solved(problem(bounces=1), "reduced")
