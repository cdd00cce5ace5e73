"""Psi and Theta near the flat state as series with letters, derived from the closed subsystem.

Psi = B_0 Psi_0 + B_2 Psi_2 with Psi_0 = 1 + ..., Psi_2 = C Psi_0 log phi + phi^-2 + ... and no
phi^0 term (the paper's choice q_2 = 0). `log_phi` stands for log phi.
Coefficients are in k, h and c_p.
"""

from collections import defaultdict
from collections.abc import Sequence
from functools import cache

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can, symbols
from harness.paper.audit.symbols import B0, B2, Expr, log_phi, phi

k, h, c_p = sp.symbols("k h c_p", positive=True)
A_P = (c_p - 1 + k * h**2) / (k * c_p)
"""a_p follows from k, h and c_p, as k = c/(a + c a_p)."""
TERMS = 5
COT, SIN, COS, COS_2 = (
    sp.series(function, phi, 0, 11).removeO()
    for function in (sp.cot(phi), sp.sin(phi), sp.cos(phi), sp.cos(2 * phi))
)


NUMBERS = {k: paper_can.k, h: paper_can.h, c_p: paper_can.c_p}


@cache
def valued(form: Expr, *letters: Expr) -> "sp.Lambda":
    """Return a form in phi and its logarithm as a function of phi and letters, for the can."""
    function = sp.lambdify((phi, log_phi, *letters, *NUMBERS), form, "mpmath")
    return lambda x, *values: function(x, mp.log(x), *values, *NUMBERS.values())


def slope(expression: Expr) -> Expr:
    """Differentiate in phi, log phi included."""
    return expression.diff(phi) + expression.diff(log_phi) / phi


def terms(expression: Expr) -> dict[tuple[int, int], Expr]:
    """Return the coefficient of each phi^power (log phi)^logs that there is, by (power, logs)."""
    found: dict[tuple[int, int], list[Expr]] = defaultdict(list)
    for term in sp.Add.make_args(sp.expand(expression)):
        rest, power = term.as_coeff_exponent(phi)
        rest, logs = rest.as_coeff_exponent(log_phi)
        found[int(power), int(logs)].append(rest)
    return {powers: sp.Add(*parts) for powers, parts in found.items()}


def up_to(expression: Expr, power: int) -> Expr:
    """Drop every term of a higher power of phi."""
    return product(sp.Integer(1), expression, power)


def product(left: Expr, right: Expr, power: int) -> Expr:
    """Return the product of two series, in which no term of a higher power of phi is formed."""
    factors = terms(left), terms(right)
    return sp.Add(
        *(
            sp.expand(x * y) * phi ** (i + j) * log_phi ** (m + n)
            for (i, m), x in factors[0].items()
            for (j, n), y in factors[1].items()
            if i + j <= power
        )
    )


def coefficient(expression: Expr, power: int, logs: int = 0) -> Expr:
    """Coefficient of phi^power (log phi)^logs."""
    return sp.factor(terms(expression).get((power, logs), sp.Integer(0)))


def second_order(psi: Expr) -> Expr:
    """Left side of eq01:frob_ode."""
    return slope(slope(psi)) + 3 * COT * slope(psi) - (2 + k + k * h * COT) * psi


def _solution(first: Expr, others: Sequence[Expr]) -> Expr:
    """Return a solution of eq01:frob_ode: a first term, and as much of each other as it asks for.

    Each of the others takes away the lowest power of phi without a logarithm that is left over.
    """
    found, left = first, terms(second_order(first))
    for other in others:
        more = terms(second_order(other))
        lowest = min(power for power, logs in more if not logs)
        share = sp.factor(-left[lowest, 0] / more[lowest, 0])
        found += share * other
        left = {key: left.get(key, 0) + share * more.get(key, 0) for key in {**left, **more}}
    return found


@cache
def regular_solution() -> Expr:
    """Psi_0 to phi^5."""
    return _solution(sp.Integer(1), [phi**n for n in range(1, TERMS + 1)])


@cache
def singular_solution() -> Expr:
    """Psi_2 to phi^5: the coefficients of phi^-2, phi^-1, the logarithm, phi, ... in turn."""
    tail = [phi**n for n in range(1, TERMS + 1)]
    return sp.expand(_solution(phi**-2, [1 / phi, regular_solution() * log_phi, *tail]))


@cache
def precession() -> Expr:
    """Psi to phi^3."""
    return up_to(B0 * regular_solution() + B2 * singular_solution(), 3)


@cache
def rotation_rate() -> Expr:
    """Theta to phi^2, from eq01:psi_diff_phi."""
    psi = B0 * regular_solution() + B2 * singular_solution()
    kc = k * c_p
    turned = product(slope(psi), SIN, 2) - product(psi, (kc - 2) * COS - h * k * SIN, 2)
    return sp.expand(turned / kc)


@cache
def drive() -> Expr:
    """Return what the rates add to (a_p + 1) phi'' in eq01:Phi, to phi^1."""
    psi = precession()
    square = product(psi, psi, 1), (A_P - c_p) * SIN * COS - h * COS_2
    mixed = product(psi, rotation_rate(), 1), c_p * SIN + h * COS
    return product(*square, 1) - product(*mixed, 1)


@cache
def drive_terms() -> dict[tuple[int, int], Expr]:
    """Return the coefficients of the drive, factored, by their powers of phi and log phi."""
    factored = ((powers, sp.factor(form)) for powers, form in terms(drive()).items())
    return {powers: form for powers, form in factored if form != 0}


def in_inertias(expression: Expr) -> Expr:
    """Write k and c_p with a, c and h, in which nothing is hidden."""
    return expression.subs({k: symbols.k, c_p: symbols.c_p, h: symbols.h}, simultaneous=True)


def in_latex(expression: Expr) -> str:
    """Return LaTeX with the paper's B_{-2}."""
    return str(sp.latex(expression)).replace("B_{2}", "B_{-2}")
