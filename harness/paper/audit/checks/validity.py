"""Where the formulas hold: regions, orders of what is neglected, and what determines what."""

from collections.abc import Callable
from functools import cache, partial
from itertools import pairwise

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper.audit import flat_series as series
from harness.paper.audit import paper_can, release
from harness.paper.audit.checks.frictionless import _reduced
from harness.paper.audit.checks.hamiltonian import MENDED
from harness.paper.audit.checks.outer import POWERS, a_
from harness.paper.audit.evidence import Fact
from harness.paper.audit.flat_series import A_P, COS, COS_2, SIN
from harness.paper.audit.registry import claim
from harness.paper.audit.symbols import B0, B2, Expr, Phi, a, c, eps, h, k, log_phi, phi, zeta

DIGITS = 38
"""An error of order 1e-27 of a time of order 0.1, to ten digits."""
DECADES = (18, 21, 24, 27)
"""Powers of 1/eps: here eps^(1/2) times any power of the logarithm is below a thousandth."""
FLAT = mp.mpf("0.001")
"""A difference this small against the one before it is none."""
RULE = "gauss-legendre"
"""The integrands are smooth, and no node lies so near an end that differences cancel there."""
NEAR = mp.mpf("0.01")
"""Relative error at which an approximation is left: the power of eps does not depend on it."""


@claim(
    "text:regular singular point",
    "4.1",
    "phi cot phi and phi^2 (gamma + beta cot phi) have Taylor series",
)
def regular_singular_point() -> Fact:
    """Limits at phi = 0; divided once more by phi they have none."""
    gamma, beta = sp.symbols("gamma beta", positive=True)
    pair = phi * sp.cot(phi), phi**2 * (gamma + beta * sp.cot(phi))

    def bounded(power: int) -> bool:
        return all(sp.limit(form * phi**power, phi, 0).is_finite for form in pair)

    return Fact(
        printed=0,
        others=(-1, -2),
        holds=bounded,
        how="sympy: their limits are 1 and 0, and both are quotients of analytic functions",
    )


@claim("text:log terms", "4.1", "there will be log terms in the r = -2 solution")
def logarithms() -> Fact:
    """Factor k h^2 - 1, to which the strength of the logarithm is proportional."""
    strength = sp.factor(sp.together(1 - k * h**2))
    return Fact(
        printed=1,
        others=(0, 2),
        holds=lambda value: (
            bool(sp.factor(sp.together(value - k * h**2)).is_positive)
            and sp.limit((k * h**2).subs({a: 1, c: 1}), h, sp.oo) == value
        ),
        how=f"sympy: C = k (1 - k h^2)/2 q_0 with 1 - k h^2 = {strength} > 0; exponents that "
        "differ by an integer alone would only allow a logarithm",
    )


KEPT = {"those of (4.14)": (0, 1), "up to phi": (1, 1), "up to phi^2": (2, 2)}
"""Largest power of phi kept without and with a logarithm."""


def _cut(form: Expr, plain: int, logs: int) -> Expr:
    kept = [
        term
        for term in sp.Add.make_args(sp.expand(form))
        if term.as_coeff_exponent(phi)[1] <= (logs if term.has(log_phi) else plain)
    ]
    return sp.Add(*kept)


@cache
def lost_coefficients(kept: str) -> tuple[str, ...]:
    """Return which coefficients of (4.19) come out wrong from series with these terms."""
    # some can and some motion, in rational numbers: an error for one is an error
    letters = {
        series.k: sp.Rational(1, 4),
        series.h: sp.Rational(3, 2),
        series.c_p: sp.Rational(8, 5),
    }
    values = letters | {B0: sp.Rational(2, 5), B2: 1}
    whole = [form.subs(values) for form in (series.precession(), series.rotation_rate())]

    def drive(psi: Expr, theta: Expr) -> Expr:
        square = ((A_P - series.c_p) * SIN * COS - series.h * COS_2).subs(letters)
        side = (series.c_p * SIN + series.h * COS).subs(letters)
        return sp.expand(square * psi**2 - side * theta * psi)

    left = sp.expand(drive(*(_cut(form, *KEPT[kept]) for form in whole)) - drive(*whole))
    return tuple(
        f"a_{name}"
        for name, (power, logs) in POWERS.items()
        if left.coeff(phi, -power).coeff(log_phi, logs) != 0
    )


@claim("text:series suffice", "4.3", "substituting the series (4.14) into (2.13c) gives (4.19)")
def series_that_suffice() -> Fact:
    """Substitute series cut at several powers, and compare the eight coefficients."""
    lost = lost_coefficients("those of (4.14)")
    return Fact(
        printed="those of (4.14)",
        corrected="up to phi^2",
        others=("up to phi", "those of (4.14)"),
        holds=lambda kept: not lost_coefficients(kept),
        how=f"sympy: with the terms of (4.14) {', '.join(lost)} come out wrong, since "
        "-h Psi (Psi + Theta) multiplies what is dropped with phi^-2",
        correct="Psi and Theta are needed up to phi^2, with the terms phi log phi, phi^2 log phi, "
        "phi and phi^2 that (4.14) drops",
    )


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


def _outer_region() -> Fact:
    power, factor = reach_of_the_outer_solution()
    return Fact(
        printed=mp.mpf(0),
        corrected=mp.mpf("0.5"),
        others=(mp.mpf(0), mp.mpf("0.25"), mp.mpf(1)),
        holds=lambda stated: bool(abs(power - stated) < mp.mpf("0.02")),
        how=f"the outer solution is within 1 % down to phi = {mp.nstr(factor, 3)} "
        f"eps^{mp.nstr(power, 4)}: quadrature at eps = 1e-10 and 1e-14; and phi is never above "
        "pi/100 in the paper's motion",
        correct="phi >> eps^(1/2); for phi >> 1, which no can reaches, the reduced equation, "
        "expanded for small phi, does not hold",
    )


claim("text:outer region", "5", "the outer region is phi >> 1", name="outer_region")(
    partial(_outer_region)
)
claim(
    "text:regular perturbation",
    "5.1",
    "when phi >> 1, phi = phi_0 + eps phi_1",
    name="outer_region",
)(partial(_outer_region))


@claim("text:inner ansatz", "5.2", "varphi = varphi_0 + eps^(1/2) varphi_1 + O(eps)")
def order_of_the_inner_correction() -> Fact:
    """Largest term that (5.8) adds to its leading order."""
    x = sp.Symbol("varphi", positive=True)
    root = sp.sqrt(eps)
    added = root * (a_["l2"] * (sp.log(eps) / 2 + sp.log(x)) + a_["2"]) / x**2 - root

    def balanced(order: Expr) -> bool:
        ratio = sp.limit(sp.expand(added / order), eps, 0)
        return bool(ratio.is_finite) and ratio != 0

    return Fact(
        printed=root,
        corrected=root * sp.log(eps),
        others=(root, root * sp.log(eps) ** 2, eps),
        holds=balanced,
        how="sympy: (5.8) adds eps^(1/2) a_l2 log(eps^(1/2) varphi)/varphi^2, which over eps^(1/2) "
        "has no limit; (5.10) itself states O(eps^(1/2) log eps)",
        correct="terms of order eps^(1/2) log eps, which (5.8) forces, and eps^(1/2) (log eps)^2, "
        "which the matching adds, come before that of eps^(1/2)",
    )


@cache
def _potential() -> Callable[[mp.mpf, mp.mpf], mp.mpf]:
    """Return the potential of the reduced equation of phi and eps, for zeta = 0.4."""
    letters = {series.k: paper_can.k, series.h: paper_can.h, series.c_p: paper_can.c_p}
    values = []
    for power, logs in POWERS.values():
        form = series.coefficient(series.drive(), -power, logs).subs({B0: sp.Rational(2, 5), B2: 1})
        values.append(sp.lambdify(list(letters), form, "mpmath")(*letters.values()))
    function = sp.lambdify((phi, eps, *(a_[n] for n in POWERS)), MENDED.subs(Phi, 0), "mpmath")
    return lambda y, small: function(y, small, *values)


@cache
def error_of_the_composite(power: int) -> mp.mpf:
    """Return the error of (5.14) where varphi is twice its smallest, for eps = 10^-power."""
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
        return inner - gap**2 / 2 - low


@cache
def logarithms_of_the_error() -> tuple[int, list[mp.mpf]]:
    """Return the degree of error/eps as a polynomial in log eps, and its differences."""
    errors = [error_of_the_composite(power) * mp.mpf(10) ** power for power in DECADES]
    differences = [errors[0]]
    while len(errors) > 1:
        errors = [after - before for before, after in pairwise(errors)]
        differences.append(errors[0])
    degree = len(DECADES) - 1
    while abs(differences[degree]) < FLAT * abs(differences[degree - 1]):
        degree -= 1
    return degree, differences


def order_of_the_composite() -> Fact:
    """Find how often the logarithm multiplies eps in the error of (5.14), printed as O(eps)."""
    degree, differences = logarithms_of_the_error()
    told = ", ".join(mp.nstr(x, 4) for x in differences)
    return Fact(
        printed=0,
        corrected=2,
        others=(0, 1, 3),
        holds=lambda power: power == degree,
        how="error/eps where varphi is twice its smallest (zeta = 0.4), for eps = 1e-18 to 1e-27 "
        f"in steps of 1e-3: its differences are {told}, those of a polynomial of degree {degree} "
        "in log eps",
        correct="O(eps (log eps)^2): the term a_l2 log(phi)/phi^2 delays the bounce by "
        "O(eps (log eps)^2)",
    )


@claim("text:inner valid for T<0", "6.1", "the inner solution for psi is only valid for T < 0")
def sides_of_the_bounce() -> Fact:
    """Compare the angle past the bounce with the exact motion, on both sides."""
    solution = release.bounce()
    bounce = solution.bounces[0]
    a_p = float(paper_can.a_p)
    factor = np.sqrt((a_p + 1) / a_p)
    # arctan(I T/sqrt(a_p)) = arctan(rate t): the rate from the exact peak alone
    rate = bounce.peak_psi_dot / factor
    errors = {}
    for side, sign in (("T < 0", -1), ("T > 0", 1)):
        times = bounce.time + sign * np.geomspace(0.1, 100, 60) / rate
        angle = solution.at(times).psi - solution.at(np.array([bounce.time])).psi
        errors[side] = float(np.abs(angle - factor * np.arctan(rate * (times - bounce.time))).max())
    return Fact(
        printed=("T < 0",),
        corrected=("T < 0", "T > 0"),
        others=(("T < 0",), ("T > 0",)),
        holds=lambda sides: set(sides) == {s for s, e in errors.items() if e < float(NEAR)},
        how="angle from the bottom of the bounce against the exact release, "
        "up to 100 times its "
        "width: " + ", ".join(f"{error:.1e} rad for {side}" for side, error in errors.items()),
        correct="it is valid on both sides of the bounce, as (5.9) does not change under T -> -T",
    )


@claim(
    "text:errors of no account",
    "4.3",
    "the errors of the reduced equation do not matter for the turn",
)
def errors_of_the_reduced_equation() -> Fact:
    """Turn of the reduced equation against the exact turn."""
    exact = float(np.degrees(release.bounce().bounces[0].angle_of_turn))
    reduced = float(np.degrees(release.reduced_bounce().bounces[0].angle_of_turn))
    return Fact(
        printed=0.1,
        others=(1e-3, 1e-2),
        holds=lambda within: abs(reduced - exact) < within,
        how=f"turn {reduced:.3f} degrees by (4.22), {exact:.3f} exact: {abs(reduced - exact):.3f} "
        "apart, and the paper gives whole degrees",
    )


@claim("text:expanding in eps", "B", "expanding in eps gives, on truncation, (B.7)")
def expansion_without_friction() -> Fact:
    """Expand what the momenta add in either letter: (B.7) has powers of phi."""
    values = {a: 1, c: sp.Rational(1, 2), h: 1, zeta: 2, Phi: 0}
    side = sp.cos(phi) - h * sp.sin(phi)
    added = (eps * (_reduced() + side / (a + side**2))).subs(values)
    expanded = {
        "eps": sp.series(added, eps, 0, 2).removeO(),
        "phi": sp.series(added, phi, 0, 1).removeO(),
    }
    return Fact(
        printed="eps",
        corrected="phi",
        others=("eps",),
        holds=lambda letter: sp.expand(expanded[letter] * phi**3).is_polynomial(phi),
        how="sympy: eps multiplies a function of sin phi and cos phi, once and exactly; the powers "
        "of phi in (B.7) come from expanding in phi",
        correct="expanding in phi",
    )
