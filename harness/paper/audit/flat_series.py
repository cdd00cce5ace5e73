"""Psi and Theta near the flat state as series with letters, derived from the closed subsystem.

Psi = B_0 Psi_0 + B_2 Psi_2 with Psi_0 = 1 + ..., Psi_2 = C Psi_0 log phi + phi^-2 + ... and no
phi^0 term (the paper's choice q_2 = 0). `log_phi` stands for log phi.
Coefficients are in k, h and c_p.
"""

from functools import cache

import sympy as sp

from harness.paper.audit import symbols
from harness.paper.audit.symbols import B0, B2, Expr, log_phi, phi

k, h, c_p = sp.symbols("k h c_p", positive=True)
A_P = (c_p - 1 + k * h**2) / (k * c_p)
"""a_p follows from k, h and c_p, as k = c/(a + c a_p)."""
TERMS = 5
COT, SIN, COS, COS_2 = (
    sp.series(function, phi, 0, 11).removeO()
    for function in (sp.cot(phi), sp.sin(phi), sp.cos(phi), sp.cos(2 * phi))
)


def slope(expression: Expr) -> Expr:
    """Differentiate in phi, log phi included."""
    return expression.diff(phi) + expression.diff(log_phi) / phi


def up_to(expression: Expr, power: int) -> Expr:
    """Drop every term of a higher power of phi."""
    kept = [
        term
        for term in sp.Add.make_args(sp.expand(expression))
        if term.as_coeff_exponent(phi)[1] <= power
    ]
    return sp.Add(*kept)


def coefficient(expression: Expr, power: int, logs: int = 0) -> Expr:
    """Coefficient of phi^power (log phi)^logs."""
    return sp.factor(sp.expand(expression).coeff(phi, power).coeff(log_phi, logs))


def second_order(psi: Expr) -> Expr:
    """Left side of eq01:frob_ode."""
    return slope(slope(psi)) + 3 * COT * slope(psi) - (2 + k + k * h * COT) * psi


@cache
def regular_solution() -> Expr:
    """Psi_0 to phi^5."""
    found = sp.Integer(1)
    for n in range(1, TERMS + 1):
        letter = sp.Symbol("p")
        left = sp.expand(second_order(found + letter * phi**n)).coeff(phi, n - 2)
        found += sp.factor(sp.solve(left, letter)[0]) * phi**n
    return found


@cache
def singular_solution() -> Expr:
    """Psi_2 to phi^5: the coefficients of phi^-2, phi^-1, the logarithm, phi, ... in turn."""
    found, letter = phi**-2, sp.Symbol("q")
    for n in range(1, TERMS + 3):
        power = n - 2
        trial = letter * (regular_solution() * log_phi if power == 0 else phi**power)
        left = sp.expand(second_order(found + trial)).coeff(log_phi, 0).coeff(phi, power - 2)
        found += trial.subs(letter, sp.factor(sp.solve(left, letter)[0]))
    return sp.expand(found)


@cache
def precession() -> Expr:
    """Psi to phi^3."""
    return up_to(B0 * regular_solution() + B2 * singular_solution(), 3)


@cache
def rotation_rate() -> Expr:
    """Theta to phi^2, from eq01:psi_diff_phi."""
    psi = B0 * regular_solution() + B2 * singular_solution()
    kc = k * c_p
    return up_to((slope(psi) * SIN - ((kc - 2) * COS - h * k * SIN) * psi) / kc, 2)


@cache
def drive() -> Expr:
    """Return what the rates add to (a_p + 1) phi'' in eq01:Phi, to phi^1."""
    square = (A_P - c_p) * SIN * COS - h * COS_2
    psi = precession()
    return up_to(square * psi**2 - (c_p * SIN + h * COS) * rotation_rate() * psi, 1)


def in_inertias(expression: Expr) -> Expr:
    """Write k and c_p with a, c and h, in which nothing is hidden."""
    return expression.subs({k: symbols.k, c_p: symbols.c_p, h: symbols.h}, simultaneous=True)


def in_latex(expression: Expr) -> str:
    """Return LaTeX with the paper's B_{-2}."""
    return str(sp.latex(expression)).replace("B_{2}", "B_{-2}")
