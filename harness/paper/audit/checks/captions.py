"""Captions, and what the text says the figures show, computed again."""

import math
from functools import cache, partial

import mpmath as mp
import numpy as np

from harness.paper.audit import flat_motion, paper_can, release
from harness.paper.audit.checks.constants import PRINTED_TWO, PRINTED_ZERO, valued
from harness.paper.audit.checks.numbers import exact_constants
from harness.paper.audit.evidence import Fact
from harness.paper.audit.registry import claim
from reference import PAPER_CAN, Problem, solve
from reference.equations.reaction_force import friction_ratio
from reference.problem.states import initial_states

HEIGHT = math.pi / 100
INNER = 0.1
"""The paper colours phi < phi_0/10 as the inner region."""
SEEN = 0.05
"""A twentieth of a panel is seen in print."""
SMALLEST = 1e-8
"""The smallest eps of fig01:sing_perturb, which shows what becomes of the motion as eps grows."""
PANELS = {"a": (0.1001, -0.1), "c": (0.72667, 7.0), "d": (1.7267, 7.0)}
"""Rates psi' and theta' of the panels of fig01:contact_pt_motion released at pi/100, in rad/s."""


@cache
def constants_of(panel: str) -> dict[str, float]:
    """Return eps = B_-2^2 and the like square of B_0 of a release."""
    with mp.workdps(30):
        rates = [mp.mpf(repr(rate)) * paper_can.SECOND for rate in PANELS[panel]]
        zero, two = flat_motion.constants(paper_can.PHI, *rates)
        return {"eps": float(two**2), "B_0^2": float(zero**2)}


def _large(panel: str, correct: str) -> Fact:
    found, first = constants_of(panel), constants_of("a")
    zeta = math.sqrt(found["B_0^2"] / found["eps"])
    return Fact(
        printed="eps",
        corrected="B_0^2",
        others=("eps",),
        holds=lambda name: found[name] > SMALLEST,
        how=f"exact constants: eps = {found['eps']:.2e}, in a) {first['eps']:.2e}; B_0^2 = "
        f"{found['B_0^2']:.2e}, in a) {first['B_0^2']:.2e}; the least eps of fig01:sing_perturb "
        "is 1e-8",
        correct=f"{correct}, zeta = {zeta:.3g}, against the assumption zeta = O(1)",
    )


for _label, _says, _panel, _correct in (
    (
        "text:panel c",
        "c) has a large eps, which causes the wobbles",
        "c",
        "eps is small; B_0 is large",
    ),
    (
        "text:panel d",
        "d) has a large eps, close to the boundary (6.4)",
        "d",
        "eps is the smallest of all, as (6.4) is where B_-2 = 0; B_0 is large",
    ),
):
    claim(_label, "6.2", _says, name="large_constant")(partial(_large, _panel, _correct))


@claim(
    "text:panel b", "6.2", "b) rolls straight from rest at phi* - 1e-5, falls almost flat, turns"
)
def fall_from_the_balance() -> Fact:
    """Compute its first bounce, and how far it has turned at half the height."""
    top = math.atan(1 / PAPER_CAN.h) - 1e-5
    posed = Problem(
        parameters=PAPER_CAN,
        phi=top,
        psi_dot=0.0,
        theta_dot=2 * float(paper_can.SECOND),
        bounces=1,
    )
    solution = solve(posed)
    bounce = solution.bounces[0]
    states = solution.at(np.linspace(0, bounce.time, 4000))
    before = float(np.degrees(np.abs(states.psi[states.phi > 0.9 * top]).max()))
    return Fact(
        printed=INNER,
        others=(0.001, 0.01),
        holds=lambda share: bounce.phi_min < share * top and before < 10,  # noqa: PLR2004 - degrees
        how=f"exact: phi falls from {math.degrees(top):.2f} to {math.degrees(bounce.phi_min):.2f} "
        f"degrees, {bounce.phi_min / top:.3f} of it; psi is within {before:.1f} degrees while phi "
        f"> 0.9 phi_0; the bounce turns by {math.degrees(bounce.angle_of_turn):.1f} degrees",
    )


@cache
def _largest_ratios() -> tuple[float, float]:
    """Return the largest |F|/N of the release in the outer and in the inner region."""
    solution = release.bounce()
    states = solution.at(solution.grid())
    outside = states.phi >= INNER * HEIGHT
    ratio = friction_ratio(states, PAPER_CAN)
    return float(ratio[outside].max()), solution.bounces[0].peak_friction_ratio


@claim("text:outer friction", "6.3", "the outer region requires less friction than the inner one")
def friction_of_the_outer_region() -> Fact:
    """Largest ratios of the exact release on either side of phi_0/10."""
    outer, inner = _largest_ratios()
    largest = {"outer": outer, "inner": inner}
    return Fact(
        printed=("outer", "inner"),
        others=(("inner", "outer"),),
        holds=lambda order: largest[order[0]] < largest[order[1]],
        how=f"exact: {outer:.4f} for phi > phi_0/10 and {inner:.4f} below: falling freely near "
        "phi = 0 asks for h/a_p too",
    )


@claim("text:fast release", "6.3", "with a large Phi the outer region may need more friction")
def friction_of_a_fast_release() -> Fact:
    """Ratio that a release at pi/100 asks for at once, with the can pushed downwards."""

    def outer_less(push: float) -> bool:
        posed = Problem(
            parameters=PAPER_CAN,
            phi=HEIGHT,
            phi_dot=push,
            psi_dot=float(paper_can.PSI_DOT),
            theta_dot=float(paper_can.THETA_DOT),
            bounces=1,
        )
        start = initial_states(posed)
        return float(friction_ratio(start, PAPER_CAN).max()) < PAPER_CAN.h / PAPER_CAN.a_p

    return Fact(
        printed=-0.7,
        others=(0.0, -0.3),
        holds=lambda push: not outer_less(push),
        how="exact: with phi' = -0.7 sqrt(g/R) at pi/100, shortly before the can would lift off, "
        "the release itself asks for more than h/a_p; from rest, and at -0.3, for less",
    )


@claim("caption:fig01:conserved", "4.2", "the truncated B_0 and B_-2 show small oscillations")
def drift_of_the_truncated_constants() -> Fact:
    """Insert the exact rates of the release into eq01:A_sol and eq01:B_sol."""
    worst = {}
    with mp.workdps(30):
        exact = exact_constants()
        for name, form, right in zip(
            ("B_0", "B_-2"), (PRINTED_ZERO, PRINTED_TWO), exact, strict=True
        ):
            value = valued(form)
            worst[name] = max(
                float(abs(value(x, *flat_motion.rates(x, *exact)) / right - 1))
                for x in (paper_can.PHI, mp.mpf("1e-2"), mp.mpf("1e-3"), mp.mpf("1e-4"))
            )
    return Fact(
        printed=0.02,
        others=(1e-3, 1e-6),
        holds=lambda share: all(1e-4 < value < share for value in worst.values()),  # noqa: PLR2004 - else unseen
        how="exact rates inserted: "
        + ", ".join(f"{name} varies by {value:.1%}" for name, value in worst.items()),
    )


@claim("caption:fig01:inner_outer_comp", "5.3", "for 0.247 < t < 0.2507 the outer solution departs")
def outer_solution_departs() -> Fact:
    """Distance of the leading outer solution from the composite, of the height of the panel."""
    width, strength = float(paper_can.WIDTH), 1.43e-10 * float(paper_can.a_p)

    def apart(t: float) -> float:
        gap = math.sqrt(width) - t
        matched = math.sqrt(strength / width + width * gap**2) - gap**2 / 2
        return abs(matched - (width - t**2) / 2)

    end = math.sqrt(width)
    return Fact(
        printed=0.247,
        others=(0.0, 0.2),
        holds=lambda start: apart(end) > SEEN * (width - start**2) / 2 > apart(start),
        how=f"at t = sqrt(I) the two are {apart(end):.2e} apart, {apart(end) / 9.1e-4:.0%} of the "
        f"panel, which starts at phi = {(width - 0.247**2) / 2:.2e}; at t = 0.247 "
        f"{apart(0.247):.1e}",
    )


@claim("caption:fig01:can_fall", "1", "the contact point moves through Delta psi around the rim")
def way_around_the_rim() -> Fact:
    """Compare the change of theta, which moves the contact round the rim, with that of psi."""
    bounce = release.bounce().bounces[0]
    on_plane, on_rim = (math.degrees(abs(x)) for x in (bounce.angle_of_turn, bounce.rotation_turn))
    return Fact(
        printed=1.0,
        others=(0.5, 2.0, 0.99),
        holds=lambda share: abs(on_rim - share * on_plane) < 1e-3,  # noqa: PLR2004 - degrees
        how=f"exact release: {on_rim:.5f} degrees around the rim, {on_plane:.5f} on the plane",
    )
