"""Section 3: the sets of steady motions, their dimensions, and the cans that have them."""

from functools import cache

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can
from harness.paper.audit.checks.steady_motions import derived_rest_square
from harness.paper.audit.checks.steady_paths import SIDE
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import (
    EQUATIONS,
    REACH,
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

DOUBLE = mp.mpf("1e-12")
"""Below this a number of order one, computed with doubles among others, is zero."""
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


SPINNING = sp.Integer(1), sp.Integer(0)
"""Psi and Theta of a can that spins about the vertical and does not rotate in its frame."""


@check("text:balanced at rest")
def balanced_and_at_rest() -> Both:
    """Ask of several cans which of them have such a motion, and whether its centre is at rest."""
    derived = at_balance(papers_accelerations()[phi_dd])
    printed = Psi * ((a - c) * h / REACH * Psi - c * Theta)  # (3.3), whose factor matters not here
    speed = at_balance(SIDE)

    def zero(form: Expr, rates: tuple[Expr, Expr], can: dict[Expr, Expr]) -> bool:
        return bool(
            sp.simplify(form.subs(dict(zip((Psi, Theta), rates, strict=True))).subs(can)) == 0
        )

    def rests(rates: tuple[Expr, Expr]) -> bool:
        having = [can for can in CANS if zero(derived, rates, can)]
        return bool(having) and all(zero(speed, rates, can) for can in having)

    def occurs(condition: Expr) -> bool:
        return all(
            bool(condition.subs(can)) == zero(form, SPINNING, can)
            for can in CANS
            for form in (derived, printed)
        )

    paper = "does" if zero(derived, SPINNING, CANS[0]) else "does not"
    return Both(
        Fact(printed=SPINNING, holds=rests, how="sympy: true of every such motion"),
        Fact(
            printed=sp.Eq(a, c),
            holds=occurs,
            how="by (3.3), printed or put right, there is one for a = c alone, so that for the "
            f"paper's can, with a = {mp.nstr(paper_can.a, 4)} and c = {mp.nstr(paper_can.c, 4)}, "
            f"the case {paper} occur",
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


@cache
def _steady_rotations(precession: int) -> dict[str, mp.mpf]:
    """Return the Theta of steady motion with a precession, at phi* and elsewhere if there is one.

    Inserted into the three equations of motion; where any Theta will do, it is 1.
    """
    forces = papers_accelerations()
    found = {}
    for name, place in {"phi*": mp.atan(1 / paper_can.h), "other": mp.radians(20)}.items():
        here = CAN | {Psi: precession, Phi: 0, phi: place}
        drive = sp.expand(forces[phi_dd].subs(here))
        slope = drive.coeff(Theta, 1)
        rotation = -drive.coeff(Theta, 0) / slope if abs(slope) > DOUBLE else sp.Integer(1)
        left = [mp.mpmathify(form.subs(here).subs(Theta, rotation)) for form in forces.values()]
        if max(map(abs, left)) < DOUBLE:
            found[name] = mp.mpmathify(rotation)
    return found


def _nutations_of_steady_rolling(printed: tuple[str, ...]) -> Fact:
    """Look for steady motions at phi* and at another nutation, with and without precession."""
    rotations = _steady_rotations(1)
    listed = ", ".join(f"{mp.nstr(x, 4)} at {_PLACES[name]}" for name, x in rotations.items())
    straight = " and ".join(_PLACES[name] for name in _steady_rotations(0))
    return Fact(
        printed=printed,
        corrected=("phi*", "other"),
        holds=lambda nutations: set(nutations) == set(rotations),
        how=f"steady with Psi = 1: Theta = {listed}; with Psi = 0 at {straight} alone",
    )


_PLACES = {"phi*": "phi*", "other": "20 degrees"}


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
    """Insert it; and ask whether the paper's can has it, and which others."""
    rates = papers_accelerations()
    spin = sp.sqrt(h / (c_p - h))
    rate = mp.mpmathify(spin.subs(CAN))

    def real(can: dict[Expr, Expr]) -> bool:
        return bool(spin.subs(can).is_real)

    taller = sum(not real(can) for can in CANS)
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
            printed=CANS[0],
            holds=real,
            how=f"the rates of the paper's can are real, +-{mp.nstr(rate, 4)}",
        ),
        Fact(
            printed=sp.Lt(h, c_p),
            holds=lambda condition: all(bool(condition.subs(can)) == real(can) for can in CANS),
            how=f"they are real for h < c_p alone (h = {mp.nstr(paper_can.h, 4)}, c_p = "
            f"{mp.nstr(paper_can.c_p, 4)}); of {len(CANS)} cans {taller} are taller and have no "
            "such motion",
        ),
    )
