"""Captions, and what the text says the figures show, computed again."""

import math
from functools import cache

import mpmath as mp
import numpy as np

from harness.paper.audit import flat_motion, paper_can, release
from harness.paper.audit.checks.constants import PRINTED_TWO, PRINTED_ZERO, valued
from harness.paper.audit.checks.numbers import exact_constants
from harness.paper.audit.evidence import Fact, check, check_each
from harness.paper.audit.symbols import Psi, Theta
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


@check_each({"text:panel c": ("c",), "text:panel d": ("d",)})
def large_constant(panel: str) -> Fact:
    """Compare eps and the like square of B_0."""
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
        correct=f"zeta = {zeta:.3g}, against the assumption zeta = O(1)",
    )


@check("text:panel b")
def fall_from_the_balance() -> Fact:
    """Compute the first bounce of a release, and how far it has turned near the balance."""
    balance = math.atan(1 / PAPER_CAN.h)

    @cache
    def fall(release_: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return phi_min in parts of phi_0, the precession above 0.9 phi_0, and the turn."""
        precession, short, rotation = release_
        top, second = balance - short, float(paper_can.SECOND)
        posed = Problem(
            parameters=PAPER_CAN,
            phi=top,
            psi_dot=precession * second,
            theta_dot=rotation * second,
            bounces=1,
        )
        solution = solve(posed)
        if not solution.bounces:
            return math.inf, math.inf, 0.0
        bounce = solution.bounces[0]
        states = solution.at(np.linspace(0, bounce.time, 4000))
        aside = float(np.degrees(np.abs(states.psi[states.phi > 0.9 * top]).max()))
        return bounce.phi_min / top, aside, math.degrees(bounce.angle_of_turn)

    def petals(release_: tuple[float, float, float]) -> bool:
        low, aside, turn = fall(release_)
        # falls into the inner region, on a line to the eye, and comes back
        return low < INNER and aside < 10 and abs(turn) > 180  # noqa: PLR2004 - degrees

    printed = (0.0, 1e-5, 2.0)
    low, aside, turn = fall(printed)
    return Fact(
        printed=printed,
        others=((2.0, 1e-5, 2.0), (0.0, 1e-5, 20.0), (0.0, 1e-5, 10.0)),
        holds=petals,
        how=f"exact: phi falls to {low:.3f} of phi_0; psi is within {aside:.1f} degrees above "
        f"0.9 phi_0; the bounce turns by {turn:.1f} degrees",
    )


@cache
def _largest_ratios() -> tuple[float, float]:
    """Return the largest |F|/N of the release in the outer and in the inner region."""
    solution = release.bounce()
    states = solution.at(solution.grid())
    outside = states.phi >= INNER * HEIGHT
    ratio = friction_ratio(states, PAPER_CAN)
    return float(ratio[outside].max()), solution.bounces[0].peak_friction_ratio


@check("text:outer friction")
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


@check("text:fast release")
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

    pushes = {"none": 0.0, "small": -0.3, "large": -0.7}
    return Fact(
        printed="large",
        others=("none", "small"),
        holds=lambda size: not outer_less(pushes[size]),
        how="exact: with phi' = -0.7 sqrt(g/R) at pi/100, shortly before the can would lift off, "
        "the release itself asks for more than h/a_p; from rest, and at -0.3, for less",
    )


@check("caption:fig01:conserved")
def drift_of_the_truncated_constants() -> Fact:
    """Insert the exact rates of the release into eq01:A_sol and eq01:B_sol."""
    forms = {"B_0": PRINTED_ZERO, "B_-2": PRINTED_TWO, "Psi": Psi, "Theta": Theta}
    places = (paper_can.PHI, mp.mpf("1e-2"), mp.mpf("1e-3"), mp.mpf("1e-4"))
    swing = {}
    with mp.workdps(30):
        exact = exact_constants()
        for name, form in forms.items():
            values = [valued(form)(x, *flat_motion.rates(x, *exact)) for x in places]
            swing[name] = float((max(values) - min(values)) / max(abs(x) for x in values))
    return Fact(
        printed=("B_0", "B_-2"),
        others=(("Psi",), ("B_0", "Theta")),
        # seen in a plot, and small
        holds=lambda names: all(SEEN / 100 < swing[name] < SEEN for name in names),
        how="exact rates inserted: "
        + ", ".join(f"{name} varies by {value:.1%}" for name, value in swing.items()),
    )


@check("caption:fig01:inner_outer_comp")
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


@check("caption:fig01:can_fall")
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
