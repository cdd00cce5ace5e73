"""Appendix E: the reduced equation as a Hamiltonian system."""

import mpmath as mp
import sympy as sp

from harness.studies.audit import paper_can
from harness.studies.audit.checks.outer import POWERS, a_
from harness.studies.audit.evidence import Both, Fact, Identity
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import A, H, Phi, R, a_p, eps, g, m, phi

log = sp.log(phi)
FORCE = eps * sum(a_[n] * log**j / phi**i for n, (i, j) in POWERS.items()) - 1
PRINTED = (
    Phi**2 / 2
    + phi
    - eps
    * (
        log**2 * (a_["ll"] / 2 + a_["ll"] * phi)
        + (a_["l0"] - 2 * a_["ll"] - a_["l2"] / phi) * log
        + (a_["0"] - 2 * a_["ll"] - a_["l0"]) * phi
        - (a_["2"] - a_["l2"]) / phi
        - a_["3"] / (2 * phi**2)
    )
)
MENDED = (
    Phi**2 / 2
    + phi
    - eps
    * (
        log**2 * (a_["l1"] / 2 + a_["ll"] * phi)
        + ((a_["l0"] - 2 * a_["ll"]) * phi + a_["1"] - a_["l2"] / phi) * log
        + (a_["0"] + 2 * a_["ll"] - a_["l0"]) * phi
        - (a_["2"] + a_["l2"]) / phi
        - a_["3"] / (2 * phi**2)
    )
)
CORRECT = (
    "ln^2(phi) (a_l1/2 + a_ll phi) + ((a_l0 - 2 a_ll) phi + a_1 - a_l2/phi) ln phi + "
    "(a_0 + 2 a_ll - a_l0) phi - (a_2 + a_l2)/phi - a_3/(2 phi^2)"
)


@claim("eq01:hamiltonian1", "E", "the Hamiltonian of the reduced equation")
def hamiltonian() -> Identity:
    """Its slope in phi is minus the right side of eq01:Phi_reduced."""
    return Identity(
        printed=-PRINTED.diff(phi),
        corrected=-MENDED.diff(phi),
        derived=FORCE,
        source="eq01:Phi_reduced",
        correct=CORRECT,
    )


@claim("eqA:ham1", "E", "dPhi/dt = -dH/dphi = the right side of eq01:Phi_reduced")
def momentum_equation() -> Identity:
    """With the mended H."""
    return Identity(
        printed=-MENDED.diff(phi), derived=FORCE, source="eq01:Phi_reduced, with the mended H"
    )


@claim("eqA:ham2", "E", "dphi/dt = dH/dPhi = Phi")
def position_equation() -> Identity:
    """Differentiate the printed H, which is right here."""
    return Identity(printed=PRINTED.diff(Phi), derived=Phi, source="the definition of Phi")


@claim("eq01:hamiltonian", "E", "the contour H = E meets Phi = 0 in two points, one, or none")
def turning_points() -> Fact:
    """For a_3 alone, which rules near 0: the potential has one minimum."""
    strength = sp.Symbol("s", positive=True)
    potential = phi + strength / (2 * phi**2)
    minimum = sp.solve(potential.diff(phi), phi)
    bend = potential.diff(phi, 2)
    return Fact(
        true=len(minimum) == 1 and bend.is_positive is True,
        how=f"sympy: phi + s/(2 phi^2) is convex with its minimum at {minimum[0]}",
    )


@claim("text:clockwise contours", "E", "solutions follow the contours clockwise")
def clockwise_contours() -> Fact:
    """Above the axis phi grows; the axis of Phi points up."""
    true = PRINTED.diff(Phi).subs(Phi, 1) > 0
    return Fact(true=bool(true), how="sympy: dphi/dt = Phi > 0 in the upper half plane")


@claim("text:period integral", "E", "T = 2 int dphi/Phi between the turning points")
def period_integral() -> Fact:
    """For an oscillator whose period is known: Phi = sqrt(1 - phi^2)."""
    x = sp.Symbol("x", real=True)
    found = 2 * sp.integrate(1 / sp.sqrt(1 - x**2), (x, -1, 1))
    return Fact(
        true=sp.simplify(found - 2 * sp.pi) == 0, how="sympy: 2 pi for a harmonic oscillator"
    )


@claim("text:T at eps=0", "E", "T|_(eps=0) = sqrt(2) int dphi/sqrt(h - phi)")
def period_without_eps() -> Both:
    """H is the can's height elsewhere: here it must be the energy E."""
    top = paper_can.PHI
    whole = 2 * mp.sqrt(2 * top)
    right = mp.sqrt(2) * mp.quad(lambda y: 1 / mp.sqrt(top - y), [0, top])
    printed = mp.sqrt(2) * mp.quad(lambda y: 1 / mp.sqrt(paper_can.h - y), [0, top])
    energy, letter = sp.symbols("E h", positive=True)
    speed = sp.sqrt(2 * (energy - phi))
    return Both(
        parts=(
            Identity(
                printed=sp.sqrt(2) / sp.sqrt(letter - phi),
                corrected=sp.sqrt(2) / sp.sqrt(energy - phi),
                derived=2 / speed,
                source="Phi^2/2 + phi = E",
                correct="sqrt(2) int dphi/sqrt(E - phi); h means H/R elsewhere",
            ),
            Fact(
                true=abs(right / whole - 1) < mp.mpf("1e-9"),
                how=f"release at pi/100: {mp.nstr(right, 7)} with E = phi_1, "
                f"{mp.nstr(printed, 7)} with h = 1.473, 2 sqrt(2 phi_1) = {mp.nstr(whole, 7)}",
            ),
        )
    )


@claim("text:T of a flat fall", "E", "T|_(eps=0) = 2 sqrt(2 phi_1)")
def period_of_the_fall() -> Identity:
    """Twice the time of fall with phi'' = -1."""
    top, t = sp.symbols("phi_1 t", positive=True)
    return Identity(
        printed=2 * sp.sqrt(2 * top),
        derived=2 * sp.solve(top - t**2 / 2, t)[0],
        source="phi'' = -1",
    )


@claim("text:T in seconds", "E", "T|_(eps=0) = 2 sqrt(2 phi_1 (A + m H^2 + m R^2)/(m g R))")
def period_in_seconds() -> Identity:
    """Undo the scaling of time."""
    return Identity(
        printed=(A + m * H**2 + m * R**2) / (m * g * R),
        derived=(a_p + 1) * R / g,
        source="eq01:scalings and time in sqrt(a_p+1), the square",
    )


@claim("text:taller cans fall slower", "E", "cans with larger H take longer to fall")
def taller_cans() -> Fact:
    """Differentiate by H at fixed A; A grows with H too."""
    height = sp.Symbol("H", positive=True)
    other = sp.Symbol("A", positive=True)
    slope = ((other + m * height**2 + m * R**2) / (m * g * R)).diff(height)
    return Fact(true=slope.is_positive is True, how="sympy: the square of T grows with H")
