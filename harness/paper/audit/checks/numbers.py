"""Numbers in text and captions: the can, the release, and what the bounce comes to."""

import mpmath as mp
import sympy as sp

from harness.paper import release
from harness.paper.audit import paper_can
from harness.paper.audit.checks.reduced import derived
from harness.paper.audit.evidence import (
    Both,
    Fact,
    IdentityEvidence,
    Number,
    OutOfReach,
    check,
    check_each,
)
from harness.paper.audit.flat_motion import exact_constants
from harness.paper.audit.newton_euler import ARM
from harness.paper.audit.paper_can import (
    HALF_HEIGHT,
    MOMENT_A,
    MOMENT_C,
    PHI,
    PSI_DOT,
    RADIUS,
    THETA_DOT,
    WIDTH,
    reach,
)
from harness.paper.audit.reduced_form import POWERS
from harness.paper.audit.symbols import B0, B2, Expr, H, R, eps, zeta


@check("text:height of the can")
def height_of_the_can() -> IdentityEvidence:
    """Twice the height of the centre over the bottom: the contact point is H below the centre."""
    return IdentityEvidence(
        printed=H,
        corrected=2 * H,
        derived=-2 * ARM[2] * R,
        source="GP^B, with the centre halfway up",
    )


MASSES = MOMENT_A / (paper_can.a * RADIUS**2), MOMENT_C / (paper_can.c * RADIUS**2)
"""What A with a, and C with c, imply: they agree to a thousandth, and not with the printed m."""
SQUARE = sum(MASSES) / 2 * RADIUS**2
"""m R^2 with that mass: one number with which A, C, a and c all round as printed."""
IMPLIED = f"m = {mp.nstr(SQUARE / RADIUS**2, 4)} kg, which A/(a R^2) and C/(c R^2) imply"


@check_each({"text:A": ("6.97e-5", paper_can.a), "text:C": ("5.89e-5", paper_can.c)})
def moment(printed: str, group: mp.mpf) -> Number:
    """With the mass that the groups imply."""
    return Number(
        printed=printed, value=group * SQUARE, source=f"its group times m R^2 with {IMPLIED}"
    )


@check("text:m")
def mass() -> Number:
    """From A, a and R; C, c and R give the same."""
    return Number(
        printed="4.3e-2",
        value=SQUARE / RADIUS**2,
        source="A, C, a, c and R",
        also=f"A/(a R^2) = {mp.nstr(MASSES[0], 4)} kg, C/(c R^2) = {mp.nstr(MASSES[1], 4)} kg",
    )


def _groups() -> dict[str, Number]:
    least, most = reach(lambda a, c, h: c / (a + c * (a + h**2)), "0.727", "0.615", "1.473")
    return {
        "a": Number(printed="0.727", value=MOMENT_A / SQUARE, source=f"A/(m R^2) with {IMPLIED}"),
        "c": Number(printed="0.615", value=MOMENT_C / SQUARE, source=f"C/(m R^2) with {IMPLIED}"),
        "a_p": Number(
            printed="2.897", value=paper_can.a + (HALF_HEIGHT / RADIUS) ** 2, source="a + (H/R)^2"
        ),
        "c_p": Number(printed="1.6156", value=paper_can.c_p, source="c + 1"),
        "h": Number(printed="1.473", value=HALF_HEIGHT / RADIUS, source="H/R"),
        "k": Number(
            printed="0.245", value=paper_can.k, low=least, high=most, source="c/(a + c a_p)"
        ),
    }


GROUPS = ("a", "c", "a_p", "c_p", "h", "k")


@check_each({f"text:{name} of the can": (name,) for name in GROUPS})
def group(name: str) -> Number:
    """From the numbers printed with it."""
    return _groups()[name]


@check("eq01:material_parameters")
def groups() -> Both:
    """Each from the numbers printed with it."""
    return Both(*_groups().values())


def leading_constant(psi: mp.mpf = PSI_DOT, theta: mp.mpf = THETA_DOT) -> mp.mpf:
    """Return B_-2 of a release at the paper's nutation by eq01:B_sol."""
    return (psi - paper_can.k * paper_can.c_p / 2 * (psi + theta)) * PHI**2


@check("eq01:initial_conditions")
def initial_conditions() -> Fact:
    """Find the release, and the unit of its rates, from which the printed eps and zeta follow."""
    p = paper_can

    def implied(release_: tuple[str, str, mp.mpf, str]) -> tuple[mp.mpf, mp.mpf]:
        unit = {"rad/s": p.SECOND, "sqrt(g/R)": mp.mpf(1)}[release_[3]]
        psi, theta = (mp.mpf(rate) * unit for rate in release_[:2])
        half = p.k * p.c_p / 2 * (psi + theta)
        two = (psi - half) * release_[2] ** 2
        # what the paper calls eps and zeta, see text:eps and text:zeta
        return (p.a_p + 1) * two**2, mp.sqrt(p.a_p + 1) * half / abs(two)

    def fits(release_: tuple[str, str, mp.mpf, str]) -> bool:
        eps_, zeta_ = implied(release_)
        return (
            Number(printed="1.43e-10", value=eps_, source="").near()
            and Number(printed="0.40", value=zeta_, source="").near()
        )

    printed, right = (("0.1001", "-0.1000", PHI, unit) for unit in ("sqrt(g/R)", "rad/s"))
    return Fact(
        printed=printed,
        corrected=right,
        holds=fits,
        how=f"(a_p+1) B_-2^2 = {mp.nstr(implied(right)[0], 4)} with the rates in rad/s, "
        f"{mp.nstr(implied(printed)[0], 4)} with them in sqrt(g/R); the paper's eps is 1.43e-10; "
        f"with rad/s its zeta, computed as under text:zeta, is {mp.nstr(implied(right)[1], 3)}; "
        f"the exact peak of dpsi/dt is {float(release.bounce().bounces[0].peak_psi_dot):.1f} with "
        "rad/s, and the paper prints 3575 and 3449",
    )


@check_each({"text:eps^(1/2)": (0,), "eq01:epsilon_zeta": (1,)})
def scale_of_a_constant(which: int) -> Fact:
    """Ask whether eps comes out of every coefficient of the reduced equation to the first power.

    With the scale of B_-2 (0) or of B_0 (1) as claimed, and that of the other constant eps^(1/2).
    """
    zero, two = exact_constants()

    def extracted(scale: Expr) -> bool:
        letters = {B2: sp.sqrt(eps), B0: zeta * sp.sqrt(eps)} | {(B2, B0)[which]: scale}
        return all(sp.expand(derived(n).subs(letters) / eps).diff(eps) == 0 for n in POWERS)

    return Fact(
        printed=(sp.sqrt(eps), zeta * sp.sqrt(eps))[which],
        holds=extracted,
        how="sympy: each of the eight coefficients is eps times a form in zeta; at the release "
        f"exactly B_-2 = {mp.nstr(two, 6)}, B_0 = {mp.nstr(zero, 6)}, "
        f"ratio {mp.nstr(zero / two, 4)}",
    )


@check("text:eps")
def epsilon() -> Number:
    """B_-2^2; and, to tell beside it, the smallest nutation that eps predicts."""
    _, two = exact_constants()
    p = paper_can
    low = mp.sqrt(two**2 * p.a_p / WIDTH)
    printed = mp.sqrt(mp.mpf("1.43e-10") * p.a_p / WIDTH)
    true = release.bounce().bounces[0].phi_min
    return Number(
        printed="1.43e-10",
        value=two**2,
        source="B_-2^2",
        also="printed is (a_p+1) B_-2^2 = "
        f"{mp.nstr((p.a_p + 1) * leading_constant() ** 2, 4)} with eq01:B_sol, "
        "that is B_-2 in rescaled time, for which a_3 would be a_p/(a_p+1); "
        f"phi_min = sqrt(eps a_p/I) is {mp.nstr(printed, 4)} with the printed eps, "
        f"{mp.nstr(low, 4)} with B_-2^2, and exactly {true:.4g}",
    )


@check("text:zeta")
def zeta_of_the_release() -> Both:
    """B_0/|B_-2|; it does not depend on the unit of time."""
    zero, two = exact_constants()
    p = paper_can
    kc, x = p.k * p.c_p, PHI
    spin = PSI_DOT + THETA_DOT
    guess = mp.sqrt(p.a_p + 1) * kc / 2 * spin / abs(leading_constant())
    log = -(p.h**2 * p.k**2 - p.k) / 4 * (kc * spin - 2 * PSI_DOT) * x**2 * mp.log(x)
    rest = (
        -kc * (5 * PSI_DOT + 2 * THETA_DOT) + (4 - 3 * p.k + 9 * (p.h * p.k) ** 2) * PSI_DOT
    ) / 12
    expanded = kc / 2 * spin * (1 - p.h * p.k * x) + log + rest * x**2
    return Both(
        Number(
            printed="0.40",
            value=zero / abs(two),
            source="exact B_0/|B_-2|",
            also="printed is sqrt(a_p+1) k c_p (Psi + Theta)/(2 |B_-2|) = "
            f"{mp.nstr(guess, 3)}: "
            "the first term of eq01:A_sol in rescaled time over B_-2 in time not rescaled",
        ),
        Number(
            printed="0.40",
            value=expanded / abs((PSI_DOT - kc / 2 * spin) * x**2),
            source="from eq01:A_sol and eq01:B_sol",
        ),
    )


@check("text:sqrt(I)")
def time_to_the_bounce() -> Number:
    """I = 2 phi(0)."""
    return Number(printed="0.2507", value=mp.sqrt(WIDTH), source="sqrt(2 phi(0)), phi(0) = pi/100")


@check("text:numerical peak")
def numerical_peak() -> Number:
    """Take the exact peak of the release, in sqrt(g/R)."""
    least, most = rounded_peaks()
    return Number(
        printed="3575",
        value=release.bounce().bounces[0].peak_psi_dot,
        source="exact motion (g = 9.81), in sqrt(g/R)",
        also=f"eq01:dpsi_max gives {mp.nstr(least, 6)} to {mp.nstr(most, 6)} within the rounding "
        "of the release: the two numbers are exchanged",
    )


def predicted_peak(psi: mp.mpf = PSI_DOT, theta: mp.mpf = THETA_DOT) -> mp.mpf:
    """Return eq01:dpsi_max at a release, in sqrt(g/R) with B_-2 to leading order."""
    return WIDTH / (leading_constant(psi, theta) * paper_can.a_p)


def rounded_peaks() -> tuple[mp.mpf, mp.mpf]:
    """Return the least and the largest eq01:dpsi_max of releases that round to the printed one."""
    second = paper_can.SECOND
    return reach(
        lambda psi, theta: predicted_peak(psi * second, theta * second), "0.1001", "-0.1000"
    )


@check("text:predicted peak")
def peak_by_the_formula() -> Number:
    """With B_-2 from eq01:B_sol."""
    to_rescaled = mp.sqrt(paper_can.a_p + 1)
    as_it_stands = to_rescaled * WIDTH / (mp.sqrt(mp.mpf("1.43e-10")) * paper_can.a_p)
    return Number(
        printed="3449",
        value=predicted_peak(),
        source="eq01:dpsi_max with eq01:B_sol, in sqrt(g/R)",
        also="3449 is the exact peak: the two numbers are exchanged; in the time of (4.22), in "
        f"which (5.17) stands, it is {mp.nstr(to_rescaled * predicted_peak(), 4)}, "
        f"and with the printed eps (5.17) as it stands gives {mp.nstr(as_it_stands, 4)}",
    )


@check("text:error of the peak")
def error_of_the_peak() -> Number:
    """Relative to the exact motion."""
    exact = release.bounce().bounces[0].peak_psi_dot
    return Number(
        printed="3.5",
        value=100 * abs(predicted_peak() / exact - 1),
        source="formula against exact motion, in percent of the exact peak",
        also="3.5 % is of the larger number, which is the formula's",
    )


@check("text:turn in degrees")
def turn_in_degrees() -> Both:
    """Compare with the formula and with the exact turn."""
    p = paper_can
    return Both(
        Number(
            printed="209",
            value=mp.degrees(mp.pi * mp.sqrt((p.a_p + 1) / p.a_p)),
            source="eq01:size_angle_of_turn",
        ),
        Number(
            printed="209",
            value=mp.degrees(release.bounce().bounces[0].angle_of_turn),
            source="exact motion",
        ),
    )


@check_each(
    {
        "text:217 degrees": ("an experiment with another can",),
        "text:202 degrees": ("the other can's moments",),
        "text:ode15s": ("tolerances and a program that are not given",),
        "text:other parameters": ("the other paper's parameters",),
        "text:bounded friction": ("what the other paper shows",),
        "text:improvement": ("the other paper's equations (7) and (9)",),
        "text:equivalent inner problem": ("the other paper's equation (13)",),
        "text:agreeing turn": ("the other paper's expression and its assumptions",),
        "text:difference of the turns": ("the other paper's parameters",),
        "text:assumptions made rigorous": ("the other paper's assumptions",),
        "text:disk that overturns": ("what another work shows of a thin disk",),
    }
)
def outside(reason: str) -> OutOfReach:
    """Say what the paper does not give."""
    return OutOfReach(reason=f"depends on {reason}")


@check("text:same order")
def order_of_the_constants() -> Fact:
    """Compare them with each other and with the rate and the nutation of the release."""
    zero, two = exact_constants()
    sizes = {"B_0": zero, "B_-2": two, "Psi": PSI_DOT, "phi": PHI}
    return Fact(
        printed=("B_0", "B_-2"),
        # half a power of ten
        holds=lambda pair: bool(abs(mp.log10(sizes[pair[0]] / sizes[pair[1]])) < mp.mpf("0.5")),
        how=f"exact release: B_0 = {mp.nstr(zero, 4)}, B_-2 = {mp.nstr(two, 4)}",
    )
