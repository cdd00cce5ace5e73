"""The can itself, from computed poses: the fall from above, the equilibria from the side."""

import math

import numpy as np

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.paper.gallery.release import (
    FIFTH_CURVE,
    FOURTH_CURVE,
    OURS,
    SECOND_CURVE,
    THIRD_CURVE,
    line,
    points,
    problem,
    sampled,
    solved,
)
from reference import PAPER_CAN
from reference.equations.steady_motion import balanced_rotation, steady_rotation

H = PAPER_CAN.h
ROUND = np.linspace(0, 2 * np.pi, 181)


def body(phi: float, psi: float) -> tuple[Floats, Floats, Floats]:
    """Return both rims, the mantle's outline and the contact, from the contact point.

    Returns
    -------
    lower, upper : ndarray, shape (181, 3)
        The rims in R.
    axis : ndarray, shape (2, 3)
        From the centre of the lower face to that of the upper.
    """
    turn = np.array(
        [[math.cos(psi), -math.sin(psi), 0], [math.sin(psi), math.cos(psi), 0], [0, 0, 1]]
    )
    tilt = np.array(
        [[math.cos(phi), 0, -math.sin(phi)], [0, 1, 0], [math.sin(phi), 0, math.cos(phi)]]
    )
    rim = np.stack([np.cos(ROUND) + 1, np.sin(ROUND), np.zeros_like(ROUND)], axis=1)
    lift = np.array([0, 0, 2 * H])
    centre = np.array([[1.0, 0, 0], [1.0, 0, 2 * H]])
    return tuple((turn @ tilt @ part.T).T for part in (rim, rim + lift, centre))


def fall() -> Figure:
    """Before, in and after the bounce, from above; nutation enlarged (fig01:can_fall)."""
    solution = solved(problem(bounces=1), locus=True)
    t, s = sampled(solution)
    moments = (0.0, float(solution.minima[0]), solution.t_end)
    names = ("at release", "in the bounce", "risen again")
    titles = ("a) Tipped and let go", "b) The contact runs round the rim", "c) Risen again")
    turn = math.degrees(solution.bounces[0].angle_of_turn)
    states = solution.at(np.array(moments))
    if states.x is None or states.y is None or s.x is None or s.y is None:
        raise ValueError("the contact locus was asked for and is missing")
    panels = []
    for i, title in enumerate(titles):
        # a tilt of pi/100 cannot be seen from above: it is drawn ten times as large
        lower, upper, _ = body(10 * float(states.phi[i]), float(states.psi[i]))
        at = np.array([states.x[i], states.y[i]])
        run = t <= moments[i]
        panels.append(
            Panel(
                title=title,
                x_label="x [R]",
                y_label="y [R]",
                series=(
                    line("lower rim", lower[:, 0] + at[0], lower[:, 1] + at[1], OURS),
                    line(
                        "upper rim",
                        upper[:, 0] + at[0],
                        upper[:, 1] + at[1],
                        FOURTH_CURVE,
                        dashed=True,
                    ),
                    line("contact locus", s.x[run], s.y[run], SECOND_CURVE),
                    points("contact point", at[:1], at[1:], THIRD_CURVE),
                ),
                equal=True,
            )
        )
    return Figure(
        name="fig01-can_fall",
        title="The angle of turn, from above",
        seen=(
            f"Released on one point of its rim, the can rises again on a point {turn:.1f} degrees "
            f"further round, after {solution.t_end:.3f} sqrt(R/g). The tilt is drawn ten times as "
            f"large as it is; {names[1]} it is {float(states.phi[1]):.1e} rad."
        ),
        panels=tuple(panels),
        columns=3,
    )


def _side(phi: float, label: str = "can") -> tuple[Series, ...]:
    lower, upper, axis = body(phi, 0.0)
    x = [lower[90, 0], lower[0, 0], upper[0, 0], upper[90, 0], lower[90, 0]]
    z = [lower[90, 2], lower[0, 2], upper[0, 2], upper[90, 2], lower[90, 2]]
    centre = axis.mean(axis=0)
    ground = np.array([-2.2, 2.2])
    return (
        line(label, np.array(x), np.array(z), OURS),
        line("symmetry axis", axis[:, 0], axis[:, 2], SECOND_CURVE, dashed=True),
        line("plane", ground, np.zeros(2), FIFTH_CURVE),
        points("centre of mass", centre[:1], centre[2:], FOURTH_CURVE),
        points("contact point", np.zeros(1), np.zeros(1), THIRD_CURVE),
    )


def equilibria() -> Figure:
    """Standing, balanced and rolling, and steady, from the side (fig01:eqm_comparison)."""
    balance = PAPER_CAN.balancing_angle
    lean = math.radians(20)
    rolling = balanced_rotation(PAPER_CAN, 1.0)
    steady = steady_rotation(PAPER_CAN, lean, 1.0)
    titles = (
        (balance, "a) static: phi = phi*"),
        (balance, "b) balanced and rolling"),
        (lean, "c) steady: phi = 20 deg"),
    )
    return Figure(
        name="fig01-eqm_comparison",
        title="The equilibria, from the side",
        seen=(
            f"At phi* = {math.degrees(balance):.2f} degrees the centre stands above the contact; "
            f"there the can also rolls balanced with Theta = {rolling:.4f} Psi, where the paper's "
            f"form has {(PAPER_CAN.a - PAPER_CAN.c) * math.cos(balance) / PAPER_CAN.c:.4f} Psi. "
            f"At 20 degrees it rolls steadily with Psi = 1, Theta = {steady:.3f} sqrt(g/R)."
        ),
        panels=tuple(
            Panel(title=title, x_label="x [R]", y_label="z [R]", series=_side(phi), equal=True)
            for phi, title in titles
        ),
        columns=3,
    )
