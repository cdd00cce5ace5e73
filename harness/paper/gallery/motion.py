"""The can and its motion: poses, time series, Psi against phi, and what stays constant."""

import math

import numpy as np

from harness.core.report_model import Figure, Series
from harness.core.trajectory import Floats
from harness.paper.gallery.curves import TIME, figure, line, panel, points, sampled
from harness.paper.release import contact_locus, problem, solved
from reference import PAPER_CAN, States
from reference.asymptotic.expansions import paper_constants
from reference.asymptotic.hypergeometric import hypergeometric_pair
from reference.equations.steady_motion import balanced_rotation, steady_rotation


def time_series() -> Figure:
    """Angles and rates over four bounces (fig01:non_dim_solution)."""
    solution = solved(problem(bounces=4))
    t, s = sampled(solution)
    turn = np.degrees([bounce.angle_of_turn for bounce in solution.bounces])
    drawn = (
        ("phi [deg]", np.degrees(s.phi)),
        ("phi' [sqrt(g/R)]", s.phi_dot),
        ("psi [deg]", np.degrees(s.psi)),
        ("psi' [sqrt(g/R)]", s.psi_dot),
        ("theta [deg]", np.degrees(s.theta)),
        ("theta' [sqrt(g/R)]", s.theta_dot),
    )
    peak = solution.bounces[0].peak_psi_dot
    return figure(
        "fig01-non_dim_solution",
        "The angles and their rates over four bounces",
        (
            f"At each bounce psi steps by {turn[0]:.2f} degrees and theta steps back by as much, "
            f"while phi turns round at {solution.bounces[0].phi_min:.2e} rad. "
            f"The precession rate peaks at {peak:.0f} sqrt(g/R)."
        ),
        *(
            panel(label.split(" ")[0], TIME, label, line("exact equations", t, y))
            for label, y in drawn
        ),
    )


def hypergeometric() -> Figure:
    """Psi against phi on logarithmic axes (fig01:frob_comp)."""
    solution = solved(problem(bounces=1))
    t, s = sampled(solution)
    falling = t <= solution.minima[0]
    phi, psi = s.phi[falling], s.psi_dot[falling]
    wanted = np.geomspace(phi.min(), phi.max(), 25)
    nearest = np.unique([int(np.abs(np.log(phi / x)).argmin()) for x in wanted])[::-1]
    places, known = phi[nearest], psi[nearest]
    basis = np.array([hypergeometric_pair(PAPER_CAN, float(x)) for x in places])
    # the two constants from two high nutations, the rest is prediction
    pick = [-1, -8]
    constants_ = np.linalg.solve(basis[pick], known[pick].astype(complex))
    values = (basis @ constants_).real
    worst = np.abs(values / known - 1).max()
    slope = np.polyfit(np.log(places[:8]), np.log(values[:8]), 1)[0]
    return figure(
        "fig01-frob_comp",
        "The hypergeometric solution and the equations of motion",
        (
            f"With rho = (9 - 4 gamma - 4 i beta)/16, the right sign, the two agree to {worst:.0e} "
            f"over the whole fall. At small phi the slope is {slope:.3f}: Psi goes as 1/phi^2."
        ),
        panel(
            "Psi against phi",
            "phi [rad]",
            "Psi [sqrt(g/R)]",
            line("equations of motion", phi, psi),
            points("hypergeometric solution", places, values, 2),
            log_x=True,
            log_y=True,
        ),
    )


def expanded_constants(s: States) -> tuple[Floats, Floats]:
    """Return B_0 and B_-2 by eq01:A_sol and eq01:B_sol, which hold as printed."""
    p = PAPER_CAN
    kc, hk = p.k * p.c_p, p.h * p.k
    x, psi, spin = s.phi, s.psi_dot, s.spin
    square = -kc * (3 * psi + 2 * spin) + (4 - 3 * p.k + 9 * hk**2) * psi
    zero = (
        kc / 2 * spin * (1 - hk * x)
        - (hk**2 - p.k) / 4 * (kc * spin - 2 * psi) * x**2 * np.log(x)
        + square * x**2 / 12
    )
    return zero, (psi - kc / 2 * spin) * x**2


def constants() -> Figure:
    """B_0 and B_-2, exact and by the paper's expansions (fig01:conserved)."""
    t, s = sampled(solved(problem(bounces=4)))
    exact = paper_constants(s, PAPER_CAN)
    short = expanded_constants(s)
    drift = max(float(np.ptp(x) / np.abs(x).max()) for x in exact)
    names = ("B_0", "B_-2")
    wobble = [float(np.ptp(x) / np.abs(y).max()) for x, y in zip(short, exact, strict=True)]
    return figure(
        "fig01-conserved",
        "The conserved quantities",
        (
            f"The exact constants stay constant to {drift:.0e}. By the paper's expansions, cut off "
            f"after phi^2, B_0 varies by {wobble[0]:.1%} and B_-2 by {wobble[1]:.1%}, most where "
            "phi is largest."
        ),
        *(
            panel(
                name,
                TIME,
                f"{name} [sqrt(g/R)]",
                line("exact", t, full),
                line("eq01:A_sol and eq01:B_sol", t, cut, 2),
            )
            for name, full, cut in zip(names, exact, short, strict=True)
        ),
    )


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
    x, y = contact_locus(s)
    places = np.stack(contact_locus(states), axis=1)
    panels = []
    for i, title in enumerate(titles):
        # a tilt of pi/100 cannot be seen from above: it is drawn ten times as large
        lower, upper, _ = body(10 * float(states.phi[i]), float(states.psi[i]))
        at, run = places[i], t <= moments[i]
        panels.append(
            panel(
                title,
                "x [R]",
                "y [R]",
                line("lower rim", lower[:, 0] + at[0], lower[:, 1] + at[1]),
                line("upper rim", upper[:, 0] + at[0], upper[:, 1] + at[1], 4, dashed=True),
                line("contact locus", x[run], y[run], 2),
                points("contact point", at[:1], at[1:], 3),
                equal=True,
            )
        )
    return figure(
        "fig01-can_fall",
        "The angle of turn, from above",
        (
            f"Released on one point of its rim, the can rises again on a point {turn:.1f} degrees "
            f"further round, after {solution.t_end:.3f} sqrt(R/g). The tilt is drawn ten times as "
            f"large as it is; {names[1]} it is {float(states.phi[1]):.1e} rad."
        ),
        *panels,
    )


def _side(phi: float, label: str = "can") -> tuple[Series, ...]:
    lower, upper, axis = body(phi, 0.0)
    x = [lower[90, 0], lower[0, 0], upper[0, 0], upper[90, 0], lower[90, 0]]
    z = [lower[90, 2], lower[0, 2], upper[0, 2], upper[90, 2], lower[90, 2]]
    centre = axis.mean(axis=0)
    ground = np.array([-2.2, 2.2])
    return (
        line(label, np.array(x), np.array(z)),
        line("symmetry axis", axis[:, 0], axis[:, 2], 2, dashed=True),
        line("plane", ground, np.zeros(2), 5),
        points("centre of mass", centre[:1], centre[2:], 4),
        points("contact point", np.zeros(1), np.zeros(1), 3),
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
    return figure(
        "fig01-eqm_comparison",
        "The equilibria, from the side",
        (
            f"At phi* = {math.degrees(balance):.2f} degrees the centre stands above the contact; "
            f"there the can also rolls balanced with Theta = {rolling:.4f} Psi, where the paper's "
            f"form has {(PAPER_CAN.a - PAPER_CAN.c) * math.cos(balance) / PAPER_CAN.c:.4f} Psi. "
            f"At 20 degrees it rolls steadily with Psi = 1, Theta = {steady:.3f} sqrt(g/R)."
        ),
        *(panel(title, "x [R]", "z [R]", *_side(phi), equal=True) for phi, title in titles),
    )
