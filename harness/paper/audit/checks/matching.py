"""Section 5.3: the inner and the outer solution matched."""

import mpmath as mp
import sympy as sp

from harness.paper.audit.checks.inner import INNER, P, Q, q, root, t, x
from harness.paper.audit.checks.integrals import RIGHT_FORMS, time
from harness.paper.audit.checks.validity import order_of_the_composite
from harness.paper.audit.evidence import Both, IdentityEvidence, Rate, check
from harness.paper.audit.symbols import Expr, I, T, eps


@check("text:inner in outer")
def inner_in_outer_variable() -> Rate:
    """At a fixed time before the bounce."""

    def remainder(form: Expr) -> "sp.Lambda":
        value = sp.lambdify((eps, q, P, Q, I, t), form, "mpmath")

        def left(small: mp.mpf) -> mp.mpf:
            p, q_, a, width = mp.mpf(2), mp.mpf("0.5"), mp.mpf(3), mp.mpf("0.25")
            before = mp.sqrt(width) - mp.mpf("0.25")
            stretched = (before - mp.sqrt(width)) / mp.sqrt(small)
            full = mp.sqrt(small) * mp.sqrt(p**2 + (mp.sqrt(a) * stretched - q_) ** 2 / p**2)
            return full - value(small, a, p, q_, width, before)

        return left

    return Rate(
        printed=sp.sqrt(q) * (sp.sqrt(I) - t) / P + root * Q / P,
        remainder=remainder,
        stated=1,
        at=(1e-8, 1e-12),
        source="eq01:inner_solution",
    )


STRENGTH = mp.mpf("-0.4")
"""An a_l2 such as the paper's can has."""


def _outer(form: Expr) -> "sp.Lambda":
    """Return what a form leaves of the outer solution at T = -1, for a_3 and a_l2."""
    value = sp.lambdify((eps, q, I, t), form, "mpmath")
    logarithmic = sp.lambdify(time, RIGHT_FORMS["J_l2"], "mpmath")

    def left(small: mp.mpf) -> mp.mpf:
        width, a = mp.mpf("0.25"), mp.mpf(3)
        u = 1 - mp.sqrt(small) / mp.sqrt(width)
        j3 = u**2 / (8 - 8 * u**2) + 3 * u / 8 * mp.atanh(u)
        full = width * (1 - u**2) / 2 + small * 8 * a / width**2 * j3
        beside = logarithmic(u) + mp.log(width / 2) * u / 2 * mp.atanh(u)  # b_l2 J_l2 + b_2 J_2
        full += small * 4 * STRENGTH / width * beside
        return full - value(small, a, width, u * mp.sqrt(width))

    return left


def _in_inner(power: Expr) -> Expr:
    """Return the outer solution in the inner variable; the paper prints 5/2."""
    gap = t - sp.sqrt(I)
    return -sp.sqrt(I) * gap - eps * q / (2 * I**power * gap)


@check("text:outer in inner")
def outer_in_inner_variable() -> Both:
    """At a fixed inner time; and with letters, since the inner solution must meet it."""
    meets = sp.series(sp.sqrt(q / I * eps + I * x**2), eps, 0, 2).removeO()
    derived = sp.expand(meets - sp.sqrt(I) * x) * x
    return Both(
        parts=(
            Rate(
                printed=_in_inner(sp.Rational(5, 2)),
                remainder=_outer,
                corrected=_in_inner(sp.Rational(3, 2)),
                stated=1.5,
                corrected_to=1,
                at=(1e-9, 1e-13),
                source="b_3 J_3, b_2 J_2 and b_l2 J_l2 at fixed T",
            ),
            IdentityEvidence(
                printed=eps * q / (2 * I ** sp.Rational(5, 2)),
                corrected=eps * q / (2 * I ** sp.Rational(3, 2)),
                derived=sp.simplify(derived),
                source="the inner solution with P = sqrt(a_p/I), Q = 0",
            ),
        )
    )


@check("text:P and Q")
def matching_constants() -> IdentityEvidence:
    """Slopes and constants of the two expansions."""
    constant = sp.Symbol("Q")
    slope = sp.solve(sp.sqrt(q) / P - sp.sqrt(I), P)[0]
    return IdentityEvidence(
        printed=sp.Matrix([sp.sqrt(q / I), 0]),
        derived=sp.Matrix([slope, sp.solve(constant / slope, constant)[0]]),
        source="equal slopes sqrt(a_p)/P = sqrt(I), and no constant eps^(1/2) Q/P",
    )


@check("eq01:phi_inner")
def matched_inner() -> IdentityEvidence:
    """Insert P and Q."""
    form = P**2 + q * T**2 / P**2
    return IdentityEvidence(
        printed=INNER**2, derived=form.subs(P, sp.sqrt(q / I)), source="eq01:inner_solution"
    )


@check("eq01:uniformly_valid_solution")
def composite() -> Both:
    """Add, and measure the error against the reduced equation."""
    gap = sp.sqrt(I) - t
    inner = sp.sqrt(eps * q / I + I * gap**2)
    return Both(
        parts=(
            IdentityEvidence(
                printed=-(gap**2) / 2 + inner,
                derived=(I - t**2) / 2 + inner - sp.sqrt(I) * gap,
                source="outer + inner - common part",
            ),
            order_of_the_composite(),
        )
    )
