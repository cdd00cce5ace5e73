"""The paper's letters, and when an expression in them is zero.

Dimensional letters are written with the dimensionless ones (eq01:scalings), so that one symbol
stands for one quantity.
"""

import random
from typing import Any, TypeAlias

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can

Expr: TypeAlias = Any
"""A sympy expression or matrix: sympy's own types do not survive its arithmetic."""

a, c, h, m, R, g = sp.symbols("a c h m R g", positive=True)
A, C, H = a * m * R**2, c * m * R**2, h * R
a_p, c_p = a + h**2, c + 1
k = c / (a + c * a_p)
phi, psi, theta = sp.symbols("phi psi theta", positive=True)
Phi, Psi, Theta = sp.symbols("Phi Psi Theta", real=True)
phi_dd, psi_dd, theta_dd = sp.symbols("phi_dd psi_dd theta_dd", real=True)
S, Co = sp.sin(phi), sp.cos(phi)
CAN = {a: paper_can.a, c: paper_can.c, h: paper_can.h}
"""The letters of the paper's can."""
log_phi = sp.Symbol("log_phi", real=True)
B0, B2 = sp.symbols("B_0 B_2", real=True)
eps, zeta, tau, T = sp.symbols("epsilon zeta tau T", positive=True)
I = sp.Symbol("I", positive=True)  # noqa: E741 - the paper's letter for twice the release

DIGITS = 40
POINTS = 3
ZERO = mp.mpf(10) ** -25
"""Rounding at 40 digits, with room for the cancellation of a hundred terms."""


def rational(expression: Expr) -> Expr:
    """Write sines and cosines through half-angle tangents: identities become polynomial."""
    angles = {
        function.args[0]
        for function in sp.sympify(expression).atoms(sp.sin, sp.cos, sp.tan, sp.cot)
    }
    plain = sp.expand_trig(expression)
    rules: dict[Expr, Expr] = {}
    for angle in sp.Tuple(plain).atoms(sp.Symbol) & {x for y in angles for x in y.atoms(sp.Symbol)}:
        half = sp.Symbol(f"t_{angle.name}")
        rules[sp.sin(angle)] = 2 * half / (1 + half**2)
        rules[sp.cos(angle)] = (1 - half**2) / (1 + half**2)
        rules[sp.tan(angle)] = 2 * half / (1 - half**2)
        rules[sp.cot(angle)] = (1 - half**2) / (2 * half)
    return plain.subs(rules)


def tidy(expression: Expr) -> Expr:
    """Expand a polynomial in sines and cosines; every square of a sine becomes a cosine's."""
    if isinstance(expression, sp.MatrixBase):
        return expression.applyfunc(tidy)
    plain = sp.expand(expression)
    for angle in (phi, psi, theta):
        sine, cosine = sp.sin(angle), sp.cos(angle)
        plain = sp.expand(sp.rem(plain, sine**2 + cosine**2 - 1, sine))
    return plain


def entries(expression: Expr) -> list[Expr]:
    """Return the components of a vector or matrix, or the expression itself."""
    return list(expression) if isinstance(expression, sp.MatrixBase) else [sp.sympify(expression)]


def vanishes(expression: Expr) -> bool:
    """Whether an expression is zero identically."""
    for entry in entries(expression):
        numerator = sp.numer(sp.together(rational(entry)))
        if sp.expand(numerator) != 0 and sp.simplify(numerator) != 0:
            return False
    return True


def disagreement(printed: Expr, derived: Expr) -> mp.mpf:
    """Largest relative difference of two expressions at random points, to 40 digits."""
    left, right = entries(printed), entries(derived)
    letters = sorted(sp.Tuple(*left, *right).free_symbols, key=str)
    functions = [sp.lambdify(letters, side, "mpmath") for side in (left, right)]
    generator = random.Random(1)  # noqa: S311 - no secret, the same points each time
    worst = mp.mpf(0)
    with mp.workdps(DIGITS):
        for _ in range(POINTS):
            point = [mp.mpf(generator.randint(150, 950)) / 1000 for _ in letters]
            values = [[mp.mpmathify(x) for x in function(*point)] for function in functions]
            scale = max([abs(x) for side in values for x in side] + [mp.mpf("1e-3")])
            gap = max(abs(x - y) for x, y in zip(*values, strict=True))
            worst = max(worst, gap / scale)
    return worst
