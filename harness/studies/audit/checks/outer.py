"""Section 5.1 and appendices F and G: the outer solution, its coefficients and its integrals."""

from functools import partial

import mpmath as mp
import sympy as sp

from harness.studies.audit.checks.integrals import INTEGRALS, third_power
from harness.studies.audit.evidence import Both, Fact, Identity
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import Expr, I, eps

NAMES = ("3", "l2", "2", "l1", "1", "ll", "l0", "0")
a_ = {name: sp.Symbol(f"a_{name}", real=True) for name in NAMES}
half_log = sp.log(I / 2)
POWERS = {
    "3": (3, 0),
    "l2": (2, 1),
    "2": (2, 0),
    "l1": (1, 1),
    "1": (1, 0),
    "ll": (0, 2),
    "l0": (0, 1),
    "0": (0, 0),
}
"""Power of 1/phi and of log phi beside each coefficient."""
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


def right_side() -> Expr:
    """I times the bracket of eq01:Phi_reduced at phi = I (1 - tau^2)/2."""
    phi_0, log_0 = I * w / 2, half_log + log_w
    return sp.expand(I * sum(a_[n] * log_0**j / phi_0**i for n, (i, j) in POWERS.items()))


def _coefficient(name: str) -> Identity:
    power, logs = POWERS[name]
    found = right_side().coeff(w, -power).coeff(log_w, logs)
    return Identity(printed=B_PRINTED[name], derived=found, source="eq01:Phi_reduced at phi_0")


for _name in NAMES:
    claim(
        f"app:b_{_name}", "F", f"b_{_name} = ${sp.latex(B_PRINTED[_name])}$", name="b_coefficient"
    )(partial(_coefficient, _name))


@claim("eq01:leading_order_outer", "5.1", "phi_0 = (I - t^2)/2, flat at t = sqrt(I)")
def leading_order() -> Identity:
    """Phi'' = -1 from rest at I/2."""
    t = sp.Symbol("t")
    form = (I - t**2) / 2
    zero = {t: 0}
    return Identity(
        printed=sp.Matrix(
            [form.diff(t, 2), form.subs(zero), form.diff(t).subs(zero), form.subs(t, sp.sqrt(I))]
        ),
        derived=sp.Matrix([-1, I / 2, 0, 0]),
        source="the initial value problem",
    )


@claim("eq01:order1_outer", "5.1", "the equation of phi_1, time in sqrt(I)")
def first_order_equation() -> Identity:
    """All eight terms at once."""
    printed = sum(B_PRINTED[n] * log_w**j / w**i for n, (i, j) in POWERS.items())
    return Identity(printed=printed, derived=right_side(), source="eq01:Phi_reduced at phi_0")


@claim("eq01:integrals", "5.1", "the double integrals J")
def integrals_by_definition() -> Fact:
    """With J(0) = J'(0) = 0 they solve J'' = integrand: integrate by parts."""
    u, s = sp.symbols("u s", positive=True)
    single = sp.integrate((u - s) * sp.cos(s), (s, 0, u))
    true = sp.simplify(single.diff(u, 2) - sp.cos(u)) == 0
    return Fact(true=true, how="definition; as int_0^T (T - s) f(s) ds its second derivative is f")


@claim("eq01:outer_sol", "5.1", "phi_1 is the sum of the b times the J")
def first_order_solution() -> Both:
    """Add solutions of a linear equation; the mended J also meet phi_1(0) = phi_1'(0) = 0."""
    return Both(parts=(first_order_equation(), integrals_by_definition()))


@claim("eq01:outer_series_ansatz", "5.1", "phi = phi_0 + eps phi_1 + O(eps^2)")
def outer_expansion() -> Identity:
    """Expand the reduced equation in eps."""
    x, y = sp.symbols("phi_0 phi_1", positive=True)
    bracket = sum(
        a_[n] * sp.log(x + eps * y) ** j / (x + eps * y) ** i for n, (i, j) in POWERS.items()
    )
    left = (eps * bracket - 1).subs(eps, 0), (eps * bracket - 1).diff(eps).subs(eps, 0)
    plain = sum(a_[n] * sp.log(x) ** j / x**i for n, (i, j) in POWERS.items())
    return Identity(
        printed=sp.Matrix([-1, plain]), derived=sp.Matrix(left), source="its Taylor series in eps"
    )


@claim("eq01:outer_solution", "5.1", "the outer solution up to O(eps^2)")
def outer_solution() -> Fact:
    """Insert it, with the mended integrals, into an equation of the same form."""
    values = {
        "3": 2.9,
        "l2": -0.4,
        "2": -1.1,
        "l1": -0.2,
        "1": 0.6,
        "ll": -0.1,
        "l0": 0.3,
        "0": 0.5,
    }
    width = mp.mpf("0.0628")

    def left(small: mp.mpf) -> mp.mpf:
        u = mp.mpf("0.6")
        numbers = {a_[n]: sp.Float(v, 30) for n, v in values.items()} | {I: sp.Float(width, 30)}
        b = {n: mp.mpmathify(sp.N(B_PRINTED[n].subs(numbers), 30)) for n in NAMES}
        j = {}
        for n in NAMES:
            power, logs = POWERS[n]
            j[n] = mp.quad(
                lambda s, i=power, k=logs: (u - s) * mp.log(1 - s**2) ** k / (1 - s**2) ** i, [0, u]
            )
        phi = width * (1 - u**2) / 2 + small * sum(b[n] * j[n] for n in NAMES)
        bend = -1 + small / width * sum(
            b[n] * mp.log(1 - u**2) ** k / (1 - u**2) ** i for n, (i, k) in POWERS.items()
        )
        force = sum(values[n] * mp.log(phi) ** k / phi**i for n, (i, k) in POWERS.items())
        return bend - (small * force - 1)

    with mp.workdps(30):
        rate = mp.log10(abs(left(mp.mpf("1e-9")) / left(mp.mpf("1e-10"))))
    return Fact(
        true=bool(abs(rate - 2) < mp.mpf("0.05")),
        how=f"inserted into eq01:Phi_reduced the residual falls with eps^{mp.nstr(rate, 4)}; "
        "with J(0) = 0 (see app:J_l2, app:J_l1, app:J_ll, app:J_3)",
    )


@claim("text:singular J", "5.1", "as t -> sqrt(I), J_1 and J_3 become singular")
def singular_integrals() -> Fact:
    """Values close to tau = 1."""
    with mp.workdps(30):
        near, nearer = 1 - mp.mpf("1e-6"), 1 - mp.mpf("1e-12")
        growing = []
        for name, (form, _) in INTEGRALS.items():
            mended = partial(third_power, -1) if name == "J_3" else form
            if abs(mended(nearer) - mended(near)) > 1:
                growing.append(name)
        first = INTEGRALS["J_1"][0](nearer)
    return Fact(
        true=growing == ["J_3", "J_1"],
        how=f"from 1 - 1e-6 to 1 - 1e-12 those that grow are {', '.join(growing)}; "
        f"J_1 tends to {mp.nstr(first, 8)} = log 2",
        correct="J_2, J_3 and J_l2 become singular; J_1 tends to log 2",
    )
