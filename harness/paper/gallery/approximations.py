"""The reduced equation and the matched asymptotic solution against the exact motion."""

import math

import numpy as np

from harness.core.report_model import Figure, Series
from harness.paper.gallery.curves import TIME, figure, line, panel, sampled
from harness.paper.release import of_constants, problem, solved
from reference import PAPER_CAN
from reference.asymptotic.matched import matched_of
from reference.asymptotic.small_nutation import reduced_of

SCALE = math.sqrt(PAPER_CAN.pendulum_inertia)
FAMILY = (("1e-8", 1e-8, 1), ("6.4e-7", 6.4e-7, 2), ("4e-6", 4e-6, 3))


def exact_and_reduced() -> Figure:
    """Exact and reduced equations over six bounces (fig01:eq_comparison)."""
    exact = solved(problem(bounces=6))
    short = solved(problem(bounces=6), "reduced")
    (t, s), (u, r) = sampled(exact), sampled(short)
    late = exact.minima[-1] - short.minima[-1]
    drawn = (
        ("phi [deg]", np.degrees(s.phi), np.degrees(r.phi)),
        ("phi' [sqrt(g/R)]", s.phi_dot, r.phi_dot),
        ("psi' [sqrt(g/R)]", s.psi_dot, r.psi_dot),
        ("theta' [sqrt(g/R)]", s.theta_dot, r.theta_dot),
    )
    drift = 1 - (short.minima[1] - short.minima[0]) / (exact.minima[1] - exact.minima[0])
    return figure(
        "fig01-eq_comparison",
        "Exact equations and reduced equation",
        (
            f"The reduced equation's period is {drift:.2%} too short, as it drops the terms that "
            f"make the balancing angle; at the sixth bounce it is {late:.3f} sqrt(R/g) ahead. "
            f"Peak rates: {exact.bounces[0].peak_psi_dot:.0f} exact, "
            f"{short.bounces[0].peak_psi_dot:.0f} reduced."
        ),
        *(
            panel(
                label.split(" ")[0],
                TIME,
                label,
                line("exact", t, full),
                line("reduced", u, less, 2, dashed=True),
            )
            for label, full, less in drawn
        ),
    )


def family() -> Figure:
    """Three values of eps, zeta = 1 (fig01:sing_perturb)."""
    curves: list[list[Series]] = [[], [], [], []]
    steps = []
    for name, epsilon, kind in FAMILY:
        solution = solved(of_constants(epsilon, 1.0, duration=4.0), "reduced")
        t, s = sampled(solution)
        label = f"eps = {name}"
        dashed = kind != 1
        drawn = ((s.phi, s.phi_dot), (t, s.phi), (t, s.psi_dot), (t, np.degrees(s.psi)))
        for series, (x, y) in zip(curves, drawn, strict=True):
            series.append(line(label, x, y, kind, dashed=dashed))
        steps.append(math.degrees(solution.bounces[0].angle_of_turn))
    words = (
        ("Phase portrait", "phi [rad]", "phi' [sqrt(g/R)]"),
        ("phi", TIME, "phi [rad]"),
        ("Psi", TIME, "psi' [sqrt(g/R)]"),
        ("psi", TIME, "psi [deg]"),
    )
    return figure(
        "fig01-sing_perturb",
        "The reduced equation as eps falls",
        (
            "As eps falls the bounce grows sharper and psi becomes a staircase. A period adds "
            f"{steps[2]:.0f}, {steps[1]:.0f} and {steps[0]:.0f} degrees for eps = 4e-6, 6.4e-7 and "
            f"1e-8, tending to {180 * PAPER_CAN.turn_ratio:.1f}."
        ),
        *(
            panel(title, x, y, *series, log_y=title == "Psi")
            for (title, x, y), series in zip(words, curves, strict=True)
        ),
    )


def inner_and_outer() -> Figure:
    """Inner, outer and matched solutions up to the bounce (fig01:inner_outer_comp)."""
    posed = problem(bounces=1)
    matched = matched_of(posed)
    end = matched.bounce_time
    short = solved(posed, "reduced")
    panels = []
    worst = 0.0
    for start, title in ((0.0, "From release to bounce"), (0.247, "The last of it")):
        gaps = np.concatenate([np.linspace(end - start, 1e-4, 400), np.geomspace(1e-4, 1e-9, 60)])
        tau = end - gaps
        truth = short.at(tau * SCALE).phi
        worst = max(worst, float(np.abs(matched.composite(tau) - truth).max()))
        outer = matched.outer(tau, corrected=False)
        outer[outer < matched.phi_min / 4] = np.nan  # it goes to zero, which has no logarithm
        curves = (
            ("reduced equation", truth, 1, False),
            ("outer", outer, 3, False),
            ("inner", matched.inner(tau), 4, False),
            ("matched", matched.composite(tau), 2, True),
        )
        panels.append(
            panel(
                title,
                "t [sqrt((a_p + 1) R/g)]",
                "phi [rad]",
                *(line(n, tau, y, kind, dashed=d) for n, y, kind, d in curves),
                log_y=start > 0,
            )
        )
    return figure(
        "fig01-inner_outer_comp",
        "Inner, outer and matched solutions",
        (
            f"The matched solution stays within {worst:.1e} rad of the reduced equation up to the "
            f"bounce at sqrt(I) = {end:.4f}. The outer solution goes to zero there; the inner and "
            f"the matched one stop at phi_min = {matched.phi_min:.2e} rad, "
            f"for eps = {reduced_of(posed).B_minus_two ** 2:.2e}."
        ),
        *panels,
    )
