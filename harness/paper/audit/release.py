"""The exact motion of the paper's release, from `reference`."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from harness.paper.audit import paper_can
from reference import PAPER_CAN, Problem, Solution, solve

Floats = NDArray[np.float64]


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
def _headings(below: float) -> tuple[Floats, float]:
    """Return headings of the contact locus below a nutation, and the length of its way."""
    solution = bounce()
    states = solution.at(solution.grid())
    if states.x is None or states.y is None:
        raise ValueError("the contact locus was asked for and is missing")
    inside = states.phi < below
    dx, dy = np.diff(states.x[inside]), np.diff(states.y[inside])
    return np.unwrap(np.arctan2(dy, dx)), float(np.hypot(dx, dy)[1:].sum())


def turning() -> float:
    """Sense in which the contact locus bends during the bounce: 1 anticlockwise, -1 clockwise."""
    headings, _ = _headings(10 * bounce().bounces[0].phi_min)
    return float(np.sign(headings[-1] - headings[0]))


def radius() -> float:
    """Radius of the contact locus at the bottom of the bounce: length over change of heading."""
    headings, length = _headings(3 * bounce().bounces[0].phi_min)
    return float(length / abs(headings[-1] - headings[0]))


def arc() -> float:
    """Turn of the contact locus below phi_0/10, in degrees."""
    headings, _ = _headings(float(paper_can.PHI) / 10)
    return float(np.degrees(abs(headings[-1] - headings[0])))
