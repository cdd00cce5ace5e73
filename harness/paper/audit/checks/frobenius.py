"""Section 4.1: the Frobenius series and its coefficients."""

import mpmath as mp
import sympy as sp

from harness.paper.audit import flat_series as series
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Rate, check, check_each
from harness.paper.audit.flat_motion import CONSTANTS, rates
from harness.paper.audit.flat_series import c_p, coefficient, h, in_inertias, k
from harness.paper.audit.symbols import B0, B2, Expr, log_phi, phi

DERIVED = "the Frobenius series derived from the closed subsystem"
beta, gamma = k * h, 2 + k
SMALL = (1e-8, 1e-11)


def same(printed: Expr, derived: Expr, source: str = DERIVED) -> IdentityEvidence:
    """Compare two forms in k, h and c_p as functions of a, c and h."""
    return IdentityEvidence(
        printed=printed, compared=in_inertias, derived=in_inertias(derived), source=source
    )


@check("eq01:frobenius_subs")
def inserted_series() -> IdentityEvidence:
    """Insert one power."""
    n, cot = sp.symbols("n cot")
    power = phi**n
    printed = n * (n - 1) / phi**2 + 3 * cot * n / phi - (gamma + beta * cot)
    derived = power.diff(phi, 2) + 3 * cot * power.diff(phi) - (gamma + beta * cot) * power
    return IdentityEvidence(
        printed=printed, derived=sp.simplify(derived / power), source="d/dphi of phi^(n+r)"
    )


@check("text:indicial equation")
def indicial_equation() -> IdentityEvidence:
    """Lowest power of phi^r in the equation."""
    r = sp.Symbol("r")
    left = sp.expand(sp.simplify(series.second_order(phi**r) / phi**r * phi**2))
    return IdentityEvidence(
        printed=r * (r + 2), derived=left.subs(phi, 0), source="the lowest power"
    )


def _solvable(start: int, step: int) -> bool:
    """Whether a series from phi^start in steps solves eq01:frob_ode, one power after the other."""
    found = phi**start
    if sp.expand(series.second_order(found)).coeff(phi, start - 2) != 0:
        return False
    for n in range(1, series.TERMS + 1):
        letter = sp.Integer(0) if n % step else sp.Symbol("p")
        left = sp.expand(series.second_order(found + letter * phi ** (start + n)))
        rest = left.coeff(phi, start + n - 2)
        if letter == 0:
            if sp.cancel(rest) != 0:
                return False
            continue
        answer = sp.solve(rest, letter)
        if not answer:
            return False
        found += answer[0] * phi ** (start + n)
    return True


@check("text:Frobenius ansatz")
def steps_of_the_series() -> Fact:
    """Solve for one coefficient after the other, the powers one or more apart."""
    return Fact(
        printed=1,
        holds=lambda step: _solvable(0, step),
        how="sympy: from a_0 != 0 every coefficient to phi^5 follows for r = 0; for r = -2 see "
        "text:log terms",
    )


@check("eq01:Psi0")
def regular_series() -> Fact:
    """Solve for one coefficient after the other, starting from phi^r."""
    return Fact(
        printed=0,
        holds=lambda r: _solvable(r, 1),
        how="sympy: for r = 0 every coefficient to phi^5 follows without a logarithm, and for "
        "r = -2 that of phi^0 does not",
    )


@check("text:Psi_0 to phi^3")
def regular_coefficients() -> IdentityEvidence:
    """Compare four coefficients."""
    printed = (1, beta / 3, (beta**2 + 3 * gamma) / 24, beta * (beta**2 + 11 * gamma) / 360)
    derived = [coefficient(series.regular_solution(), n) for n in range(4)]
    return same(sp.Matrix(printed), sp.Matrix(derived))


@check("eq0:Psi2")
def singular_series() -> Fact:
    """Insert the solution; what multiplies C log phi is Psi_0, and C is not zero."""
    solution = sp.expand(series.singular_solution())
    left = sp.expand(series.second_order(solution))
    clean = all(
        sp.simplify(left.coeff(log_phi, j).coeff(phi, n)) == 0
        for j in (0, 1)
        for n in range(-4, series.TERMS - 1)
    )
    strength = coefficient(solution, 0, 1)
    beside = solution.coeff(log_phi, 1)

    def shaped(form: tuple[int, Expr]) -> bool:
        lowest, over = form
        same = series.up_to(beside - strength * over, 3)
        powers = [n for n in range(-4, 4) if solution.coeff(log_phi, 0).coeff(phi, n) != 0]
        return clean and powers[0] == lowest and sp.simplify(same) == 0

    regular = series.regular_solution()
    return Fact(
        printed=(-2, regular),
        holds=shaped,
        how=f"sympy: residual 0 to phi^3, C = {strength}",
    )


_cot, _bend = sp.symbols("cot Psi_0_bend")
C, PSI_0, SLOPE_0 = sp.symbols("C Psi_0 Psi_0_slope")
N = range(4)
"""Terms of the sum: each enters by itself, and four show how its factors go with n."""
q_n = sp.symbols("q_:4")
INSERTED = (
    (2 * C * SLOPE_0 / phi - C * PSI_0 / phi**2)
    + sum(q_n[n] * (n - 2) * (n - 3) * phi ** (n - 4) for n in N)
    + 3 * _cot * (C * PSI_0 / phi + sum(q_n[n] * (n - 2) * phi ** (n - 3) for n in N))
    - (gamma + beta * _cot) * sum(q_n[n] * phi ** (n - 2) for n in N)
)


@check("text:Psi_-2 inserted")
def inserted_logarithm() -> IdentityEvidence:
    """Insert C Psi_0 log phi and the sum, and what the equation says of the bend of Psi_0."""

    def slope(form: Expr) -> Expr:
        """Differentiate in phi, Psi_0 and log phi included."""
        inner = form.diff(PSI_0) * SLOPE_0 + form.diff(SLOPE_0) * _bend
        return series.slope(form) + inner

    solution = C * PSI_0 * log_phi + sum(q_n[n] * phi ** (n - 2) for n in N)
    factor = gamma + beta * _cot
    whole = slope(slope(solution)) + 3 * _cot * slope(solution) - factor * solution
    return IdentityEvidence(
        printed=INSERTED,
        derived=sp.expand(whole.subs(_bend, factor * PSI_0 - 3 * _cot * SLOPE_0)),
        source="the derivatives of Psi_0 log phi and of phi^(n-2), n = 0 to 3",
    )


LOG = -(beta**2 - gamma + 2) / 2


@check("text:Psi_-2 to phi")
def singular_coefficients() -> IdentityEvidence:
    """Compare the coefficients, the logarithm's first."""
    tail = -beta * (-2 * beta**2 + 5 * gamma - 6) / 9
    solution = series.singular_solution()
    derived = [coefficient(solution, 0, 1), *(coefficient(solution, n) for n in (-2, -1, 0, 1))]
    return same(sp.Matrix([LOG, 1, -beta, 0, tail]), sp.Matrix(derived))


PRINTED_PSI = (
    B0 * (1 + k * h / 3 * phi)
    - B2 * (beta**2 - k) / 2 * (1 + k * h / 3 * phi + (beta**2 + 6 + 3 * k) / 24 * phi**2) * log_phi
    + B2 * (phi**-2 - k * h / phi - k * h * (-2 * beta**2 + 4 + 5 * k) * phi / 9)
)
THETA_LOG = (
    B2 * (h**2 * k - 1) / (2 * c_p) * ((c_p * k - 2) + k * h * (c_p * k - 6) / 3 * phi) * log_phi
)


def printed_theta(coefficient_of_c_p: int) -> Expr:
    """eq01:theta_orig; the paper prints 4 c_p + 3."""
    constant = (
        -9 * B2 * h**2 * k**2
        + ((coefficient_of_c_p * c_p + 3) * B2 - 6 * B0 * c_p) * k
        + 12 * B0
        - 4 * B2
    ) / (6 * k * c_p)
    return -B2 / phi**2 + B2 * k * h / phi + constant + THETA_LOG


def listed(form: Expr, stated: int) -> Expr:
    """Return the coefficients of a form below a power of phi, and up to it beside log phi."""
    whole = sp.expand(form)
    return in_inertias(
        sp.Matrix(
            [whole.coeff(log_phi, 0).coeff(phi, n) for n in range(-2, stated)]
            + [whole.coeff(log_phi, 1).coeff(phi, n) for n in range(-2, stated + 1)]
        )
    )


def _series(of: str, printed: Expr, stated: int, corrected: Expr | None = None) -> Both:
    """Compare every printed coefficient, and the remainder with the exact solution.

    A series up to O(phi^stated) has its terms below that, and those beside log phi with it.
    """
    which = ("Psi", "Theta").index(of)
    solution = (series.precession, series.rotation_rate)[which]()

    def remainder(form: Expr, x: mp.mpf) -> mp.mpf:
        return series.valued(form, B0, B2)(x, *CONSTANTS) - rates(x, *CONSTANTS)[which]

    return Both(
        Rate(
            printed=printed,
            remainder=remainder,
            corrected=corrected,
            stated=stated,
            at=SMALL,
            source="the exact solution",
        ),
        IdentityEvidence(
            printed=printed,
            compared=lambda form: listed(form, stated),
            corrected=corrected,
            derived=listed(solution, stated),
            source=f"every printed coefficient of {DERIVED}",
        ),
    )


@check("eq01:psi_orig")
def series_of_psi() -> Both:
    """Compare terms to phi, and to phi^2 beside the logarithm."""
    return _series("Psi", PRINTED_PSI, 2)


@check("eq01:theta_orig")
def series_of_theta() -> Both:
    """Compare terms to phi^0, and to phi beside the logarithm."""
    return _series("Theta", printed_theta(4), 1, printed_theta(3))


def _short(log_0: Expr, log_1: Expr) -> Expr:
    return B2 / phi**2 - B2 * k * h / phi + B0 + (log_0 + log_1 * phi) * log_phi


PSI_L0, PSI_L1 = B2 * (beta**2 - k) / 2, B2 * k * h * (beta**2 - k) / 6
THETA_00 = (2 - k * c_p) / (k * c_p) * B0 + (3 * k * (c_p + 1) - 4 - 9 * beta**2) / (
    6 * k * c_p
) * B2


@check("eq01:psi_series")
def leading_psi() -> Both:
    """Compare with the exact solution."""
    return _series("Psi", _short(PSI_L0, PSI_L1), 1, _short(-PSI_L0, -PSI_L1))


@check("eq01:theta_series")
def leading_theta() -> Both:
    """Compare with the exact solution."""
    short = -B2 / phi**2 + B2 * k * h / phi + THETA_00 + THETA_LOG
    return _series("Theta", short, 1)


@check("eq01:series_sols")
def leading_terms() -> Both:
    """Both of them."""
    return Both(leading_theta(), leading_psi())


@check_each(
    {
        "app:Psi_00": (B0, "Psi", 0, 0),
        "app:Psi_l0": (PSI_L0, "Psi", 1, 0, -PSI_L0),
        "app:Psi_l1": (PSI_L1, "Psi", 1, 1, -PSI_L1),
        "app:Theta_00": (THETA_00, "Theta", 0, 0),
        "app:Theta_l0": (coefficient(THETA_LOG, 0, 1), "Theta", 1, 0),
        "app:Theta_l1": (coefficient(THETA_LOG, 1, 1), "Theta", 1, 1),
    }
)
def listed_coefficient(
    printed: Expr, of: str, logs: int, power: int, corrected: Expr | None = None
) -> IdentityEvidence:
    """Compare with the coefficient of phi^power (log phi)^logs."""
    solution = {"Psi": series.precession, "Theta": series.rotation_rate}[of]()
    return IdentityEvidence(
        printed=printed,
        compared=in_inertias,
        corrected=corrected,
        derived=in_inertias(coefficient(solution, power, logs)),
        source=DERIVED,
    )


@check("text:log terms")
def logarithms() -> Fact:
    """Look for the highest power of the logarithm in the second solution."""
    solution = sp.expand(series.singular_solution())
    highest = max(n for n in range(4) if solution.coeff(log_phi, n) != 0)
    strength = sp.factor(sp.together(in_inertias(1 - k * h**2)))
    return Fact(
        printed=1,
        holds=lambda power: power == highest,
        how=f"sympy: C = k (1 - k h^2)/2 q_0 with 1 - k h^2 = {strength} > 0",
    )


@check("text:reason of the logarithms")
def reason_of_the_logarithms() -> Fact:
    """Solve (4.2) for any beta and gamma up to phi^0: the exponents do not depend on them."""
    first, strength, b, c = sp.symbols("q_1 C beta gamma", real=True)
    trial = phi**-2 + first / phi + strength * log_phi
    left = series.slope(series.slope(trial)) + 3 * series.COT * series.slope(trial)
    left = sp.expand(left - (c + b * series.COT) * trial).coeff(log_phi, 0)
    value = sp.solve(left.coeff(phi, -3), first)[0]
    found = sp.factor(sp.solve(left.coeff(phi, -2).subs(first, value), strength)[0])
    return Fact(
        printed=({c: 2 + k, b: k * h}, {c: 2 + b**2}),
        corrected=({c: 2 + k, b: k * h},),
        holds=lambda equations: all(sp.expand(found.subs(case)) != 0 for case in equations),
        how=f"sympy: C = {found} q_0",
    )


@check("text:regular singular point")
def regular_singular_point() -> Fact:
    """Limits at phi = 0; divided once more by phi they have none."""
    gamma, beta = sp.symbols("gamma beta", positive=True)
    pair = phi * sp.cot(phi), phi**2 * (gamma + beta * sp.cot(phi))

    def bounded(power: int) -> bool:
        return all(sp.limit(form * phi**power, phi, 0).is_finite for form in pair)

    return Fact(
        printed=0,
        holds=bounded,
        how="sympy: their limits are 1 and 0, and both are quotients of analytic functions",
    )
