"""Cross-references, names and indices: what the text points to."""

import re

import mpmath as mp
import sympy as sp

from harness.paper.audit import flat_motion
from harness.paper.audit import flat_series as series
from harness.paper.audit.checks.outer import INTEGRANDS
from harness.paper.audit.claims import CLAIMS
from harness.paper.audit.evidence import Fact, check, check_each
from harness.paper.audit.symbols import phi

PLACES = {claim.label: claim.place for claim in CLAIMS}
DEFINED_IN = {
    "S_bal": "eq01:bal_eqm",
    "the Hamiltonian": "eq01:hamiltonian1",
    "the panels a) to d)": "fig01:contact_pt_motion",
}
"""Where the paper defines what it refers to."""


@check_each(
    {
        "text:reference to S_bal": ("eq01:equilibrium", "S_bal"),
        "caption:fig01:hamiltonian_3D": ("eq01:hamiltonian", "the Hamiltonian"),
        "caption:reference of the contours": ("eq01:hamiltonian", "the Hamiltonian"),
        "text:reference to panel d": ("fig01:contact_locus", "the panels a) to d)"),
    }
)
def reference(printed: str, meant: str) -> Fact:
    """Look up where it is defined."""
    right = DEFINED_IN[meant]
    return Fact(
        printed=printed,
        corrected=right,
        holds=lambda label: right == label,
        how=f"{meant}: defined in {PLACES.get(right, right)}, cited is "
        f"{PLACES.get(printed, printed)}",
    )


@check("text:bookmarks")
def bookmarks() -> Fact:
    """Compare with the number that LaTeX gives to the label beside it."""
    return Fact(
        printed="(4.21)",
        corrected="(4.19)",
        holds=lambda number: PLACES["eq01:Phi_reduced_intermediate"] == number,
        how="by LaTeX's rules eq01:Phi_reduced_intermediate is (4.19)",
    )


@check_each({"eq01:simultaneous": (0,), "text:slopes in (4.16)": (1,)})
def two_equations(times: int) -> Fact:
    """Insert the solution that begins with phi^subscript; compare with an exact motion.

    The names in (4.7) and (4.9) are those exponents. Differentiated as often as asked.
    """
    with mp.workdps(40):
        x, constants = mp.mpf("0.005"), flat_motion.CONSTANTS
        at = flat_motion.flat(x)
        values = ((at.regular, at.singular), (at.regular_slope, at.singular_slope))[times]
        motion = mp.diff(lambda y: flat_motion.rates(y, *constants)[0], x, times)
    starts = {
        int(min(term.as_coeff_exponent(phi)[1] for term in sp.Add.make_args(solution))): value
        for solution, value in zip(
            (series.regular_solution(), series.singular_solution()), values, strict=True
        )
    }

    def sums(claim: tuple[int, int, int]) -> bool:
        """Whether sign B_0 Psi_m + B_-2 Psi_n is the motion, for (sign, m, n)."""
        sign, m, n = claim
        if not {m, n} <= set(starts):
            return False
        total = sign * constants[0] * starts[m] + constants[1] * starts[n]
        # forty digits, half of which the numerical derivative takes
        return bool(abs(total / motion - 1) < mp.mpf("1e-15"))

    return Fact(
        printed=(1, 0, 2),
        corrected=(1, 0, -2),
        holds=sums,
        how=f"sympy: the solutions begin with phi^{max(starts)} and phi^{min(starts)}, no Psi_2 is "
        "defined; 40 digits: with Psi_-2 the sum is that of an exact motion",
    )


@check("text:every integral")
def every_integral() -> Fact:
    """Compare the integrals that (5.4) sums over with those that appendix G lists."""
    asked = {f"J_{i}" for i in range(4)} | {f"J_l{i}" for i in range(3)} | {"J_ll"}
    given = frozenset(INTEGRANDS)
    whole = given | {"J_0"}
    return Fact(
        printed=given,
        corrected=whole,
        holds=lambda listed: asked <= set(listed),
        how=f"missing: {', '.join(sorted(asked - given))}",
    )


@check_each({"caption:axes of the locus": ("x",), "caption:other axis of the locus": ("y",)})
def axis_of_the_locus(letter: str) -> Fact:
    """Compare with the letters that (6.8) and (6.11) give to the contact locus."""
    defined = re.findall(
        r"([xy]_\w)\(",
        next(claim.printed for claim in CLAIMS if claim.label == "eq01:contact_pt_inner"),
    )
    return Fact(
        printed=f"{letter}_p",
        corrected=f"{letter}_l",
        holds=lambda name: name in defined,
        how=f"(6.8) and (6.11) give {', '.join(dict.fromkeys(defined))}; {letter}_p is not defined",
    )
