"""Section 6.2: the motions of the panels of fig01:contact_pt_motion."""

import math
from functools import cache

import mpmath as mp
import numpy as np

from harness.paper import release
from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit.checks.momenta import momenta_of
from harness.paper.audit.evidence import Fact, check, check_each
from reference import PAPER_CAN, solve
from reference.asymptotic.matched import boundary_rotation

AGREES = 0.02
"""Two curves closer than this share of the plot's height are one to the eye."""
SMALLEST = 1e-8
"""The smallest eps of fig01:sing_perturb, which shows what becomes of the motion as eps grows."""
MOST_ZETA = 10
"""What is O(1) is below this: the paper assumes it of zeta."""
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
    """Compare eps with those that the paper draws, B_0 with B_-2; and part H_z^G between them."""
    found, first = constants_of(panel), constants_of("a")
    zeta = math.sqrt(found["B_0^2"] / found["eps"])
    vertical = PAPER_CAN.c * sum(PANELS[panel]) * release.SECOND
    with mp.workdps(30):
        pair = mp.sqrt(found["B_0^2"]), mp.sqrt(found["eps"])
        parts = {
            name: momenta_of(paper_can.PHI, *flat_motion.rates(paper_can.PHI, *constants))["H_z^G"]
            for name, constants in (("B_0", (pair[0], 0)), ("eps", (0, pair[1])))
        }
    large = {
        "eps": found["eps"] > SMALLEST,
        "B_0": zeta > MOST_ZETA and abs(parts["B_0"]) > MOST_ZETA * abs(parts["eps"]),
    }
    return Fact(
        printed="eps",
        corrected="B_0",
        holds=large.__getitem__,
        how=f"exact constants, with the printed a and c: eps = {found['eps']:.2e}, in a) "
        f"{first['eps']:.2e}; B_0^2 = {found['B_0^2']:.2e}, in a) {first['B_0^2']:.2e}; the least "
        f"eps of fig01:sing_perturb is {SMALLEST:.0e}; H_z^G has {mp.nstr(parts['B_0'], 3)} from "
        f"B_0 and {mp.nstr(abs(parts['eps']), 2)} from B_-2 in size",
        correct=f"eps is {found['eps'] / first['eps']:.3g} times that of a); zeta = {zeta:.3g}, "
        f"against the assumption zeta = O(1); the vertical angular momentum is large, H_z^G = "
        f"{vertical:.2f} m R^2 sqrt(g/R), but it comes with B_0 and is not eps",
    )


@check("text:panel b")
def fall_from_the_balance() -> Fact:
    """Compute two bounces of a release, and how far it has turned near the balance."""
    balance = math.atan(1 / PAPER_CAN.h)

    @cache
    def fall(release_: tuple[float, float, float]) -> tuple[float, float, list[float]]:
        """Return phi_min in parts of phi_0, the precession above 0.9 phi_0, and the turns."""
        precession, short, rotation = release_
        top = balance - short
        solution = solve(release.problem(precession, top, rotation, bounces=2))
        if not solution.bounces:
            return math.inf, math.inf, []
        bounce, turns = solution.bounces[0], [x.angle_of_turn for x in solution.bounces]
        states = solution.at(np.linspace(0, bounce.time, 4000))
        aside = float(np.degrees(np.abs(states.psi[states.phi > 0.9 * top]).max()))
        low = max(bounce.phi_min for bounce in solution.bounces)
        return low / top, aside, [math.degrees(turn) for turn in turns]

    def petals(release_: tuple[float, float, float]) -> bool:
        low, aside, turns = fall(release_)
        # falls into the inner region, on a line to the eye, comes back, and does so again
        again = len(turns) == 2 and min(map(abs, turns)) > 180  # noqa: PLR2004 - degrees
        return low < release.INNER and aside < 10 and again  # noqa: PLR2004 - degrees

    printed = (0.0, 1e-5, 2.0)
    low, aside, turns = fall(printed)
    return Fact(
        printed=printed,
        holds=petals,
        how=f"exact: phi falls to {low:.3f} of phi_0; psi is within {aside:.1f} degrees above "
        f"0.9 phi_0; two bounces turn by {' and '.join(f'{x:.1f}' for x in turns)} degrees",
    )


@check("caption:fig01:contact_pt_motion")
def cusps_near_the_boundary() -> Fact:
    """Compare the release with the line (6.4), and solve it: theta' has to change sign."""
    line = boundary_rotation(PAPER_CAN, 1.0)

    def range_of(pair: tuple[float, float]) -> tuple[float, float]:
        """Return the least and the largest theta' over three bounces."""
        solution = release.solved(release.problem(psi_dot=pair[0], theta_dot=pair[1], bounces=3))
        rates = solution.at(solution.grid()).theta_dot
        return float(rates.min()), float(rates.max())

    def cusps(pair: tuple[float, float]) -> bool:
        if abs(pair[0] * line / pair[1] - 1) >= AGREES:
            return False
        least, largest = range_of(pair)
        return least < 0 < largest

    printed = PANELS["d"]
    least, largest = range_of(printed)
    return Fact(
        printed=printed,
        holds=cusps,
        how=f"the line has psi' = {printed[1] / line:.4f} at theta' = {printed[1]:g}; theta' runs "
        f"from {least:.3g} to {largest:.3g} sqrt(g/R) over three bounces",
    )
