"""The path of the contact point, and the friction that rolling asks for."""

import math

import numpy as np

from harness.core.report_model import Figure, Panel
from harness.paper.gallery.release import (
    FOURTH_CURVE,
    OURS,
    SECOND_CURVE,
    TIME,
    line,
    problem,
    sampled,
    solved,
    where,
)
from reference import PAPER_CAN, Problem
from reference.asymptotic.matched import friction_bound
from reference.equations.reaction_force import friction_ratio

BOUNCE = SECOND_CURVE
BALANCED = PAPER_CAN.balancing_angle
RELEASES: tuple[tuple[str, Problem], ...] = (
    ("a) small phi, small eps: arcs of circles", problem(bounces=5)),
    (
        "b) near balance, large theta': petals",
        problem(psi_dot=0.0, phi=BALANCED - 1e-5, theta_dot=2.0, bounces=4),
    ),
    (
        "c) small phi, large eps: wobbles",
        problem(psi_dot=0.72667, theta_dot=7.0, duration=24.0),
    ),
    ("d) near the boundary: cusps", problem(psi_dot=1.7267, theta_dot=7.0, duration=24.0)),
)


def loci() -> Figure:
    """Four contact loci, the bounce in a colour of its own (fig01:contact_pt_motion)."""
    panels = []
    told = []
    for title, posed in RELEASES:
        solution = solved(posed, locus=True)
        _, s = sampled(solution)
        if s.x is None or s.y is None:
            raise ValueError(f"no contact locus for {title}")
        low = s.phi < posed.phi / 10
        panels.append(
            Panel(
                title=title,
                x_label="x [R]",
                y_label="y [R]",
                series=(
                    line("phi >= phi_0/10", where(~low, s.x), where(~low, s.y), OURS),
                    line("phi < phi_0/10", where(low, s.x), where(low, s.y), BOUNCE),
                ),
                equal=True,
            )
        )
        told.append(float(np.hypot(np.ptp(s.x), np.ptp(s.y))))
    turn = math.degrees(solved(RELEASES[0][1], locus=True).bounces[0].angle_of_turn)
    return Figure(
        name="fig01-contact_pt_motion",
        title="The contact locus in four regimes",
        seen=(
            f"In a) each bounce runs {turn:.0f} degrees along a circle of the can's own radius, "
            "anticlockwise as B_-2 > 0; in b) the can rolls far and straight near balance and "
            f"turns in each fall; the figure is {told[1]:.0f} R across. c) and d) roll round "
            "circles, with wobbles and with cusps where theta' changes its sign."
        ),
        panels=tuple(panels),
        columns=2,
    )


def friction() -> Figure:
    """Draw the friction ratio over two bounces (fig01:friction)."""
    posed = problem(bounces=2)
    solution = solved(posed)
    t, s = sampled(solution)
    ratio = friction_ratio(s, PAPER_CAN)
    low = s.phi < posed.phi / 10
    peak = solution.bounces[0].peak_friction_ratio
    bound = friction_bound(PAPER_CAN)
    ends = np.array([0.0, solution.t_end])
    return Figure(
        name="fig01-friction",
        title="The friction that rolling asks for",
        seen=(
            f"The ratio peaks at {peak:.4f} in the bounce, where h/a_p = {bound:.4f} is its "
            f"leading value. Elsewhere it is at most {ratio[~low].max():.3f}."
        ),
        panels=(
            Panel(
                title="|F|/N",
                x_label=TIME,
                y_label="|F|/N",
                series=(
                    line("phi >= phi_0/10", where(~low, t), where(~low, ratio), OURS),
                    line("phi < phi_0/10", where(low, t), where(low, ratio), BOUNCE),
                    line("h/a_p", ends, np.array([bound, bound]), FOURTH_CURVE, dashed=True),
                ),
            ),
        ),
        columns=1,
    )
