"""Which way the can turns, the path of the contact point, and the friction of rolling."""

import math

import numpy as np

from harness.core.report_model import Figure
from harness.paper.gallery.curves import TIME, figure, line, panel, points, sampled, where
from harness.paper.release import INNER, PHI, SECOND, contact_locus, problem, solved
from reference import PAPER_CAN, Problem
from reference.asymptotic.matched import boundary_rotation, friction_bound
from reference.equations.reaction_force import friction_ratio
from reference.integrable.cycle import exact_bounces

COLUMNS, ROWS = 118, 66
"""Releases across and up: as many as there is room for marks side by side."""
WIDEST, HIGHEST = 1.0, 5.0
"""Range of the rates in rad/s."""


def sign_map() -> Figure:
    """Compute the turn of each release exactly and mark its sign."""
    across = WIDEST * (2 * np.arange(COLUMNS) + 1 - COLUMNS) / COLUMNS
    up = HIGHEST * (2 * np.arange(ROWS) + 1 - ROWS) / ROWS
    x, y = (part.ravel() for part in np.meshgrid(across, up))
    can = PAPER_CAN
    cycles = exact_bounces(
        a=can.a, c=can.c, h=can.h, phi=PHI, psi_dot=x * SECOND, theta_dot=y * SECOND
    )
    left = cycles.bounced & (cycles.angle_of_turn > 0)
    right = cycles.bounced & (cycles.angle_of_turn < 0)
    edge = np.array([-WIDEST, WIDEST])
    border = boundary_rotation(can, 1.0) * edge
    agrees = float(
        np.mean((x * boundary_rotation(can, 1.0) > y)[cycles.bounced] == left[cycles.bounced])
    )
    return figure(
        "fig01-left_or_right",
        "Which way the can turns",
        (
            f"Of {int(cycles.bounced.sum())} releases at phi = pi/100, {agrees:.2%} turn the way "
            f"that the line theta' = {boundary_rotation(can, 1.0):.3f} psi' says. On it B_-2 "
            "vanishes to leading order."
        ),
        panel(
            "Sign of the turn",
            "psi' at release [rad/s]",
            "theta' at release [rad/s]",
            points("psi grows", x[left], y[left], 5),
            points("psi falls", x[right], y[right], 2),
            line("B_-2 = 0 to leading order", edge, border, 4),
        ),
    )


BALANCED = PAPER_CAN.balancing_angle
LOCI: tuple[tuple[str, Problem], ...] = (
    ("a) small phi, small eps: arcs of circles", problem(bounces=5)),
    (
        "b) near balance, large theta': petals",
        problem(psi_dot=0.0, phi=BALANCED - 1e-5, theta_dot=2.0, bounces=4),
    ),
    ("c) small phi, large eps: wobbles", problem(psi_dot=0.72667, theta_dot=7.0, duration=24.0)),
    ("d) near the boundary: cusps", problem(psi_dot=1.7267, theta_dot=7.0, duration=24.0)),
)


def loci() -> Figure:
    """Four contact loci, the bounce in a colour of its own (fig01:contact_pt_motion)."""
    panels = []
    widths = []
    for title, posed in LOCI:
        solution = solved(posed, locus=True)
        _, s = sampled(solution)
        x, y = contact_locus(s)
        low = s.phi < INNER * posed.phi
        panels.append(
            panel(
                title,
                "x [R]",
                "y [R]",
                line("phi >= phi_0/10", where(~low, x), where(~low, y)),
                line("phi < phi_0/10", where(low, x), where(low, y), 2),
                equal=True,
            )
        )
        widths.append(float(np.hypot(np.ptp(x), np.ptp(y))))
    turn = math.degrees(solved(LOCI[0][1], locus=True).bounces[0].angle_of_turn)
    return figure(
        "fig01-contact_pt_motion",
        "The contact locus in four regimes",
        (
            f"In a) each bounce runs {turn:.0f} degrees along a circle of the can's own radius, "
            "anticlockwise as B_-2 > 0; in b) the can rolls far and straight near balance and "
            f"turns in each fall; the figure is {widths[1]:.0f} R across. c) and d) roll round "
            "circles, with wobbles and with cusps where theta' changes its sign."
        ),
        *panels,
    )


def friction() -> Figure:
    """Draw the friction ratio over two bounces (fig01:friction)."""
    posed = problem(bounces=2)
    solution = solved(posed)
    t, s = sampled(solution)
    ratio = friction_ratio(s, PAPER_CAN)
    low = s.phi < INNER * posed.phi
    peak = solution.bounces[0].peak_friction_ratio
    bound = friction_bound(PAPER_CAN)
    ends = np.array([0.0, solution.t_end])
    return figure(
        "fig01-friction",
        "The friction that rolling asks for",
        (
            f"The ratio peaks at {peak:.4f} in the bounce, where h/a_p = {bound:.4f} is its "
            f"leading value. Elsewhere it is at most {ratio[~low].max():.3f}."
        ),
        panel(
            "|F|/N",
            TIME,
            "|F|/N",
            line("phi >= phi_0/10", where(~low, t), where(~low, ratio)),
            line("phi < phi_0/10", where(low, t), where(low, ratio), 2),
            line("h/a_p", ends, np.array([bound, bound]), 4, dashed=True),
        ),
    )
