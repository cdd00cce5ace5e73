"""Cross-references, names and indices: what the text points to."""

from functools import partial

import sympy as sp

from harness.paper.audit import flat_series as series
from harness.paper.audit.checks.integrals import INTEGRANDS
from harness.paper.audit.evidence import Fact
from harness.paper.audit.finding import ClaimStatus
from harness.paper.audit.labels import DEFINED_IN, NUMBERS
from harness.paper.audit.registry import claim
from harness.paper.audit.symbols import phi


def _reference(printed: str, meant: str, others: tuple[str, ...], where: str) -> Fact:
    right = DEFINED_IN[meant]
    return Fact(
        printed=printed,
        corrected=right,
        others=(printed, *others),
        holds=lambda label: DEFINED_IN[meant] == label,
        how=f"{meant}: defined in {NUMBERS.get(right, right)}; {where} cite "
        f"{NUMBERS.get(printed, printed)}",
        correct=f"{NUMBERS.get(right, right)} in place of {NUMBERS.get(printed, printed)}",
        wrong=ClaimStatus.MISPRINT,
    )


for _label, _section, _says, _printed, _meant, _others, _where in (
    (
        "text:reference to S_bal",
        "6.2",
        "S_bal is that of (3.6)",
        "eq01:equilibrium",
        "S_bal",
        ("eq01:static_eqm",),
        "the words on bounded motion",
    ),
    (
        "caption:fig01:hamiltonian_3D",
        "E",
        "the surface and the contours are of the Hamiltonian (E.5)",
        "eq01:hamiltonian",
        "the Hamiltonian",
        ("eqA:ham1",),
        "the captions",
    ),
    (
        "text:reference to panel d",
        "6.2",
        "panel d) is in the figure that defines the contact locus",
        "fig01:contact_locus",
        "panels a) to d) of the contact locus",
        ("fig01:eqm_comparison",),
        "the words on bounded motion",
    ),
):
    claim(_label, _section, _says, name="reference")(
        partial(_reference, _printed, _meant, _others, _where)
    )

BOOKMARKS = {
    "eq01:psi_orig": "(4.12)",
    "eq01:theta_orig": "(4.13)",
    "eq01:Phi_reduced_intermediate": "(4.21)",
    "eq01:order1_outer": "(5.3)",
}


@claim(
    "text:bookmarks",
    "D",
    "the bookmarks of appendices A, D and F name (4.12), (4.13), (4.21) and (5.3)",
)
def bookmarks() -> Fact:
    """Compare with the numbers that LaTeX gives to the labels beside them."""
    right = {label: NUMBERS[label] for label in BOOKMARKS}
    wrong = {label: number for label, number in BOOKMARKS.items() if right[label] != number}
    return Fact(
        printed=BOOKMARKS,
        corrected=right,
        others=({**right, "eq01:order1_outer": "(5.4)"}, {**right, "eq01:psi_orig": "(4.11)"}),
        holds=lambda numbers: numbers == right,
        how="numbers by LaTeX's rules: "
        + ", ".join(
            f"{label} is {right[label]}, named {number}" for label, number in wrong.items()
        ),
        correct="(4.19) in the bookmark of appendix D",
        wrong=ClaimStatus.MISPRINT,
    )


@claim("text:subscript in (4.16)", "4.2", "Psi = B_0 Psi_0 + B_-2 Psi_2")
def subscript_of_the_singular_solution() -> Fact:
    """Read the exponent with which the solution begins, which is its name in (4.7) and (4.9)."""
    powers = [
        term.as_coeff_exponent(phi)[1] for term in sp.Add.make_args(series.singular_solution())
    ]
    return Fact(
        printed=2,
        corrected=-2,
        others=(0, -1, 2),
        holds=lambda subscript: min(powers) == subscript,
        how=f"sympy: the second solution begins with phi^{min(powers)}; no Psi_2 is defined",
        correct="Psi_-2 in place of Psi_2, twice",
        wrong=ClaimStatus.MISPRINT,
    )


@claim("text:index of the sums", "5.1", "sums over n of b_i J_i in (5.6) and of b_li J_li in (5.4)")
def index_of_the_sums() -> Fact:
    """Ask which letters of its terms a sum leaves free."""
    i, n = sp.symbols("i n", integer=True)
    b, integral = sp.IndexedBase("b"), sp.IndexedBase("J")
    letters = {"i": i, "n": n}

    def bound(over: str) -> bool:
        total = sp.Sum(b[i] * integral[i], (letters[over], 0, 2))
        return i not in total.free_symbols

    return Fact(
        printed="n",
        corrected="i",
        others=("n",),
        holds=bound,
        how="sympy: with n as the variable of summation i stays free",
        correct="the sums run over i: the second of (5.4), and the first two of (5.6)",
        wrong=ClaimStatus.MISPRINT,
    )


@claim("text:every integral", "5.1", "each double integral of (5.5) is evaluated in appendix G")
def every_integral() -> Fact:
    """Compare the integrals that (5.4) sums over with those that appendix G lists."""
    asked = {f"J_{i}" for i in range(4)} | {f"J_l{i}" for i in range(3)} | {"J_ll"}
    given = frozenset(INTEGRANDS)
    whole = given | {"J_0"}
    return Fact(
        printed=given,
        corrected=whole,
        others=(whole - {"J_l0"}, whole - {"J_3"}),
        holds=lambda listed: asked <= set(listed),
        how=f"missing: {', '.join(sorted(asked - given))}",
        correct="J_0 = T^2/2 is missing",
    )


@claim("caption:axes of the locus", "6.2", "the axes of the trajectories are x_p and y_p")
def axes_of_the_locus() -> Fact:
    """Compare with the letters that the text gives to the contact locus."""
    return Fact(
        printed="x_p, y_p",
        corrected=DEFINED_IN["components of the contact locus"],
        others=("x_G, y_G", "x_p, y_p"),
        holds=lambda letters: letters == DEFINED_IN["components of the contact locus"],
        how="the contact locus is (x_l, y_l) in (6.8) and (6.11); x_p and y_p are not defined",
        correct="x_l and y_l",
        wrong=ClaimStatus.MISPRINT,
    )
