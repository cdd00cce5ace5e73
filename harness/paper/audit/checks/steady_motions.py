"""Section 3: equilibria and steady motions, and how stable rolling in a straight line is."""

from functools import cache
from itertools import pairwise

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can
from harness.paper.audit.evidence import Fact, IdentityEvidence, Number, check
from harness.paper.audit.newton_euler import EQUATIONS, REACH, at_balance, papers_accelerations
from harness.paper.audit.symbols import (
    CAN,
    Co,
    Expr,
    Phi,
    Psi,
    S,
    Theta,
    a,
    a_p,
    c,
    c_p,
    h,
    k,
    phi,
    phi_dd,
    psi_dd,
    theta_dd,
)

STIFFNESS = k * c_p * (c_p + h**2)
"""What Theta^2 is multiplied with in the eigenvalue; the paper prints c_p h k (h + c_p)."""


@check("eq01:static_eqm")
def standing_on_the_rim() -> IdentityEvidence:
    """Insert the state."""
    rates = papers_accelerations()
    everything = sp.Matrix([Psi, Theta, Phi, *rates.values()])

    def left(state: Expr) -> Expr:
        at = dict(zip((Psi, Theta, Phi, phi), state, strict=True))
        return sp.expand_trig(everything).subs(at)

    return IdentityEvidence(
        printed=sp.Matrix([0, 0, 0, sp.atan(1 / h)]),
        compared=left,
        derived=sp.zeros(6, 1),
        source=EQUATIONS,
    )


@check("text:only static equilibrium")
def places_of_rest() -> Fact:
    """Count where a can at rest stays at rest."""
    fall = papers_accelerations()[phi_dd].subs({Psi: 0, Theta: 0, Phi: 0})
    heights = 0.2, 1.473, 5
    falls = [sp.lambdify(phi, fall.subs({a: 1, c: 1, h: x}), "mpmath") for x in heights]
    places = [mp.pi / 2 * n / 500 for n in range(501)]
    signs = [[mp.sign(f(place)) for place in places] for f in falls]
    zeros = [sum(x != y for x, y in pairwise(row)) for row in signs]
    return Fact(
        printed=1,
        holds=lambda count: set(zeros) == {count},
        how="how often phi'' at rest changes its sign in (0, pi/2): "
        + ", ".join(f"{n} for h = {x}" for n, x in zip(zeros, heights, strict=True)),
    )


@check("eq:phistar")
def balancing_angle() -> IdentityEvidence:
    """Put the centre above the contact: R cos phi = H sin phi."""
    return IdentityEvidence(
        printed=sp.atan(1 / h),
        compared=lambda angle: sp.expand_trig(sp.cos(angle) - h * sp.sin(angle)),
        derived=sp.Integer(0),
        source="the centre above the contact",
    )


@check("text:phi* in degrees")
def balancing_angle_in_degrees() -> Number:
    """arctan(1/1.473)."""
    return Number(
        printed="34", value=mp.degrees(mp.atan(1 / paper_can.h)), source="arctan(1/h) in degrees"
    )


def _sideways(form: Expr) -> Expr:
    return Psi * form / REACH


@check("eq01:bal_eqm")
def balanced_rolling() -> IdentityEvidence:
    """Insert phi* into the equation of Phi."""
    lean = (a - c) * h / REACH * Psi
    return IdentityEvidence(
        printed=_sideways(lean - c * Theta),
        corrected=_sideways(lean - (c + 1 + h**2) * Theta),
        derived=at_balance(papers_accelerations()[phi_dd] * (a_p + 1)),
        source=EQUATIONS,
    )


@check("text:balanced Theta")
def balanced_rotation() -> IdentityEvidence:
    """Solve the equation of Phi at phi* for Theta."""
    drive = at_balance(papers_accelerations()[phi_dd])
    return IdentityEvidence(
        printed=(a - c) * h / REACH * Psi / c,
        corrected=(a - c) * h / REACH * Psi / (c_p + h**2),
        derived=sp.solve(sp.cancel(drive / Psi), Theta)[0],
        source=EQUATIONS,
    )


@cache
def _characteristic() -> tuple[Expr, Expr]:
    """Characteristic polynomial of straight rolling, and its variable."""
    x = sp.Symbol("lambda")
    rates = papers_accelerations()
    flow = sp.Matrix([rates[psi_dd], rates[theta_dd], rates[phi_dd], Phi])
    jacobian = flow.jacobian([Psi, Theta, Phi, phi]).subs({Psi: 0, Phi: 0})
    return at_balance(jacobian).applyfunc(sp.simplify).charpoly(x).as_expr(), x


def _eigenvalue(stiffness: Expr) -> Expr:
    return (REACH - Theta**2 * stiffness) / (a_p + 1)


@check("eq01:eigenvalues")
def eigenvalues() -> IdentityEvidence:
    """Linearise the equations of motion about straight rolling."""
    polynomial, x = _characteristic()
    return IdentityEvidence(
        printed=x**2 * (x**2 - _eigenvalue(c_p * h * k * (h + c_p))),
        corrected=x**2 * (x**2 - _eigenvalue(STIFFNESS)),
        derived=polynomial,
        source="the characteristic polynomial of the linearised equations",
    )


PRINTED_CRITICAL = REACH / (h * k * c_p * (h + c_p))
CRITICAL = REACH / STIFFNESS


def _critical(square: Expr) -> str:
    """Return the critical rate of the paper's can."""
    return str(mp.nstr(mp.sqrt(mp.mpmathify(square.subs(CAN))), 5))


@check("text:critical rate")
def critical_rolling() -> IdentityEvidence:
    """Where the eigenvalues of straight rolling vanish."""
    polynomial, x = _characteristic()
    square = sp.Symbol("square")
    quartic = sp.cancel(polynomial / x**2).subs(x, 0).subs(Theta, sp.sqrt(square))
    return IdentityEvidence(
        printed=PRINTED_CRITICAL,
        corrected=CRITICAL,
        derived=sp.solve(quartic, square)[0],
        correct="Theta_crit^2 = sqrt(h^2+1)/(k c_p (c_p + h^2)): for the paper's can Theta_crit is "
        f"{_critical(CRITICAL)}, as printed {_critical(PRINTED_CRITICAL)} sqrt(g/R)",
        source="where both eigenvalues vanish",
    )


@cache
def _square_of_the_eigenvalue() -> Expr:
    """Square of the eigenvalues of straight rolling that are not always 0."""
    polynomial, x = _characteristic()
    return sp.simplify(sp.solve(sp.cancel(polynomial / x**2), x)[0] ** 2)


@check("text:centre-like")
def stability_of_rolling() -> Fact:
    """Sign of lambda^2 a little above and below the rate that is called critical."""
    square = _square_of_the_eigenvalue()
    cans = ({a: 0.727, c: 0.615, h: 1.473}, {a: 0.25, c: 0.5, h: 0.1}, {a: 3, c: 0.5, h: 3})

    def separates(critical: Expr) -> bool:
        return all(
            (square.subs(Theta, sp.sqrt(critical * share)).subs(can) < 0) == (share > 1)
            for can in cans
            for share in (0.99, 1.01)
        )

    return Fact(
        printed=PRINTED_CRITICAL,
        holds=separates,
        corrected=CRITICAL,
        how="lambda^2 from the linearised equations is negative for Theta^2 1 % above sqrt(h^2+1)"
        "/(k c_p (c_p + h^2)) and positive 1 % below, for three cans; the printed Theta_crit "
        f"({_critical(PRINTED_CRITICAL)} for the paper's can) lies where rolling is saddle-like",
        correct=f"with Theta_crit = {_critical(CRITICAL)} sqrt(g/R), see text:critical rate",
    )


@check("text:saddle at the balance")
def saddle_of_panel_b() -> Fact:
    """Sign of lambda^2 where the can of panel b) rolls straight."""
    rate = {Theta: 2 * paper_can.SECOND}
    value = mp.mpmathify(_square_of_the_eigenvalue().subs(CAN | rate))
    return Fact(
        printed="saddle",
        holds=lambda word: (word == "saddle") == (value > 0),
        how=f"lambda^2 = {mp.nstr(value, 4)} at theta' = 2 rad/s; of the reduced equation see "
        "text:no balance",
    )


def _rest_square(sign: int) -> Expr:
    return (Co - h * S) / (a * S * Co + sign * c * h * S**2)


@cache
def derived_rest_square() -> Expr:
    """Psi^2 for which phi'' = 0 while the centre rests."""
    square = sp.Symbol("square", positive=True)
    drive = papers_accelerations()[phi_dd].subs(Theta, -Psi * (Co - h * S))
    linear = sp.expand(drive).subs(Psi, sp.sqrt(square))
    return -linear.subs(square, 0) / linear.diff(square)


@check("text:S_rest")
def rates_at_rest() -> IdentityEvidence:
    """Solve the equation of Phi with Theta = -Psi (cos phi - h sin phi)."""
    return IdentityEvidence(
        printed=_rest_square(1),
        corrected=_rest_square(-1),
        derived=derived_rest_square(),
        source=EQUATIONS,
    )


@check("text:range of S_rest")
def range_of_rest() -> Fact:
    """With the right sign Psi^2 is positive again beyond arctan(a/(c h)), for a > c."""
    p = paper_can
    edge = mp.atan(p.a / (p.c * p.h))
    star, end = mp.atan(1 / p.h), mp.pi / 2
    square = sp.lambdify(phi, derived_rest_square().subs(CAN), "mpmath")
    places = [end * n / 400 for n in range(1, 400)]
    found = [bool(square(place) > 0) for place in places]

    def right(ranges: tuple[tuple[mp.mpf, mp.mpf], ...]) -> bool:
        return found == [any(low < place < high for low, high in ranges) for place in places]

    return Fact(
        printed=((0, star),),
        holds=right,
        corrected=((0, star), (edge, end)),
        how=f"phi'' = 0 asks for Psi^2 = {mp.nstr(square(mp.radians(60)), 5)} > 0 at phi = 60 "
        "degrees too",
        correct="for a > c it exists for phi < phi* and again for phi > arctan(a/(c h)), "
        f"{mp.nstr(mp.degrees(edge), 4)} degrees for the paper's can",
    )


@check("text:steady beyond phi*")
def steady_beyond_balance() -> Fact:
    """For any phi_0 and Psi the condition is linear in Theta."""
    rates = papers_accelerations()
    values = CAN | {phi: mp.radians(60), Psi: 1, Phi: 0}
    found = sp.solve(rates[phi_dd].subs(values), Theta)[0]
    left = [abs(x.subs(values).subs(Theta, found)) for x in rates.values()]
    # solved in double precision
    steady = found.is_real is True and max(left) < 1e-12  # noqa: PLR2004
    return Fact(
        printed="exist",
        holds=lambda word: (word == "exist") == steady,
        how=f"phi = 60 degrees, Psi = 1 is steady with Theta = {mp.nstr(mp.mpmathify(found), 5)}",
    )
