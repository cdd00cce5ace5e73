"""Sections 5 and 5.3: the regions of the two solutions, and how well they are matched."""

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper import release
from harness.paper.audit import paper_can
from harness.paper.audit.checks.inner import INNER, P, Q, q, root, t, x
from harness.paper.audit.checks.outer import RIGHT_FORMS, time
from harness.paper.audit.checks.reduced import derived
from harness.paper.audit.evidence import NEAR, Both, Fact, IdentityEvidence, Rate, check
from harness.paper.audit.flat_series import NUMBERS
from harness.paper.audit.reduced_form import HAMILTONIAN, POWERS, a_
from harness.paper.audit.symbols import B0, B2, Expr, I, Phi, T, eps, phi
from reference import PAPER_CAN, solve


@check("text:inner in outer")
def inner_in_outer_variable() -> Rate:
    """At a fixed time before the bounce."""

    def remainder(form: Expr, small: mp.mpf) -> mp.mpf:
        value = sp.lambdify((eps, q, P, Q, I, t), form, "mpmath")
        p, q_, a, width = mp.mpf(2), mp.mpf("0.5"), mp.mpf(3), mp.mpf("0.25")
        before = mp.sqrt(width) - mp.mpf("0.25")
        stretched = (before - mp.sqrt(width)) / mp.sqrt(small)
        full = mp.sqrt(small) * mp.sqrt(p**2 + (mp.sqrt(a) * stretched - q_) ** 2 / p**2)
        return full - value(small, a, p, q_, width, before)

    return Rate(
        printed=sp.sqrt(q) * (sp.sqrt(I) - t) / P + root * Q / P,
        remainder=remainder,
        stated=1,
        at=(1e-8, 1e-12),
        source="eq01:inner_solution, of the one-term form, which is what Van Dyke's rule rewrites; "
        "the remainder of (5.10) apart",
    )


STRENGTH = mp.mpf("-0.4")
"""An a_l2 such as the paper's can has."""


def _outer(form: Expr, small: mp.mpf) -> mp.mpf:
    """Return what a form leaves of the outer solution at T = -1, for a_3 and a_l2."""
    value = sp.lambdify((eps, q, I, t), form, "mpmath")
    logarithmic = sp.lambdify(time, RIGHT_FORMS["J_l2"], "mpmath")
    width, a = mp.mpf("0.25"), mp.mpf(3)
    u = 1 - mp.sqrt(small) / mp.sqrt(width)
    j3 = u**2 / (8 - 8 * u**2) + 3 * u / 8 * mp.atanh(u)
    full = width * (1 - u**2) / 2 + small * 8 * a / width**2 * j3
    beside = logarithmic(u) + mp.log(width / 2) * u / 2 * mp.atanh(u)  # b_l2 J_l2 + b_2 J_2
    full += small * 4 * STRENGTH / width * beside
    return full - value(small, a, width, u * mp.sqrt(width))


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
        IdentityEvidence(
            printed=-(gap**2) / 2 + inner,
            derived=(I - t**2) / 2 + inner - sp.sqrt(I) * gap,
            source="outer + inner - common part",
        ),
        logarithms_in_the_remainder("composite", 0),
    )


DIGITS = 38
"""An error of order 1e-27 of a time of order 0.1, to ten digits."""
DECADES = (18, 21, 24, 27)
"""Powers of 1/eps: here eps^(1/2) times any power of the logarithm is below a thousandth."""
FLAT = mp.mpf("0.001")
"""A difference this small against the one before it is none."""
RULE = "gauss-legendre"
"""The integrands are smooth, and no node lies so near an end that differences cancel there."""


def _left_at(share: mp.mpf) -> mp.mpf:
    """Return phi/eps^(1/2) where the leading outer solution is off by a share of the inner one."""
    # near the bounce: outer sqrt(I) s, true sqrt(eps a_p/I + I s^2)
    gap = (1 - share) ** 2 / (1 - (1 - share) ** 2) * paper_can.a_p / paper_can.WIDTH
    return mp.sqrt(paper_can.a_p / paper_can.WIDTH + gap)


@cache
def reach_of_the_outer_solution() -> tuple[mp.mpf, mp.mpf]:
    """Return the power of eps in the phi at which the outer solution is off by a hundredth.

    Also the factor. Measured on the motion of phi'' = -1 + eps a_p/phi^3.
    """
    places = []
    for small in (mp.mpf("1e-10"), mp.mpf("1e-14")):
        lift = small * paper_can.a_p

        def speed(y: mp.mpf, lift: mp.mpf = lift) -> mp.mpf:
            top = paper_can.WIDTH / 2
            return mp.sqrt(2 * (top - y) + lift * (top**-2 - y**-2))

        def off(y: mp.mpf, speed: Callable[[mp.mpf], mp.mpf] = speed) -> mp.mpf:
            top = paper_can.WIDTH / 2
            # (top - s^2): the root at the top is gone
            time = mp.quad(lambda s: 2 * s / speed(top - s**2), [0, mp.sqrt(top - y)], method=RULE)
            return (paper_can.WIDTH - time**2) / 2 / y - 1 + NEAR

        guess = _left_at(NEAR) * mp.sqrt(small)
        places.append(mp.findroot(off, (guess / 2, 2 * guess), solver="anderson", tol=1e-10))
    power = mp.log(places[0] / places[1]) / mp.log(mp.mpf("1e4"))
    return power, places[0] / mp.mpf("1e-10") ** power


@check("text:outer region", "text:regular perturbation")
def outer_region() -> Fact:
    """Find how the nutation at which the outer solution is left depends on eps."""
    power, factor = reach_of_the_outer_solution()
    return Fact(
        printed=mp.mpf(0),
        corrected=mp.mpf("0.5"),
        holds=lambda stated: bool(abs(power - stated) < mp.mpf("0.02")),
        how=f"the outer solution is within 1 % down to phi = {mp.nstr(factor, 3)} "
        f"eps^{mp.nstr(power, 4)}: quadrature at eps = 1e-10 and 1e-14; and phi is never above "
        "pi/100 in the paper's motion",
    )


@check("text:inner region")
def inner_region() -> Rate:
    """Compare the inner solution with the fall phi'' = -1 that it passes into, at small phi."""

    def remainder(form: Expr, y: mp.mpf) -> mp.mpf:
        before = mp.sqrt(paper_can.WIDTH) - mp.sqrt(paper_can.WIDTH - 2 * y)
        return sp.lambdify((I, T), form, "mpmath")(paper_can.WIDTH, before) / y - 1

    printed = sp.sqrt(I) * T  # of (5.13), once eps is small beside phi^2
    top = paper_can.WIDTH / 2
    left = mp.findroot(lambda share: remainder(printed, share * top) - NEAR, (NEAR, 10 * NEAR))
    return Rate(
        printed=printed,
        remainder=remainder,
        stated=1,
        at=(1e-6, 1e-9),
        source="the fall, for phi << phi(0), which is phi << 1 where I = O(1), as the expansion "
        "assumes; in the paper's motion phi << pi/100: the error relative to phi is 1 % at phi = "
        f"{mp.nstr(left, 2)} phi(0)",
    )


@cache
def _potential() -> Callable[[mp.mpf, mp.mpf], mp.mpf]:
    """Return the potential of the reduced equation of phi and eps, for zeta = 0.4."""
    motion = {B0: sp.Rational(2, 5), B2: 1}
    forms = [derived(name).subs(motion) for name in POWERS]
    values = [sp.lambdify(list(NUMBERS), form, "mpmath")(*NUMBERS.values()) for form in forms]
    function = sp.lambdify((phi, eps, *a_.values()), HAMILTONIAN.subs(Phi, 0), "mpmath")
    return lambda y, small: function(y, small, *values)


@cache
def errors_in_the_bounce(power: int) -> dict[str, mp.mpf]:
    """Return the errors in phi of (5.13) and of (5.14) for eps = 10^-power.

    Measured where varphi is twice its smallest, by quadrature of the reduced equation.
    """
    with mp.workdps(DIGITS):
        small, top = mp.mpf(10) ** -power, paper_can.WIDTH / 2
        energy = _potential()
        low = 2 * mp.sqrt(small * paper_can.a_p / paper_can.WIDTH)

        def per_log(u: mp.mpf) -> mp.mpf:
            y = mp.exp(u)
            return y / mp.sqrt(2 * (energy(top, small) - energy(y, small)))

        def per_root(s: mp.mpf) -> mp.mpf:
            y = top - s**2
            return 2 * s / mp.sqrt(2 * (energy(top, small) - energy(y, small)))

        middle = top / 2
        cuts = mp.linspace(mp.log(low), mp.log(middle), power // 2)
        time = mp.quad(per_log, cuts, method=RULE)
        time += mp.quad(per_root, [0, mp.sqrt(top - middle)], method=RULE)
        gap = mp.sqrt(paper_can.WIDTH) - time
        inner = mp.sqrt(small * paper_can.a_p / paper_can.WIDTH + paper_can.WIDTH * gap**2)
        return {"inner": inner - low, "composite": inner - gap**2 / 2 - low}


@cache
def logarithms_of_the_error(solution: str) -> tuple[int, list[mp.mpf]]:
    """Return the degree of error/eps as a polynomial in log eps, and its differences."""
    errors = [errors_in_the_bounce(power)[solution] * mp.mpf(10) ** power for power in DECADES]
    differences = [errors[0]]
    while len(errors) > 1:
        errors = [after - before for before, after in pairwise(errors)]
        differences.append(errors[0])
    degree = len(DECADES) - 1
    while abs(differences[degree]) < FLAT * abs(differences[degree - 1]):
        degree -= 1
    return degree, differences


def logarithms_in_the_remainder(solution: str, printed: int) -> Fact:
    """Find how often the logarithm multiplies eps in the error in phi of a solution."""
    degree, differences = logarithms_of_the_error(solution)
    listed = ", ".join(mp.nstr(x, 4) for x in differences)
    return Fact(
        printed=printed,
        corrected=2,
        holds=lambda power: power == degree,
        how="the error in phi over eps where varphi is twice its smallest (zeta = 0.4), for eps = "
        f"1e-18 to 1e-27 in steps of 1e-3: its differences are {listed}, those of a polynomial of "
        f"degree {degree} in log eps",
    )


@check("eq01:inner_solution")
def inner_solution() -> Both:
    """Differentiate twice; and measure the error with the P and Q that the paper matches."""
    lean = sp.sqrt(q) * T - Q
    return Both(
        IdentityEvidence(
            printed=sp.sqrt(P**2 + lean**2 / P**2),
            compared=lambda form: sp.simplify(form.diff(T, 2) * form**3),
            derived=q,
            source="eq01:inner_problem",
        ),
        logarithms_in_the_remainder("inner", 1),
    )


SEEN = 0.05
"""A twentieth of a panel is seen in print."""


@cache
def _truth(epsilon: float) -> "tuple[np.ndarray, np.ndarray]":
    """Return the reduced equation's nutations before the bounce and the times they are met."""
    posed = release.of_constants(epsilon, 0.4, bounces=1)
    bounce_time = math.sqrt(2 * release.PHI)
    tau = bounce_time - np.geomspace(math.sqrt(epsilon) / 10, bounce_time, 300)
    truth = solve(posed, model="reduced").at(tau * math.sqrt(PAPER_CAN.pendulum_inertia))
    return tau, truth.phi


def _error(form: Expr, epsilon: float) -> float:
    """Largest error of a form of phi(t) against the reduced equation, up to the bounce."""
    tau, phi = _truth(epsilon)
    value = sp.lambdify((eps, q, I, t), form, "numpy")
    return float(np.abs(value(epsilon, PAPER_CAN.a_p, 2 * release.PHI, tau) - phi).max())


@check("text:matched agreement")
def matched_agreement() -> Rate:
    """Largest error before the bounce: it is to fall as no form that is wrong at eps^(1/2) does."""
    gap = sp.sqrt(I) - t
    inner = sp.sqrt(eps * q / I + I * gap**2)
    return Rate(
        printed=inner - gap**2 / 2,
        remainder=lambda form, small: mp.mpf(_error(form, float(small))),
        stated=1,
        at=release.STEEP,
        source="the reduced equation with zeta = 0.4, the largest error of phi before the bounce "
        f"({_error(inner - gap**2 / 2, release.STEEP[0]):.2e} at eps = 1e-8)",
    )


@check("caption:fig01:inner_outer_comp")
def outer_solution_departs() -> Fact:
    """Distance of the leading outer solution from the composite, of the height of the panel."""
    width, strength = float(paper_can.WIDTH), 1.43e-10 * float(paper_can.a_p)

    def apart(t: float) -> float:
        gap = math.sqrt(width) - t
        matched = math.sqrt(strength / width + width * gap**2) - gap**2 / 2
        return abs(matched - (width - t**2) / 2)

    end, panel = math.sqrt(width), (width - 0.247**2) / 2
    return Fact(
        printed=0.247,
        holds=lambda start: apart(end) > SEEN * (width - start**2) / 2 > apart(start),
        how=f"at t = sqrt(I) the two are {apart(end):.2e} apart, {apart(end) / panel:.0%} of the "
        f"panel, which starts at phi = {panel:.2e}; at t = 0.247 "
        f"{apart(0.247):.1e}",
    )
