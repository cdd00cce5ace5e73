"""The motion itself: time series, Psi against phi, and what stays constant."""

import numpy as np

from harness.core.report_model import Figure, Panel
from harness.core.trajectory import Floats
from harness.paper.gallery.release import SECOND_CURVE, TIME, line, points, problem, sampled, solved
from reference import PAPER_CAN, States
from reference.asymptotic.expansions import paper_constants
from reference.asymptotic.hypergeometric import hypergeometric_pair


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
    return Figure(
        name="fig01-non_dim_solution",
        title="The angles and their rates over four bounces",
        seen=(
            f"At each bounce psi steps by {turn[0]:.2f} degrees and theta steps back by as much, "
            f"while phi turns round at {solution.bounces[0].phi_min:.2e} rad. "
            f"The precession rate peaks at {peak:.0f} sqrt(g/R)."
        ),
        panels=tuple(
            Panel(
                title=label.split(" ")[0],
                x_label=TIME,
                y_label=label,
                series=(line("exact equations", t, y),),
            )
            for label, y in drawn
        ),
        columns=2,
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
    return Figure(
        name="fig01-frob_comp",
        title="The hypergeometric solution and the equations of motion",
        seen=(
            f"With rho = (9 - 4 gamma - 4 i beta)/16, the right sign, the two agree to {worst:.0e} "
            f"over the whole fall. At small phi the slope is {slope:.3f}: Psi goes as 1/phi^2."
        ),
        panels=(
            Panel(
                title="Psi against phi",
                x_label="phi [rad]",
                y_label="Psi [sqrt(g/R)]",
                series=(
                    line("equations of motion", phi, psi),
                    points("hypergeometric solution", places, values, SECOND_CURVE),
                ),
                log_x=True,
                log_y=True,
            ),
        ),
        columns=1,
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
    return Figure(
        name="fig01-conserved",
        title="The conserved quantities",
        seen=(
            f"The exact constants stay constant to {drift:.0e}. By the paper's expansions, cut off "
            f"after phi^2, B_0 varies by {wobble[0]:.1%} and B_-2 by {wobble[1]:.1%}, most where "
            "phi is largest."
        ),
        panels=tuple(
            Panel(
                title=name,
                x_label=TIME,
                y_label=f"{name} [sqrt(g/R)]",
                series=(
                    line("exact", t, full),
                    line("eq01:A_sol and eq01:B_sol", t, cut, SECOND_CURVE),
                ),
            )
            for name, full, cut in zip(names, exact, short, strict=True)
        ),
        columns=2,
    )
