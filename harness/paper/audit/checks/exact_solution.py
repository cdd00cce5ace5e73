"""Sections 4 and 4.2: the closed subsystem, its exact solution, and the constants of a release."""

from collections.abc import Iterator
from functools import cache, partial

import mpmath as mp
import sympy as sp

from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit import flat_series as series
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Number, Rate, check
from harness.paper.audit.flat_motion import CONSTANTS, EXACT, RATES, TINY, exact_constants, rates
from harness.paper.audit.newton_euler import papers_accelerations
from harness.paper.audit.symbols import (
    Co,
    Expr,
    Phi,
    Psi,
    S,
    Theta,
    a_p,
    c_p,
    h,
    k,
    log_phi,
    phi,
    psi_dd,
    theta_dd,
)

HALF = sp.Rational(1, 2)
PSI_ROW = k * c_p * Theta + ((k * c_p - 2) * Co - h * k * S) * Psi
THETA_ROW = (-k * c_p * Co + h * k * S) * Theta + (
    -k * c_p * Co**2 - k * a_p * S**2 + h * k * sp.sin(2 * phi) + 2
) * Psi


def _row(letter: Expr) -> Expr:
    return papers_accelerations()[letter] * S / Phi


@check("eq01:closed_subsystem")
def closed_subsystem() -> IdentityEvidence:
    """Divide by Phi."""
    return IdentityEvidence(
        printed=sp.Matrix([PSI_ROW, THETA_ROW]),
        derived=sp.Matrix([_row(psi_dd), _row(theta_dd)]),
        source="the equations of motion over Phi",
    )


@check("eq01:psi_diff_phi")
def slope_of_precession() -> IdentityEvidence:
    """Divide by Phi."""
    return IdentityEvidence(printed=PSI_ROW, derived=_row(psi_dd), source="eq01:Psi over Phi")


@check("eq01:theta_diff_phi")
def slope_of_rotation() -> IdentityEvidence:
    """Divide by Phi."""
    return IdentityEvidence(printed=THETA_ROW, derived=_row(theta_dd), source="eq01:Theta over Phi")


@check("eq01:frob_ode")
def second_order_equation() -> IdentityEvidence:
    """Differentiate the slope of Psi and insert both slopes."""
    slope = PSI_ROW / S
    bend = slope.diff(phi) + slope.diff(Psi) * slope + slope.diff(Theta) * THETA_ROW / S
    cot = Co / S
    return IdentityEvidence(
        printed=-3 * cot * slope + (2 + k + k * h * cot) * Psi,
        derived=bend,
        source="the closed subsystem",
    )


@check("text:gamma")
def gamma_of_the_can() -> Number:
    """2 + k."""
    return Number(printed="2.245", value=2 + paper_can.k, source="2 + k")


@check("text:beta")
def beta_of_the_can() -> Number:
    """Multiply k and h."""
    return Number(printed="0.361", value=paper_can.k * paper_can.h, source="k h")


GAMMA, BETA = sp.symbols("gamma beta", positive=True)
RHO = (9 + 4 * GAMMA + 4 * sp.I * BETA) / 16
RIGHT_RHO = (9 - 4 * GAMMA - 4 * sp.I * BETA) / 16
_s, _t, _cot = sp.symbols("s t cot")
BRANCHES = sp.ImmutableMatrix(
    [
        [-_t, _s, _s - HALF - _t, _s + 3 * HALF - _t, 1 - 2 * _t],
        [_t, _s, _s + 3 * HALF + _t, _s - HALF + _t, 1 + 2 * _t],
    ]
).row_join(sp.ImmutableMatrix([[-3 * HALF, HALF - sp.I / 2 * _cot]] * 2))
"""A row each branch of eq01:hyper_geom, with s and t the square roots of rho and its conjugate.

Exponents of cot phi + i and cot phi - i, the three parameters of 2F1, exponent of sin phi and
argument of 2F1.
"""
PLACES = (mp.mpf("0.4"), mp.mpf("0.9"), mp.mpf("1.3"))


@cache
def _residual(rho: Expr, branch: Expr, x: mp.mpf) -> mp.mpf:
    """Return the relative residual of one branch of eq01:hyper_geom in eq01:frob_ode."""
    gamma, beta = 2 + paper_can.k, paper_can.k * paper_can.h
    with mp.workdps(30):
        square = sp.lambdify((GAMMA, BETA), rho, "mpmath")(gamma, beta)
        roots = mp.sqrt(square), mp.sqrt(mp.conj(square))
        entries = sp.lambdify((_s, _t, _cot), list(branch), "mpmath")

        def psi(y: mp.mpf) -> mp.mpc:
            cot = mp.cot(y)
            plus, minus, first, second, third, of_sine, argument = entries(*roots, cot)
            front = mp.sin(y) ** of_sine * (cot + 1j) ** plus * (cot - 1j) ** minus
            return front * mp.hyp2f1(first, second, third, argument)

        value, slope, bend = (mp.diff(psi, x, n) for n in range(3))
        left = bend + 3 * mp.cot(x) * slope - (gamma + beta * mp.cot(x)) * value
        return abs(left) / abs(bend)


def _residuals(claim: tuple[Expr, Expr]) -> Iterator[mp.mpf]:
    """Yield the residuals of both branches at three nutations, for rho and branches."""
    rho, branches = claim
    return (_residual(rho, branches[way, :], x) for way in range(2) for x in PLACES)


def _exponent() -> Expr:
    """Square of the exponents at cot phi = i of y, where Psi = y/sin^(3/2)."""
    x, square = sp.symbols("x square")
    s = sp.sqrt(square)
    # y'' + (3/2 - 3 x^2/4 - gamma - beta x) y = 0 with d/dphi = -(1 + x^2) d/dx
    first = -(1 + x**2) * s / (x - sp.I)
    second = -(1 + x**2) * first.diff(x) + first**2
    form = second + sp.Rational(3, 2) - 3 * x**2 / 4 - GAMMA - BETA * x
    return sp.solve(sp.limit(sp.cancel(form), x, sp.I), square)[0]


@check("eq01:hyper_geom")
def hypergeometric_solution() -> Both:
    """Insert both branches at three nutations; and derive rho from the singular point."""
    printed, right = (RHO, BRANCHES), (RIGHT_RHO, BRANCHES)
    return Both(
        Fact(
            printed=printed,
            # thirty digits, of which the second derivative takes ten
            holds=lambda claim: all(x < mp.mpf("1e-18") for x in _residuals(claim)),
            corrected=right,
            how="30 digits: relative residual of both branches "
            f"{mp.nstr(max(_residuals(printed)), 2)}, with the correct rho "
            f"{mp.nstr(max(_residuals(right)), 2)}",
        ),
        IdentityEvidence(
            printed=RHO,
            corrected=RIGHT_RHO,
            derived=_exponent(),
            source="the square of the exponent at cot phi = i, with Psi = y/sin^(3/2)",
        ),
    )


@check("caption:fig01:frob_comp")
def inverse_square() -> Rate:
    """phi^2 Psi tends to a constant."""
    return Rate(
        printed=-2,
        remainder=lambda power, x: rates(x, mp.mpf("0.7"), mp.mpf(1))[0] / x**power - 1,
        stated=1,
        at=(1e-6, 1e-9),
        source="the exact solution over the power",
    )


@check("text:growth of the sum")
def growth_of_the_sum() -> Fact:
    """Divide the sum by a power of log phi, over which it should be of order one."""
    with mp.workdps(80):  # the sum is 1e-40 of either
        places = mp.mpf("1e-10"), mp.mpf("1e-20")
        sums = [sum(rates(x, mp.mpf(0), mp.mpf(1))) for x in places]
        growth = sums[1] / sums[0]
        per_log = (sums[1] - sums[0]) / (mp.log(places[1] / places[0]))
        derived = (1 - paper_can.h**2 * paper_can.k) / paper_can.c_p
    return Fact(
        printed=0,
        # the logarithm doubles; a constant beside it is a tenth of it
        holds=lambda logs: bool(abs(growth / 2**logs - 1) < mp.mpf("0.2")),
        corrected=1,
        how=f"for B_0 = 0, B_-2 = 1 the sum grows by {mp.nstr(per_log, 8)} log phi; "
        f"derived (1 - h^2 k)/c_p = {mp.nstr(derived, 8)}",
    )


SMALL = (1e-9, 1e-12)
kc = series.k * series.c_p
beta = series.h * series.k
PRINTED_SLOPE = (
    (kc * (Psi + Theta) - 2 * Psi) / phi - beta * Psi + (kc * (Theta - 2 * Psi) + 4 * Psi) / 6 * phi
)
PRINTED_ZERO = (
    kc / 2 * (Theta + Psi)
    - beta * kc / 2 * (Theta + Psi) * phi
    - (beta**2 - series.k) / 4 * (kc * (Theta + Psi) - 2 * Psi) * phi**2 * log_phi
    + (-kc * (5 * Psi + 2 * Theta) + (4 - 3 * series.k + 9 * beta**2) * Psi) * phi**2 / 12
)
PRINTED_TWO = (-kc / 2 * (Theta + Psi) + Psi) * phi**2


@check("eq01:psi_diff_phi_small_phi")
def slope_at_release() -> Rate:
    """Compare with the slope itself."""
    exact = (kc * Theta + ((kc - 2) * Co - beta * S) * Psi) / S
    return Rate(
        printed=PRINTED_SLOPE,
        remainder=lambda form, x: series.valued(form - exact, Psi, Theta)(x, *RATES),
        stated=3,
        at=TINY,
        source="eq01:psi_diff_phi",
    )


def derived_zero() -> Expr:
    """Return B_0 at fixed Psi and Theta to phi^2, by the Wronskian -2/sin^3 phi."""
    singular = series.singular_solution()
    slope = (kc * Theta + ((kc - 2) * series.COS - beta * series.SIN) * Psi) * (
        1 / phi + phi / 6 + 7 * phi**3 / 360
    )
    # of order phi^-3, so that two more powers of either factor are enough
    top = Psi * series.up_to(series.slope(singular), -1) - series.product(slope, singular, -1)
    return series.product(top, series.SIN**3 / -2, 2)


def _coefficients_of_zero(form: Expr) -> Expr:
    """Return the coefficients to phi^2, the logarithm's last."""
    whole = sp.expand(form)
    plain = [whole.coeff(log_phi, 0).coeff(phi, n) for n in range(3)]
    return series.in_inertias(sp.Matrix([*plain, whole.coeff(log_phi, 1).coeff(phi, 2)]))


def _against_the_exact_constant(printed: Expr, which: int) -> Rate:
    """Compare a form of B_0 or of B_-2 with the exact constant."""

    def remainder(form: Expr, x: mp.mpf) -> mp.mpf:
        exact = flat_motion.constants(x, *RATES)[which]
        return series.valued(form, Psi, Theta)(x, *RATES) - exact

    return Rate(printed=printed, remainder=remainder, stated=3, at=TINY, source=EXACT)


@check("eq01:A_sol")
def regular_constant() -> Both:
    """Compare with the exact constant, and every coefficient with letters."""
    return Both(
        _against_the_exact_constant(PRINTED_ZERO, 0),
        IdentityEvidence(
            printed=PRINTED_ZERO,
            compared=_coefficients_of_zero,
            derived=_coefficients_of_zero(derived_zero()),
            source="the Frobenius series and their Wronskian",
        ),
    )


@check("eq01:B_sol")
def singular_constant() -> Rate:
    """Compare with the exact constant; there is no logarithm in the remainder."""
    return _against_the_exact_constant(PRINTED_TWO, 1)


@check("eq01:b_sol_later")
def singular_constant_again() -> Both:
    """Take Psi and Theta apart."""
    later = -kc / 2 * Theta + Psi * (1 - kc / 2)
    return Both(
        IdentityEvidence(
            printed=later, derived=sp.expand(PRINTED_TWO / phi**2), source="eq01:B_sol"
        ),
        _against_the_exact_constant(later * phi**2, 1),
    )


@check("text:conserved")
def constants_stay() -> Both:
    """Follow both expansions along an exact motion: Psi grows as phi^-2 on it."""

    def along(which: int, form: Expr, x: mp.mpf) -> mp.mpf:
        value = series.valued(form, Psi, Theta)
        return value(x, *flat_motion.rates(x, *CONSTANTS)) - CONSTANTS[which]

    return Both(
        *(
            Rate(
                printed=form,
                remainder=partial(along, which),
                stated=1,
                at=SMALL,
                source=f"{name} along an exact motion: what is cut off is phi^3 Psi",
            )
            for which, (name, form) in enumerate((("B_0", PRINTED_ZERO), ("B_-2", PRINTED_TWO)))
        )
    )


SEEN = 0.05
"""A drift below a twentieth of a quantity is small, one above a hundredth of that is seen."""


@check("caption:fig01:conserved")
def drift_of_the_truncated_constants() -> Fact:
    """Insert the exact rates of the release into eq01:A_sol and eq01:B_sol."""
    forms = {"B_0": PRINTED_ZERO, "B_-2": PRINTED_TWO, "Psi": Psi, "Theta": Theta}
    places = (paper_can.PHI, mp.mpf("1e-2"), mp.mpf("1e-3"), mp.mpf("1e-4"))
    swing = {}
    with mp.workdps(30):
        exact = exact_constants()
        for name, form in forms.items():
            value = series.valued(form, Psi, Theta)
            values = [value(x, *flat_motion.rates(x, *exact)) for x in places]
            swing[name] = float((max(values) - min(values)) / max(abs(x) for x in values))
    return Fact(
        printed=("B_0", "B_-2"),
        # seen in a plot, and small
        holds=lambda names: all(SEEN / 100 < swing[name] < SEEN for name in names),
        how="exact rates inserted: "
        + ", ".join(f"{name} varies by {value:.1%}" for name, value in swing.items()),
    )
