"""The exact motion of the paper's release, from `reference`."""

from functools import cache

import numpy as np

from harness.paper.audit import paper_can
from reference import PAPER_CAN, Problem, Solution, solve


@cache
def bounce() -> Solution:
    """One bounce with the contact locus."""
    return solve(
        Problem(
            parameters=PAPER_CAN,
            phi=float(paper_can.PHI),
            psi_dot=float(paper_can.PSI_DOT),
            theta_dot=float(paper_can.THETA_DOT),
            bounces=1,
        ),
        outputs={"contact_locus"},
    )


@cache
def reduced_bounce() -> Solution:
    """Return one bounce of the same release by the reduced equation."""
    return solve(bounce().problem, model="reduced")


@cache
def turning() -> float:
    """Sense in which the contact locus bends during the bounce: 1 anticlockwise, -1 clockwise."""
    solution = bounce()
    states = solution.at(solution.grid())
    if states.x is None or states.y is None:
        raise ValueError("the contact locus was asked for and is missing")
    inside = states.phi < 10 * states.phi.min()
    dx, dy = np.diff(states.x[inside]), np.diff(states.y[inside])
    headings = np.unwrap(np.arctan2(dy, dx))
    return float(np.sign(headings[-1] - headings[0]))


@cache
def radius() -> float:
    """Radius of the contact locus at the bottom of the bounce: length over change of heading."""
    solution = bounce()
    states = solution.at(solution.grid())
    if states.x is None or states.y is None:
        raise ValueError("the contact locus was asked for and is missing")
    inside = states.phi < 3 * states.phi.min()
    dx, dy = np.diff(states.x[inside]), np.diff(states.y[inside])
    headings = np.unwrap(np.arctan2(dy, dx))
    return float(np.hypot(dx, dy)[1:].sum() / abs(headings[-1] - headings[0]))
