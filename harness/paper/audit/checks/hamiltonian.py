"""Appendix E: the reduced equation as a Hamiltonian system, and its phase portrait."""

import math

import mpmath as mp
import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from harness.paper import release
from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit.evidence import Fact, IdentityEvidence, check
from harness.paper.audit.flat_motion import exact_constants
from harness.paper.audit.reduced_form import FORCE, HAMILTONIAN, POWERS, a_
from harness.paper.audit.symbols import A, Expr, H, Phi, R, a_p, eps, g, m, phi
from reference import PAPER_CAN
from reference.asymptotic.small_nutation import reduced_equation, reduced_of

log = sp.log(phi)
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


@check("eq01:hamiltonian1")
def hamiltonian() -> IdentityEvidence:
    """Its slope in phi is minus the right side of eq01:Phi_reduced, that in Phi is Phi."""
    return IdentityEvidence(
        printed=PRINTED,
        corrected=HAMILTONIAN,
        compared=lambda energy: sp.Matrix([-energy.diff(phi), energy.diff(Phi)]),
        derived=sp.Matrix([FORCE, Phi]),
        source="eq01:Phi_reduced",
    )


@check("eqA:ham1")
def momentum_equation() -> IdentityEvidence:
    """With the H to which it refers."""
    return IdentityEvidence(
        printed=PRINTED,
        corrected=HAMILTONIAN,
        compared=lambda energy: -energy.diff(phi),
        derived=FORCE,
        source="eq01:Phi_reduced",
    )


@check("eqA:ham2")
def position_equation() -> IdentityEvidence:
    """Differentiate the printed H, which is right here."""
    return IdentityEvidence(
        printed=PRINTED,
        compared=lambda energy: energy.diff(Phi),
        derived=Phi,
        source="the definition of Phi",
    )


@check("eq01:hamiltonian")
def turning_points() -> Fact:
    """Count them for the release, at an energy above the minimum, at it, and below it."""
    places = np.geomspace(1e-6, np.pi / 2, 20001)
    values = reduced_of(release.bounce().problem)
    letters = {symbol: getattr(values, f"a_{name}") for name, symbol in a_.items()}
    counted = []
    for form in (PRINTED, HAMILTONIAN):
        at_rest = form.subs({Phi: 0, eps: 1} | letters)
        energy = sp.lambdify(phi, at_rest, "numpy")(places)
        lowest = float(energy.min())
        bends = np.diff(np.sign(np.diff(energy)))
        counted.append(
            (
                int(np.count_nonzero(np.diff(np.sign(energy - 2 * lowest)))),
                int(np.count_nonzero(bends)),  # at the minimum itself the two meet
                int(np.count_nonzero(np.diff(np.sign(energy - lowest / 2)))),
            )
        )
    return Fact(
        printed=(2, 1, 0),
        holds=lambda said: all(counts == said for counts in counted),
        how="the Hamiltonian of the release over (0, pi/2), as printed and put right: "
        f"{counted[0]} and {counted[1]} intersections at twice its minimum ({lowest:.4g}), at it, "
        "and at half of it",
    )


@check("text:clockwise contours")
def clockwise_contours() -> Fact:
    """Above the axis phi grows; the axis of Phi points up."""
    sense = "clockwise" if PRINTED.diff(Phi).subs(Phi, 1) > 0 else "anticlockwise"
    return Fact(
        printed="clockwise",
        holds=lambda word: word == sense,
        how="sympy: dphi/dt = Phi > 0 in the upper half plane",
    )


@check("text:period integral")
def period_integral() -> Fact:
    """Integrate phi'' = s/phi^3 - 1 in time over half a period, and the integral over phi."""
    strength, top = 0.01, 1.0
    energy = top + strength / (2 * top**2)

    def below(_t: float, y: "np.ndarray") -> float:
        """Return what turns positive where the can is lowest."""
        return float(y[1])

    below.direction, below.terminal = 1, True  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda _t, y: [y[1], strength / y[0] ** 3 - 1],
        (0, 10),
        [top, 0],
        events=below,
        rtol=1e-11,
        atol=1e-13,
    )
    period = 2 * float(run.t_events[0][0])
    bottom = min(r for r in mp.polyroots([1, -energy, 0, strength / 2]) if r > 0)

    def matches(integrand: Expr) -> bool:
        value = sp.lambdify(Phi, integrand, "mpmath")
        over = mp.quad(
            lambda y: value(mp.sqrt(2 * abs(energy - y - strength / (2 * y**2)))),
            [bottom, 0.5, top],
        )
        # the integral is singular at both ends
        return bool(abs(over / period - 1) < mp.mpf("1e-6"))

    return Fact(
        printed=2 / Phi,
        holds=matches,
        how=f"phi'' = 0.01/phi^3 - 1 from rest at 1: integrated in time, T = {period:.8f}",
    )


@check("text:T at eps=0")
def period_without_eps() -> IdentityEvidence:
    """H is the can's height elsewhere: here it must be the energy E; squared."""
    top = paper_can.PHI
    whole = 2 * mp.sqrt(2 * top)
    printed = mp.sqrt(2) * mp.quad(lambda y: 1 / mp.sqrt(paper_can.h - y), [0, top])
    # above phi wherever it is tried, as an energy is
    over, letter = sp.symbols("E_over_phi h", positive=True)
    energy = phi + over
    return IdentityEvidence(
        printed=2 / (letter - phi),
        corrected=2 / (energy - phi),
        derived=(2 / sp.sqrt(2 * over)) ** 2,
        source="2/Phi with Phi^2/2 + phi = E, the square",
        correct="sqrt(2) int dphi/sqrt(E - phi), where h means H/R elsewhere: for the release "
        f"{mp.nstr(whole, 5)}, with h = 1.473 {mp.nstr(printed, 3)}",
    )


@check("text:T of a flat fall")
def period_of_the_fall() -> IdentityEvidence:
    """Twice the time of fall with phi'' = -1."""
    top, t = sp.symbols("phi_1 t", positive=True)
    return IdentityEvidence(
        printed=2 * sp.sqrt(2 * top),
        derived=2 * sp.solve(top - t**2 / 2, t)[0],
        source="phi'' = -1",
    )


@check("text:T in seconds")
def period_in_seconds() -> IdentityEvidence:
    """Undo the scaling of time."""
    return IdentityEvidence(
        printed=(A + m * H**2 + m * R**2) / (m * g * R),
        derived=(a_p + 1) * R / g,
        source="eq01:scalings and time in sqrt(a_p+1), the square",
    )


@check("text:taller cans fall slower")
def taller_cans() -> Fact:
    """Differentiate by H at fixed A; A grows with H too."""
    height = sp.Symbol("H", positive=True)
    other = sp.Symbol("A", positive=True)
    slope = ((other + m * height**2 + m * R**2) / (m * g * R)).diff(height)
    grows = "longer" if slope.is_positive else "not longer"
    return Fact(
        printed="longer",
        holds=lambda word: word == grows,
        how="sympy: the square of T grows with H",
    )


@check("caption:repulsion")
def repulsive_term() -> Fact:
    """Find which coefficient has the largest part in the slope of H close to phi = 0."""
    values = reduced_of(release.bounce().problem)
    x = float(release.bounce().bounces[0].phi_min) / 10
    parts = {
        f"a_{name}": abs(getattr(values, f"a_{name}") * np.log(x) ** logs / x**power)
        for name, (power, logs) in POWERS.items()
    }
    return Fact(
        printed="a_3",
        holds=lambda name: max(parts, key=parts.__getitem__) == name,
        how=f"at a tenth of phi_min a_3/phi^3 is {parts['a_3'] / sum(parts.values()):.0%} of the "
        "slope",
    )


@check("text:symmetry of the contours")
def symmetry_of_the_contours() -> IdentityEvidence:
    """Turn the sign of a momentum."""
    return IdentityEvidence(
        printed=-Phi,
        compared=lambda mirrored: PRINTED.subs(Phi, mirrored),
        derived=PRINTED,
        source="the Hamiltonian itself",
    )


@check("text:centre of the portrait")
def centre_of_the_portrait() -> Fact:
    """Compare with the exact steady motion of the same constants."""
    reduced = reduced_of(release.bounce().problem)
    with mp.workdps(30):
        zero, two = exact_constants()
        guess = mp.cbrt(two**2 * paper_can.a_p)  # a_3/phi^3 = 1

        def exact(x: mp.mpf) -> mp.mpf:
            return flat_motion.drive(x, zero, two) - mp.cos(x) + paper_can.h * mp.sin(x)

        steady = mp.findroot(exact, (guess / 3, 3 * guess), solver="anderson")
    found = brentq(reduced.force, float(guess) / 3, 3 * float(guess))
    rests = {"steady": steady, "reduced": found, "phi*": mp.atan(1 / paper_can.h)}
    return Fact(
        printed="steady",
        holds=lambda name: bool(abs(rests["reduced"] / rests[name] - 1) < mp.mpf("1e-3")),
        how=f"reduced equation: phi = {mp.nstr(rests['reduced'], 6)}; exact steady motion with the "
        f"same B_0 and B_-2: {mp.nstr(rests['steady'], 6)}",
    )


@check("caption:fig01:hamiltonian_contours")
def contours_exist() -> Fact:
    """Compare the lowest point of the Hamiltonian with the lowest contour."""
    energies = (7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3)

    def lowest(zero: float, two: float) -> float:
        reduced = reduced_equation(PAPER_CAN, zero, two)
        return float(reduced.potential(np.geomspace(1e-5, 1e-2, 4000)).min())

    least = lowest(*(float(x) for x in exact_constants()))
    two = math.sqrt(1.43e-10)
    return Fact(
        printed=energies,
        holds=lambda said: min(said) > least,
        how="the Hamiltonian of the release, with its exact B_0 and B_-2, is at least "
        f"{least:.3e}; with the eps and zeta printed in section 4.3 it would be at least "
        f"{lowest(0.40 * two, two):.3e}, above the lowest two contours, see text:eps",
    )
