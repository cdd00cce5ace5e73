"""Which way the can turns, over releases (fig01:left_or_right)."""

import numpy as np

from harness.core.report_model import Figure, Panel
from harness.paper.gallery.release import (
    FIFTH_CURVE,
    FOURTH_CURVE,
    PHI,
    SECOND,
    SECOND_CURVE,
    line,
    points,
)
from reference import PAPER_CAN
from reference.asymptotic.matched import boundary_rotation
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
    return Figure(
        name="fig01-left_or_right",
        title="Which way the can turns",
        seen=(
            f"Of {int(cycles.bounced.sum())} releases at phi = pi/100, {agrees:.2%} turn the way "
            f"that the line theta' = {boundary_rotation(can, 1.0):.3f} psi' says. On it B_-2 "
            "vanishes to leading order."
        ),
        panels=(
            Panel(
                title="Sign of the turn",
                x_label="psi' at release [rad/s]",
                y_label="theta' at release [rad/s]",
                series=(
                    points("psi grows", x[left], y[left], FIFTH_CURVE),
                    points("psi falls", x[right], y[right], SECOND_CURVE),
                    line("B_-2 = 0 to leading order", edge, border, FOURTH_CURVE),
                ),
            ),
        ),
        columns=1,
    )
