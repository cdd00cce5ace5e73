"""Section 3: the sets of steady motions, their dimensions, and the cans that have them."""

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can
from harness.paper.audit.checks.steady_motions import derived_rest_square
from harness.paper.audit.checks.steady_paths import RADIUS, SIDE
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import (
    EQUATIONS,
    at_balance,
    centre_velocity,
    papers_accelerations,
)
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
    phi,
    phi_dd,
    psi_dd,
    theta_dd,
)

CANS = tuple(
    dict(zip((a, c, h), map(sp.Rational, can), strict=True))
    for can in (
        ("0.727", "0.615", "1.473"),
        ("0.615", "0.615", "1.473"),
        ("0.5", "0.5", "0.2"),
        ("0.25", "0.5", "0.1"),
        ("3", "0.5", "3"),
        ("0.9", "0.9", "2"),
    )
)
"""Cans with a above, at and below c, and with h on both sides of c_p."""


@check("text:balanced at rest")
def balanced_and_at_rest() -> Both:
    """Insert Theta = 0 into the radius and, for several cans, into the equation of Phi."""
    drive = at_balance(papers_accelerations()[phi_dd])

    def steady(rotation: Expr, can: dict[Expr, Expr]) -> bool:
        return bool(sp.simplify(drive.subs(Theta, rotation).subs(can)) == 0)

    return Both(
        IdentityEvidence(
            printed=sp.Integer(0),
            compared=lambda rotation: at_balance(RADIUS).subs(Theta, rotation),
            derived=sp.Integer(0),
            source="the radius at phi*",
        ),
        Fact(
            printed=sp.true,
            corrected=sp.Eq(a, c),
            holds=lambda condition: all(
                bool(condition.subs(can)) == steady(sp.Integer(0), can) for can in CANS
            ),
            how="sympy: at phi* with Theta = 0 phi'' = "
            "Psi^2 h (a - c)/((h^2 + 1) (a_p + 1)), which is 0 for a = c alone: of six cans three",
        ),
    )


@check("text:condition of S_steady")
def steady_rolling() -> IdentityEvidence:
    """With Phi = 0 the other two equations hold by themselves."""
    rates = papers_accelerations()
    still = {Phi: 0}
    printed = (
        ((a_p - c_p) * sp.sin(phi) * sp.cos(phi) - h * sp.cos(2 * phi)) * Psi**2
        - (c_p * sp.sin(phi) + h * sp.cos(phi)) * Theta * Psi
        + (h * sp.sin(phi) - sp.cos(phi))
    )
    return IdentityEvidence(
        printed=sp.Matrix([printed, 0, 0]),
        derived=sp.Matrix(
            [
                (rates[phi_dd] * (a_p + 1)).subs(still),
                rates[psi_dd].subs(still),
                rates[theta_dd].subs(still),
            ]
        ),
        source=EQUATIONS,
    )


def _nutations_of_steady_rolling(printed: tuple[str, ...]) -> Fact:
    """Solve the equation of Phi for Theta with Psi = 1, at phi* and at other nutations."""
    condition = papers_accelerations()[phi_dd].subs(CAN | {Psi: 1})
    places = {"phi*": mp.atan(1 / paper_can.h), "other": mp.radians(20)}
    # linear in Theta: there is a solution where Theta has a coefficient
    there = {name for name, place in places.items() if condition.diff(Theta).subs(phi, place) != 0}
    return Fact(
        printed=printed,
        corrected=("phi*", "other"),
        holds=lambda nutations: set(nutations) == there,
        how="for Psi = 1 there is a Theta of steady rolling at phi* and at 20 degrees",
    )


@check("eq01:equilibrium")
def set_of_steady_motions() -> Both:
    """Insert Phi; and look for steady rolling at phi*, which S_bal asks for, and elsewhere."""
    rates = papers_accelerations()
    return Both(
        IdentityEvidence(
            printed=sp.Integer(0),
            compared=lambda speed: sp.Matrix([Phi, rates[psi_dd], rates[theta_dd]]).subs(
                Phi, speed
            ),
            derived=sp.zeros(3, 1),
            source=f"{EQUATIONS} of phi, Psi and Theta",
        ),
        _nutations_of_steady_rolling(("phi*", "other")),
    )


@check("caption:fig01:eqm_comparison")
def steady_motions_of_the_figure() -> Fact:
    """Look for steady rolling at phi* and elsewhere."""
    return _nutations_of_steady_rolling(("other",))


def _dimension(constraints: Expr, letters: tuple[Expr, ...], point: dict[Expr, mp.mpf]) -> int:
    """Return how many directions constraints leave free at a point on which they hold."""
    at = CAN | point
    slopes = sp.Matrix(constraints).jacobian(letters).subs(at).evalf(30)
    values = sp.Matrix(constraints).subs(at).evalf(30)
    if max(abs(value) for value in values) > DOUBLE:
        raise ArithmeticError(f"the constraints do not hold at {point}")
    return len(letters) - int(slopes.rank(iszerofunc=lambda x: abs(x) < DOUBLE))


DOUBLE = mp.mpf("1e-12")
"""Below this a number of order one, computed with doubles among others, is zero."""


@check("text:1-D manifold")
def dimension_of_balanced_rolling() -> Fact:
    """Count the letters and the independent conditions at a motion of the paper's can."""
    drive = at_balance(papers_accelerations()[phi_dd])
    rotation = sp.solve(sp.cancel(drive / Psi), Theta)[0].subs(CAN | {Psi: 1})
    found = _dimension([drive], (Psi, Theta), {Psi: mp.mpf(1), Theta: mp.mpmathify(rotation)})
    return Fact(
        printed=1,
        holds=lambda dimension: dimension == found,
        how="rank of the slopes in Psi and Theta, for a != c: one condition; for a = c it "
        "asks for Theta = 0, which the statement excludes; for Theta/Psi see text:balanced Theta",
    )


@check("text:S_rest as a set")
def motions_at_rest() -> IdentityEvidence:
    """Insert Theta, with Psi^2 as derived, into the equation of Phi and the centre's velocity."""
    drive = papers_accelerations()[phi_dd]
    velocity = centre_velocity().subs(Phi, 0)
    return IdentityEvidence(
        printed=-Psi * (Co - h * S),
        compared=lambda rotation: sp.Matrix(
            [
                sp.expand(drive.subs(Theta, rotation)).subs(Psi, sp.sqrt(derived_rest_square())),
                *velocity.subs(Theta, rotation),
            ]
        ),
        derived=sp.zeros(4, 1),
        source=f"{EQUATIONS} and a centre at rest, with Psi^2 as under text:S_rest",
    )


@check("text:1-D set")
def dimension_of_rest() -> Fact:
    """Count the letters and the independent conditions at a motion of the paper's can."""
    tilt = mp.radians(20)
    psi_e = mp.sqrt(mp.mpmathify(derived_rest_square().subs(CAN | {phi: tilt})))
    theta_e = mp.mpmathify(sp.solve(SIDE.subs(CAN | {phi: tilt, Psi: psi_e}), Theta)[0])
    drive = papers_accelerations()[phi_dd].subs(Phi, 0)
    point = {Psi: psi_e, Theta: theta_e, phi: tilt}
    found = _dimension([drive, SIDE], (Psi, Theta, phi), point)
    return Fact(
        printed=1,
        holds=lambda dimension: dimension == found,
        how="rank of the slopes in Psi, Theta and phi at phi = 20 degrees: two conditions, (3.7) "
        "and (3.11); that there is no friction see text:no friction at rest",
    )


@check("text:lying and rolling")
def rolling_on_its_side() -> Both:
    """Insert it; and ask for which cans the rates are real."""
    rates = papers_accelerations()
    spin = sp.sqrt(h / (c_p - h))
    return Both(
        IdentityEvidence(
            printed=sp.Matrix([sp.pi / 2, spin, spin]),
            compared=lambda at: rates[phi_dd].subs(
                dict(zip((phi, Psi, Theta), at, strict=True)) | {Phi: 0}
            ),
            derived=sp.Integer(0),
            source=EQUATIONS,
        ),
        Fact(
            printed=sp.true,
            corrected=sp.Lt(h, c_p),
            holds=lambda condition: all(
                bool(condition.subs(can)) == bool(spin.subs(can).is_real) for can in CANS
            ),
            how="of six cans the rates are real for the four with h < c_p",
        ),
    )
