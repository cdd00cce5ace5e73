"""Appendix C: what the two constants have to do with angular momenta."""

from functools import cache

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper import release
from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Rate, check
from harness.paper.audit.flat_motion import EXACT, RATES, TINY, exact_constants
from harness.paper.audit.flat_series import valued
from harness.paper.audit.newton_euler import (
    ARM,
    VERTICAL,
    angular_momentum,
    body_rates,
    contact_force,
    papers_accelerations,
    rotation,
    turn_z,
)
from harness.paper.audit.symbols import ZERO, Co, Expr, Phi, Psi, S, Theta, a, c, h, k, phi, psi
from harness.paper.audit.symbols import psi as precession
from reference import PAPER_CAN
from reference.equations.reaction_force import contact_force as reaction


@check("eq01:ang_mom_B")
def momentum_about_the_axis() -> Both:
    """Expand."""
    exact = c * (Theta + Psi * Co)
    expanded = sp.series(exact, phi, 0, 4).removeO()
    tail = -c * Psi * phi**2 / 2
    return Both(
        IdentityEvidence(printed=exact, derived=c * body_rates()[1][2], source="c Omega_z"),
        IdentityEvidence(
            printed=c * (Theta + Phi) + tail,
            corrected=c * (Theta + Psi) + tail,
            derived=sp.expand(expanded),
            source="its Taylor series to phi^3",
        ),
    )


@check("eq01:ang_mom_G")
def momentum_about_the_vertical() -> Both:
    """Project the angular momentum, and expand."""
    momentum = angular_momentum()
    exact = a * Psi * S**2 + c * Co * (Psi * Co + Theta)
    square = -c / 2 * (Theta + 2 * Psi) + a * Psi
    return Both(
        IdentityEvidence(
            printed=exact, derived=(rotation() * momentum)[2], source="I Omega along z"
        ),
        IdentityEvidence(
            printed=c * (Theta + Psi) + square * phi**2,
            derived=sp.expand(sp.series(exact, phi, 0, 4).removeO()),
            source="its Taylor series to phi^3",
        ),
    )


@check("text:B_0 and H_B")
def regular_constant_is_momentum() -> Rate:
    """At fixed Psi and Theta."""
    p = paper_can

    def remainder(factor: Expr, x: mp.mpf) -> mp.mpf:
        share = sp.lambdify((a, c, h), factor, "mpmath")(p.a, p.c, p.h)
        momentum = p.c * (RATES[1] + RATES[0] * mp.cos(x))
        return flat_motion.constants(x, *RATES)[0] - share * momentum

    return Rate(printed=k * (c + 1) / (2 * c), remainder=remainder, stated=1, at=TINY, source=EXACT)


FRICTION = k * Phi * (a * Psi * S + c * h * (Psi * Co + Theta))


@check("eq01:friction_tangential")
def tangential_friction() -> IdentityEvidence:
    """Insert the accelerations into the force, seen in I."""
    seen = (turn_z(psi).T * contact_force())[1].subs(papers_accelerations())
    return IdentityEvidence(
        printed=FRICTION, corrected=-FRICTION, derived=seen, source="the force of eq01:n2l_lin"
    )


@check("text:lines of action")
def lines_of_action() -> IdentityEvidence:
    """Moments about the centre of unit forces along x^I and z, along both axes."""
    arm = turn_z(-psi) * rotation() * ARM
    axis = turn_z(-psi) * rotation() * VERTICAL
    along = sp.Matrix([1, 0, 0])

    def moments(forces: Expr) -> Expr:
        found = [arm.cross(forces[:, i]).dot(z) for i in range(2) for z in (axis, VERTICAL)]
        return sp.Matrix(found)

    return IdentityEvidence(
        printed=sp.Matrix.hstack(along, VERTICAL),
        compared=moments,
        derived=sp.zeros(4, 1),
        source="moments about the centre",
    )


@check("text:F_y in proportion")
def friction_in_proportion() -> Fact:
    """Along a motion a Psi sin phi = a B_-2/phi outgrows c h (Psi cos phi + Theta)."""
    p = paper_can

    def quotient(form: Expr, x: mp.mpf) -> mp.mpf:
        psi_, theta_ = flat_motion.rates(x, mp.mpf("0.7"), mp.mpf(1))
        force = p.a * psi_ * mp.sin(x) + p.c * p.h * (psi_ * mp.cos(x) + theta_)
        return force / valued(form, Psi, Theta)(x, psi_, theta_)

    def proportional(form: Expr) -> bool:
        with mp.workdps(40):
            far, near = (quotient(form, mp.mpf(x)) for x in ("1e-6", "1e-8"))
            # what is left out is phi log phi of it
            return bool(abs(near / far - 1) < mp.mpf("1e-3"))

    with mp.workdps(40):
        told = [mp.nstr(quotient(Theta + Psi, mp.mpf(x)), 3) for x in ("1e-6", "1e-8")]
    return Fact(
        printed=Theta + Psi,
        holds=proportional,
        corrected=Psi * phi,
        how="F_y^I/Phi over Theta + Psi, which should tend to a constant, goes from "
        f"{told[0]} at phi = 1e-6 to {told[1]} at 1e-8 (B_0 = 0.7, B_-2 = 1)",
    )


LOGARITHM = "(1 - h^2 k)/c_p B_-2 log phi"
LESS_LOG, AXIS_LESS_LOG = (f"{name} - {LOGARITHM}" for name in ("Theta + Psi", "H_z^B/c"))
SAME = mp.mpf("0.1")
"""Two quantities in proportion to each other keep their ratio to a tenth over the fall."""


@cache
def fall() -> dict[str, tuple[mp.mpf, mp.mpf]]:
    """Return sum of the rates and momenta of the exact release, at the top and in the bounce.

    The sum and the momentum about the axis over c also less their logarithm.
    """
    with mp.workdps(30):
        constants = exact_constants()
        places = paper_can.PHI, mp.mpf(release.bounce().bounces[0].phi_min)
        found = []
        for x in places:
            psi, theta = flat_motion.rates(x, *constants)
            axis, vertical = momenta_of(x, psi, theta).values()
            slope = (1 - paper_can.h**2 * paper_can.k) / paper_can.c_p * constants[1]
            rest = [form - slope * mp.log(x) for form in (theta + psi, axis / paper_can.c)]
            found.append((theta + psi, axis, vertical, axis - vertical, *rest))
        names = ("Theta + Psi", "H_z^B", "H_z^G", "H_z^B - H_z^G", LESS_LOG, AXIS_LESS_LOG)
        return {n: (found[0][i], found[1][i]) for i, n in enumerate(names)}


def _kept(quantity: str) -> bool:
    top, low = fall()[quantity]
    return bool(abs(low / top - 1) < SAME)


MOMENTUM = "m R^2 sqrt(g/R)"
"""Unit of a momentum, where a rate is in sqrt(g/R)."""


def _change(*quantities: str, unit: str = MOMENTUM) -> str:
    pairs = fall()
    listed = "; ".join(
        f"{name} goes from {mp.nstr(pairs[name][0], 4)} at release to {mp.nstr(pairs[name][1], 4)} "
        "in the bounce"
        for name in quantities
    )
    return f"exact release: {listed}, in {unit}"


@check("text:B_0 as momentum")
def regular_constant_as_momentum() -> Fact:
    """Follow the momentum over the fall: B_0 is constant."""
    zero, _ = exact_constants()
    share = paper_can.k * paper_can.c_p / (2 * paper_can.c) * fall()["H_z^B"][0] / zero
    return Fact(
        printed="H_z^B",
        corrected=AXIS_LESS_LOG,
        holds=_kept,
        how=f"{_change('H_z^B')}, while B_0 = {mp.nstr(zero, 4)} stays; "
        f"k c_p H_z^B/(2 c) is {mp.nstr(share, 3)} B_0 at release",
        correct=f"H_z^B = c (2 B_0/(k c_p) + {LOGARITHM} + O(B_-2)): the two agree only for fixed "
        "rates as phi -> 0, and the rates of a motion grow as phi^-2",
    )


@check("text:the other constant")
def singular_constant_as_difference() -> Fact:
    """Follow the difference over the fall: it stays as B_-2 does."""
    return Fact(
        printed="H_z^B - H_z^G",
        holds=_kept,
        how=_change("H_z^B - H_z^G"),
    )


PLACES = (paper_can.PHI, mp.mpf("0.001"))
"""Nutations of a fall at which the constants are written with the momenta."""


def momenta_of(phi_: mp.mpf, psi_: mp.mpf, theta_: mp.mpf) -> dict[str, mp.mpf]:
    """Return the momenta about the axis and the vertical, (C.1) and (C.2)."""
    axis = paper_can.c * (theta_ + psi_ * mp.cos(phi_))
    return {
        "H_z^B": axis,
        "H_z^G": paper_can.a * psi_ * mp.sin(phi_) ** 2 + mp.cos(phi_) * axis,
    }


@check("text:momenta in short")
def constants_from_momenta() -> Fact:
    """Solve for the constants with momenta at two nutations, and insert rates of other motions."""
    motions = ((mp.mpf(1), mp.mpf(0)), (mp.mpf(0), mp.mpf(1)), (mp.mpf(2), mp.mpf("-0.75")))

    def related(names: tuple[str, ...]) -> bool:
        with mp.workdps(40):
            for x in PLACES:
                rows = [[momenta_of(x, *rates)[name] for name in names] for rates in motions]
                constants = [flat_motion.constants(x, *rates) for rates in motions]
                square = mp.matrix(rows[:2])
                if square.cols != square.rows or abs(mp.det(square)) < ZERO:
                    return False
                for which in range(2):
                    share = mp.lu_solve(square, mp.matrix([pair[which] for pair in constants[:2]]))
                    value = sum(s * momentum for s, momentum in zip(share, rows[2], strict=True))
                    if abs(value - constants[2][which]) > ZERO:
                        return False
        return True

    return Fact(
        printed=("H_z^B", "H_z^G"),
        holds=related,
        how="at each phi B_0 and B_-2 are linear in H_z^B and H_z^G, and the other way round (40 "
        "digits, phi = "
        f"{' and '.join(mp.nstr(x, 3) for x in PLACES)}); in proportion is another matter, see "
        "text:B_0 as momentum",
    )


@check("text:constants as momenta")
def constants_as_momenta() -> Fact:
    """Follow over the fall the momentum that the paper has for each constant."""
    momenta = {"B_0": "H_z^B", "B_-2": "H_z^B - H_z^G"}
    return Fact(
        printed=("B_0", "B_-2"),
        corrected=("B_-2",),
        holds=lambda names: all(_kept(momenta[name]) for name in names),
        how=f"{_change(*momenta.values())}, while B_0 and B_-2 stay",
    )


@check("text:eps as momenta")
def eps_as_momenta() -> Fact:
    """Follow over the fall the quotient of the momenta and the root of eps."""
    return Fact(
        printed="H_z^B - H_z^G",
        holds=_kept,
        how=f"eps = B_-2^2 is constant; {_change('H_z^B - H_z^G')}",
    )


@check("text:sum in proportion")
def sum_in_proportion() -> Fact:
    """Follow the sum over the fall."""
    return Fact(
        printed="Theta + Psi",
        corrected=LESS_LOG,
        holds=_kept,
        how=f"{_change('Theta + Psi', unit='sqrt(g/R)')}, while B_0 stays",
        correct=f"Theta + Psi = {LOGARITHM} + 2 B_0/(k c_p) + O(B_-2): the logarithm leads",
    )


@check("text:effect of friction")
def effect_of_friction() -> Fact:
    """Compare the change of the momenta over the fall with their unit and with themselves."""
    names = ("H_z^B", "H_z^G")
    pairs = [fall()[name] for name in names]
    largest = max(abs(low - top) for top, low in pairs)
    sizes = {"in themselves": mp.mpf(1), "beside the momenta": min(abs(top) for top, _ in pairs)}
    _, two = exact_constants()
    p, lowest = paper_can, mp.mpf(release.bounce().bounces[0].phi_min)
    logarithm = p.c * (1 - p.h**2 * p.k) / p.c_p * two * mp.log(lowest / p.PHI)
    top, low = pairs[0]
    return Fact(
        printed="in themselves",
        # a hundredth, as for the force under text:small F_y
        holds=lambda scale: bool(largest < SAME / 10 * sizes[scale]),
        how="small in themselves, as B_-2 is; but not beside the momenta: over a fall H_z^B "
        f"changes by c (1 - h^2 k)/c_p B_-2 log(phi_min/phi_0) = {mp.nstr(logarithm, 4)} (exactly "
        f"{mp.nstr(low - top, 4)}), which is more than H_z^B itself, however small B_0 is; only "
        f"the difference H_z^B - H_z^G is kept; {_change(*names)}",
    )


@check("text:small F_y")
def smallness_of_the_tangential_friction() -> Fact:
    """Largest F_y^I of the exact release, in parts of the weight."""
    solution = release.bounce()
    forces = reaction(solution.at(solution.grid()), PAPER_CAN)
    names = ("F_x^I", "F_y^I", "N")
    largest = {name: float(np.abs(f).max()) for name, f in zip(names, forces, strict=True)}
    return Fact(
        printed="F_y^I",
        holds=lambda name: largest[name] < float(SAME) * largest["N"] / 10,
        how="exact release, at most, in m g: "
        + ", ".join(f"{name} {value:.2e}" for name, value in largest.items()),
    )


@check("text:H_z^G as momentum")
def momentum_about_the_vertical_alone() -> IdentityEvidence:
    """Project the angular momentum about the centre on each axis."""
    momentum = angular_momentum()
    vertical = (rotation() * momentum)[2]
    axis = momentum[2]
    letters = sp.symbols("L_vertical L_axis")
    return IdentityEvidence(
        printed=letters[0] + letters[1],
        corrected=letters[0],
        compared=lambda form: sp.expand(
            form.subs(dict(zip(letters, (vertical, axis), strict=True)))
        ),
        derived=a * Psi * S**2 + c * Co * (Psi * Co + Theta),
        source="(C.2)",
    )


@check("caption:fig01:conserved_quantity_diagram")
def lines_that_meet() -> Fact:
    """Solve for the points in which a line through the contact meets an axis through the centre."""
    contact = rotation() * ARM
    forward = sp.Matrix([1, 0, 0])
    # in the vertical plane of the frame I, psi = 0, at some tilt of some can
    flat = {precession: 0, phi: sp.pi / 6, h: sp.Rational(3, 2)}
    place, axis = contact.subs(flat), (rotation() * VERTICAL).subs(flat)
    u, v = sp.symbols("u v", real=True)
    lines = {"N": VERTICAL, "F_x^I": forward}
    axes = {"z^G": VERTICAL, "z^B": axis}
    met = {
        (force, name)
        for force, along in lines.items()
        for name, way in axes.items()
        if sp.solve(list(place + u * along - v * way), [u, v], dict=True)
    }
    every = frozenset((force, name) for force in lines for name in axes)
    right = every - {("N", "z^G")}
    return Fact(
        printed=every,
        corrected=right,
        holds=lambda pairs: set(pairs) == met,
        how="sympy: N is parallel to z^G, at the distance R cos phi - H sin phi; the other three "
        "pairs meet",
    )
