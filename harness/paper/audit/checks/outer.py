"""Section 5.1 and appendices F and G: the outer solution, its coefficients and its integrals."""

import math
from functools import cache

import mpmath as mp
import sympy as sp
from scipy.integrate import solve_ivp

from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Rate, check, check_each
from harness.paper.audit.reduced_form import POWERS, a_, bracket
from harness.paper.audit.symbols import ZERO, Expr, I, disagreement, eps

time = sp.Symbol("tau", positive=True)
SMALL = mp.mpf("1e-20")
"""Thirty digits, of which the numerical derivative takes some."""
log = sp.log
LESS, MORE = log(1 - time), log(1 + time)
LI_LESS, LI_MORE = sp.polylog(2, (1 - time) / 2), sp.polylog(2, (1 + time) / 2)
_W = 1 - time**2
INTEGRANDS = {
    "J_3": _W**-3,
    "J_2": _W**-2,
    "J_1": 1 / _W,
    "J_l2": log(_W) / _W**2,
    "J_l1": log(_W) / _W,
    "J_l0": log(_W),
    "J_ll": log(_W) ** 2,
}
CLOSED_FORMS: dict[str, Expr] = {
    "J_3": time**2 / (8 * time**2 - 8) + 3 * time / 8 * sp.atanh(time),
    "J_2": time / 2 * sp.atanh(time),
    "J_1": time * sp.atanh(time) + log(_W) / 2,
    "J_l2": (
        2 * (time + 1) * LI_LESS
        - 2 * (time - 1) * LI_MORE
        - time * LESS**2
        + time * MORE**2
        - 4 * (log(8) * LESS + MORE + log(8 - 8 * time) - 3 + 2 * log(2) ** 2)
        + 4 * log(4) * LESS
        + 2 * MORE * LESS
        + (time * (log(16) - 4) - 2 * log(4)) * sp.atanh(time)
    )
    / 8,
    "J_l1": (
        2 * (time - 1) * LI_LESS
        - 2 * (time + 1) * LI_MORE
        - 2 * (time - 1) * LESS**2
        + LESS**2
        + (time + 1) * MORE**2
        + (2 * (time - 1) * LESS + log(4)) * LESS
        - time * LESS * log(4 * (1 - time))
        + (time + 1) * log(4) * MORE
        + 8
        - 2 * log(4)
    )
    / 4,
    "J_l0": (-3 * time**2 + (time**2 + 1) * log(_W) + 4 * time * sp.atanh(time)) / 2,
    "J_ll": (
        4 * (time - 1) * LI_LESS
        - 4 * (time + 1) * LI_MORE
        + 14 * time**2
        + LESS * (-6 * time**2 + 2 * (time**2 - 1) * MORE + 4 * (time - 1) * LESS - 2 + log(16))
        + (time - 3) * (time - 1) * LESS**2
        - 2 * (time - 1) * LESS**2
        + (time + 1) ** 2 * MORE**2
        - 4 * time * (log(2) - 2) * LESS
        - 2 * (time + 1) * (3 * time + 1 - log(4)) * MORE
        + 16
        - 8 * log(2)
    )
    / 2,
    "J_0": time**2 / 2,
}
"""As printed, and J_0, which the paper does not print."""
WITH_CONSTANTS = ("J_l2", "J_l1", "J_ll")
"""Those that are not 0 at 0: double integrals all the same, of which phi_1(0) = 0 asks more."""
RIGHT_FORMS = (
    CLOSED_FORMS
    | {"J_3": -(time**2) / (8 * time**2 - 8) + 3 * time / 8 * sp.atanh(time)}
    | {name: CLOSED_FORMS[name] - CLOSED_FORMS[name].subs(time, 0) for name in WITH_CONSTANTS}
)


@cache
def _bend_missed(form: Expr, integrand: Expr) -> mp.mpf:
    """Return the largest relative difference of the second derivative and the integrand."""
    functions = (sp.lambdify(time, x, "mpmath") for x in (form, integrand))
    with mp.workdps(30):
        of_form, wanted = functions
        points = (mp.mpf("0.25"), mp.mpf("0.5"), mp.mpf("0.8"))
        return max(abs(mp.diff(of_form, x, 2) / wanted(x) - 1) for x in points)


@check_each({f"app:{name}": (name,) for name in INTEGRANDS})
def double_integral(name: str) -> Fact:
    """Differentiate twice: any double integral will do, whatever its constants."""
    printed, integrand = CLOSED_FORMS[name], INTEGRANDS[name]
    corrected = RIGHT_FORMS[name] if name == "J_3" else None
    gap = mp.nstr(_bend_missed(printed, integrand), 2)
    how = f"30 digits: J'' differs from the integrand by {gap} of it"
    if name in WITH_CONSTANTS:
        how += f"; J(0) = {sp.N(printed.subs(time, 0), 6)}, see (5.6)"
    return Fact(
        printed=printed,
        corrected=corrected,
        holds=lambda form: bool(_bend_missed(form, integrand) < SMALL),
        # another constant of integration is as good
        how=how,
    )


half_log = sp.log(I / 2)
B_PRINTED = {
    "3": 8 * a_["3"] / I**2,
    "l2": 4 * a_["l2"] / I,
    "2": 4 * a_["2"] / I + 4 * a_["l2"] * half_log / I,
    "l1": 2 * a_["l1"],
    "1": 2 * a_["1"] + 2 * a_["l1"] * half_log,
    "ll": a_["ll"] * I,
    "l0": a_["l0"] * I + 2 * a_["ll"] * I * half_log,
    "0": a_["0"] * I + a_["l0"] * I * half_log + a_["ll"] * I * half_log**2,
}
w, log_w = sp.symbols("w log_w", positive=True)  # 1 - tau^2 and its logarithm
with mp.workdps(60):
    # of the sizes and signs that the coefficients have for a can
    _VALUES = ("2.9", "-0.4", "-1.1", "-0.2", "0.6", "-0.1", "0.3", "0.5")
    NUMBERS = {a_[n]: sp.Float(x, 60) for n, x in zip(POWERS, _VALUES, strict=True)}
    NUMBERS[I] = sp.Float("0.0628", 60)


def right_side() -> Expr:
    """I times the bracket of eq01:Phi_reduced at phi = I (1 - tau^2)/2."""
    phi_0, log_0 = I * w / 2, half_log + log_w
    return sp.expand(I * bracket(phi_0, log_0))


@check_each({f"app:b_{name}": (name,) for name in POWERS})
def b_coefficient(name: str) -> IdentityEvidence:
    """Compare with the coefficient of its power of 1 - tau^2 and of its logarithm."""
    power, logs = POWERS[name]
    found = right_side().coeff(w, -power).coeff(log_w, logs)
    return IdentityEvidence(
        printed=B_PRINTED[name], derived=found, source="eq01:Phi_reduced at phi_0"
    )


@check("eq01:leading_order_outer")
def leading_order() -> IdentityEvidence:
    """Phi'' = -1 from rest at I/2."""
    t = sp.Symbol("t")
    zero = {t: 0}
    return IdentityEvidence(
        printed=(I - t**2) / 2,
        compared=lambda form: sp.Matrix(
            [form.diff(t, 2), form.subs(zero), form.diff(t).subs(zero), form.subs(t, sp.sqrt(I))]
        ),
        derived=sp.Matrix([-1, I / 2, 0, 0]),
        source="the initial value problem",
    )


@check("eq01:order1_outer")
def first_order_equation() -> IdentityEvidence:
    """All eight terms at once."""
    return IdentityEvidence(
        printed=bracket(w, log_w, B_PRINTED),
        derived=right_side(),
        source="eq01:Phi_reduced at phi_0",
    )


PRINTED_INTEGRALS = {
    **{f"{i}": (_W**-i, 2) for i in range(4)},
    **{f"l{i}": (log(_W) / _W**i, 2) for i in range(3)},
    "ll": (log(_W) ** 2, 2),
}
"""Integrand of each J of eq01:integrals, and how often it is integrated."""


@check("eq01:integrals")
def integrals_by_definition() -> Fact:
    """Differentiate b_n J_n twice, term by term, and compare the sum with eq01:order1_outer."""
    wanted = right_side().subs({log_w: log(_W), w: _W})

    def solves(integrals: dict[str, tuple[Expr, int]]) -> bool:
        if set(integrals) != set(POWERS):
            return False
        bends = {n: form.diff(time, 2 - times) for n, (form, times) in integrals.items()}
        return bool(disagreement(sum(B_PRINTED[n] * bends[n] for n in POWERS), wanted) < ZERO)

    return Fact(
        printed=PRINTED_INTEGRALS,
        holds=solves,
        how="40 digits: the sum of b_n J_n'' is the right side of eq01:order1_outer for any eight "
        "coefficients, with a J for each and no other",
    )


@check("eq01:outer_sol")
def first_order_solution() -> Both:
    """Integrate the whole right side of eq01:order1_outer twice, and its eight parts."""
    end = 0.6
    right = sp.lambdify((w, log_w), right_side().subs(NUMBERS), "math")
    run = solve_ivp(
        lambda s, y: [y[1], right(1 - s**2, math.log(1 - s**2))],
        (0, end),
        [0, 0],
        rtol=1e-11,
        atol=1e-13,
    )
    whole = float(run.y[0][-1])
    b, integral = ({n: sp.Symbol(f"{x}_{n}") for n in POWERS} for x in "bJ")
    values = {b[n]: B_PRINTED[n].subs(NUMBERS).evalf() for n in POWERS}
    for n, (power, logs) in POWERS.items():
        # a double integral from 0 as a single one
        values[integral[n]] = mp.quad(
            lambda s, i=power, j=logs: (end - s) * mp.log(1 - s**2) ** j / (1 - s**2) ** i, [0, end]
        )
    printed = sum(b[n] * integral[n] for n in POWERS)
    summed = Fact(
        printed=printed,
        # a hundred times the tolerance of the integration
        holds=lambda form: bool(abs(form.subs(values) / whole - 1) < 1e-9),  # noqa: PLR2004
        how=f"at tau = 0.6 the right side of eq01:order1_outer integrated twice from rest is "
        f"{whole:.9g}, and the sum {float(printed.subs(values)):.9g}",
    )
    return Both(summed, index_of_the_sum())


@check("text:first index of (5.6)", "text:second index of (5.6)")
def index_of_the_sum() -> Fact:
    """Ask which letters of its terms b_i J_i a sum leaves free."""
    i, n = sp.symbols("i n", integer=True)
    b, integral = sp.IndexedBase("b"), sp.IndexedBase("J")
    letters = {"i": i, "n": n}

    def bound(over: str) -> bool:
        return i not in sp.Sum(b[i] * integral[i], (letters[over], 0, 2)).free_symbols

    return Fact(
        printed="n",
        corrected="i",
        holds=bound,
        how="sympy: with n as the variable of summation i stays free",
    )


@check("eq01:outer_series_ansatz")
def outer_expansion() -> IdentityEvidence:
    """Expand the reduced equation in eps."""
    x, y = sp.symbols("phi_0 phi_1", positive=True)
    force = eps * bracket(x + eps * y, sp.log(x + eps * y)) - 1
    left = force.subs(eps, 0), force.diff(eps).subs(eps, 0)
    plain = bracket(x, sp.log(x))
    return IdentityEvidence(
        printed=sp.Matrix([-1, plain]), derived=sp.Matrix(left), source="its Taylor series in eps"
    )


t = sp.Symbol("t", positive=True)
B_LETTERS, J_LETTERS = ([sp.Symbol(f"{x}_{n}") for n in POWERS] for x in "bJ")
OUTER = {
    "phi": (I - t**2) / 2 + eps * sum(b * j for b, j in zip(B_LETTERS, J_LETTERS, strict=True)),
    "argument": t / sp.sqrt(I),
}
"""eq01:outer_solution in letters b and J, and the argument of the J."""


def _left(claim: dict[str, Expr], small: mp.mpf) -> mp.mpf:
    """Return what an outer solution with given J leaves of eq01:Phi_reduced and of its release."""
    width, at = NUMBERS[I], mp.mpf("0.15")
    b = [mp.mpmathify(B_PRINTED[n].subs(NUMBERS).evalf(60)) for n in POWERS]
    functions = [sp.lambdify(time, claim[f"J_{n}"], "mpmath") for n in POWERS]
    argument = sp.lambdify((t, I), claim["argument"], "mpmath")
    outer = sp.lambdify((t, eps, I, *B_LETTERS, *J_LETTERS), claim["phi"], "mpmath")

    def phi(moment: mp.mpf) -> mp.mpf:
        scaled = argument(moment, width)
        return outer(moment, small, width, *b, *(j(scaled) for j in functions))

    here = phi(at)
    force = bracket(here, mp.log(here), {n: NUMBERS[a_[n]] for n in POWERS})
    start = abs(phi(mp.mpf(0)) - mp.mpf(width) / 2) + abs(mp.diff(phi, mp.mpf(0)))
    return abs(mp.diff(phi, at, 2) - (small * force - 1)) + start


@check("eq01:outer_solution")
def outer_solution() -> Rate:
    """Insert it into eq01:Phi_reduced, with eight numbers for its coefficients."""
    return Rate(
        printed=OUTER | CLOSED_FORMS,
        remainder=_left,
        corrected=OUTER | RIGHT_FORMS,
        stated=2,
        at=(1e-14, 1e-16),  # where eps^2 is small beside eps times the smallest J(0)
        source="eq01:Phi_reduced, phi(0) = I/2 and phi'(0) = 0",
    )


@check("text:singular J")
def singular_integrals() -> Fact:
    """Values close to tau = 1."""
    with mp.workdps(30):
        ends = 1 - mp.mpf("1e-6"), 1 - mp.mpf("1e-12")
        growing = set()
        for name, form in RIGHT_FORMS.items():
            near, nearer = (abs(sp.lambdify(time, form, "mpmath")(x)) for x in ends)
            if nearer - near > 1:
                growing.add(name)
        first = sp.lambdify(time, RIGHT_FORMS["J_1"], "mpmath")(ends[1])
    return Fact(
        printed={"J_1", "J_3"},
        holds=lambda names: growing == names,
        corrected={"J_2", "J_3", "J_l2"},
        how=f"from 1 - 1e-6 to 1 - 1e-12 those that grow are {', '.join(sorted(growing))}; "
        f"J_1 tends to {mp.nstr(first, 8)} = log 2",
    )
