"""Where the formulas hold: regions, orders of what is neglected, and what determines what."""

from collections.abc import Callable
from functools import cache
from itertools import pairwise

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper.audit import flat_series as series
from harness.paper.audit import paper_can, release
from harness.paper.audit.checks.frictionless import _reduced
from harness.paper.audit.checks.hamiltonian import MENDED
from harness.paper.audit.checks.inner import largest_addition, root
from harness.paper.audit.checks.outer import POWERS, a_
from harness.paper.audit.evidence import Fact, check, check_each
from harness.paper.audit.flat_series import A_P, COS, COS_2, SIN
from harness.paper.audit.symbols import B0, B2, Expr, Phi, a, c, eps, h, log_phi, phi, zeta

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


@check("text:regular singular point")
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


@check("text:series suffice")
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


@check_each({"text:outer region": (), "text:regular perturbation": ()})
def outer_region() -> Fact:
    """Find how the nutation at which the outer solution is left depends on eps."""
    power, factor = reach_of_the_outer_solution()
    return Fact(
        printed=mp.mpf(0),
        corrected=mp.mpf("0.5"),
        others=(mp.mpf(0), mp.mpf("0.25"), mp.mpf(1)),
        holds=lambda stated: bool(abs(power - stated) < mp.mpf("0.02")),
        how=f"the outer solution is within 1 % down to phi = {mp.nstr(factor, 3)} "
        f"eps^{mp.nstr(power, 4)}: quadrature at eps = 1e-10 and 1e-14; and phi is never above "
        "pi/100 in the paper's motion",
    )


@check("text:inner region")
def inner_region() -> Fact:
    """Find how the nutation at which the inner solution is left depends on the release."""

    def left(width: mp.mpf) -> mp.mpf:
        """Return where sqrt(I) s is off by a hundredth of the fall phi'' = -1, as eps -> 0."""

        def off(y: mp.mpf) -> mp.mpf:
            return mp.sqrt(width) * (mp.sqrt(width) - mp.sqrt(width - 2 * y)) / y - 1 - NEAR

        return mp.findroot(off, (width / 100, width / 10), solver="anderson", tol=1e-10)

    places = left(paper_can.WIDTH), left(16 * paper_can.WIDTH)
    power = mp.log(places[1] / places[0]) / mp.log(16)
    return Fact(
        printed=mp.mpf(0),
        corrected=mp.mpf(1),
        others=(mp.mpf(0), mp.mpf("0.5"), mp.mpf(2)),
        holds=lambda stated: bool(abs(power - stated) < mp.mpf("0.02")),
        how=f"the inner solution is within 1 % up to phi = {mp.nstr(places[0] / paper_can.PHI, 3)} "
        f"phi(0), and that goes as phi(0)^{mp.nstr(power, 4)}: releases from pi/100 and 16 pi/100",
    )


@check("text:inner ansatz")
def order_of_the_inner_correction() -> Fact:
    """Largest term that (5.8) adds to its leading order."""
    return Fact(
        printed=root,
        corrected=root * sp.log(eps),
        others=(root, root * sp.log(eps) ** 2, eps),
        holds=largest_addition,
        how="sympy: (5.8) adds eps^(1/2) a_l2 log(eps^(1/2) varphi)/varphi^2, which over eps^(1/2) "
        "has no limit; (5.10) itself states O(eps^(1/2) log eps)",
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
    )


@check("text:inner valid for T<0")
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
    )


@check("text:errors of no account")
def errors_of_the_reduced_equation() -> Fact:
    """Compare what the reduced equation says of the bounce with the exact motion."""
    exact, reduced = release.bounce(), release.reduced_bounce()
    periods = [float(solution.maxima[-1] - solution.maxima[0]) for solution in (reduced, exact)]
    turns = [abs(solution.bounces[0].angle_of_turn) for solution in (reduced, exact)]
    errors = {"turn": abs(turns[0] / turns[1] - 1), "period": abs(periods[0] / periods[1] - 1)}
    return Fact(
        printed="turn",
        others=("period",),
        # half of the last digit of 209 degrees
        holds=lambda quantity: errors[quantity] < 0.5 / 209,
        how=f"relative errors: turn {errors['turn']:.1e}, period {errors['period']:.1e}; the paper "
        "gives the turn in whole degrees",
    )


@check("text:expanding in eps")
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
    )
