"""How well the paper's approximations meet what they approximate, at the paper's release."""

import math
from functools import cache

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper.audit import paper_can, release
from harness.paper.audit.checks.equilibria import at_balance
from harness.paper.audit.claims import ClaimStatus
from harness.paper.audit.evidence import (
    Both,
    Fact,
    IdentityEvidence,
    Rate,
    check,
    check_each,
    mutated,
)
from harness.paper.audit.newton_euler import centre_velocity, papers_accelerations, rate
from harness.paper.audit.symbols import (
    Expr,
    I,
    Phi,
    Psi,
    Theta,
    a,
    eps,
    h,
    phi_dd,
    psi_dd,
    theta_dd,
)
from reference import PAPER_CAN, Problem, solve
from reference.asymptotic.expansions import expansions
from reference.asymptotic.matched import boundary_rotation
from reference.asymptotic.small_nutation import reduced_equation, reduced_of

HEIGHT = math.pi / 100
STEEP = (1e-8, 1e-10)
"""Values of eps between which a rate is observed."""
t, letter = sp.symbols("t a_p", positive=True)
AGREES = 0.02
"""Two curves closer than this share of the plot's height are one to the eye."""


@cache
def _posed(epsilon: float, zeta: float = 0.4) -> Problem:
    """Return the release at pi/100 with given constants."""
    known, at, two = expansions(PAPER_CAN), np.array([HEIGHT]), math.sqrt(epsilon)
    pairs = ((known.psi_zero, known.psi_minus_two), (known.spin_zero, known.spin_minus_two))
    rate, spin = (two * (zeta * float(x.at(at)[0]) + float(y.at(at)[0])) for x, y in pairs)
    return Problem(parameters=PAPER_CAN, phi=HEIGHT, psi_dot=rate, theta_dot=spin - rate, bounces=1)


@cache
def _truth(epsilon: float) -> "tuple[np.ndarray, np.ndarray]":
    """Return the reduced equation's nutations before the bounce and the times they are met."""
    posed = _posed(epsilon)
    bounce_time = math.sqrt(2 * HEIGHT)
    tau = bounce_time - np.geomspace(math.sqrt(epsilon) / 10, bounce_time, 300)
    truth = solve(posed, model="reduced").at(tau * math.sqrt(PAPER_CAN.pendulum_inertia))
    return tau, truth.phi


def _error(form: Expr, epsilon: float) -> float:
    """Largest error of a form of phi(t) against the reduced equation, up to the bounce."""
    tau, phi = _truth(epsilon)
    value = sp.lambdify((eps, letter, I, t), form, "numpy")
    return float(np.abs(value(epsilon, PAPER_CAN.a_p, 2 * HEIGHT, tau) - phi).max())


@check("text:matched agreement")
def matched_agreement() -> Rate:
    """Largest error before the bounce: it is to fall as no form that is wrong at eps^(1/2) does."""
    gap = sp.sqrt(I) - t
    inner = sp.sqrt(eps * letter / I + I * gap**2)
    return Rate(
        printed=inner - gap**2 / 2,
        remainder=lambda form: lambda small: mp.mpf(_error(form, float(small))),
        others=(
            sp.sqrt(eps * (letter + 1) / I + I * gap**2) - gap**2 / 2,
            sp.sqrt(eps * letter / I**2 + I * gap**2) - gap**2 / 2,
            inner + gap**2 / 2,
            (I - t**2) / 2,
        ),
        stated=1,
        at=STEEP,
        source="the reduced equation with zeta = 0.4, the largest error of phi before the bounce "
        f"({_error(inner - gap**2 / 2, STEEP[0]):.2e} at eps = 1e-8)",
    )


@cache
def _peak(epsilon: float, zeta: float) -> float:
    """Return the exact peak of the friction ratio."""
    return solve(_posed(epsilon, zeta)).bounces[0].peak_friction_ratio


@check_each({"text:bound approached": (0.4,), "text:higher order": (-1.0, 0.4, 2.0)})
def bound_approached(*zetas: float) -> Rate:
    """Exact peaks for two values of eps, and for releases with several zeta."""
    can = {a: PAPER_CAN.a, h: PAPER_CAN.h}

    def remainder(bound: Expr) -> "sp.Lambda":
        value = float(bound.subs(can))
        return lambda small: mp.mpf(max(abs(_peak(float(small), z) - value) for z in zetas))

    return Rate(
        printed=h / (a + h**2),
        remainder=remainder,
        others=(*mutated(h / (a + h**2)), h / (a + h**2 + 1)),
        stated=1 / 2,
        at=STEEP,
        source="the exact peaks, which approach it, for zeta = " + ", ".join(map(str, zetas)),
    )


@check("text:no balance")
def no_balance() -> Fact:
    """Follow the reduced force to where the exact one changes its sign."""
    equation = reduced_of(release.bounce().problem)
    beyond = np.linspace(0.01, math.pi / 2, 2000)
    zeros = int(np.count_nonzero(np.diff(np.sign(equation.force(beyond)))))
    return Fact(
        printed=0,
        holds=lambda count: count == zeros,
        others=(1, 2),
        how=f"reduced phi'' from 0.01 to pi/2 is at most {equation.force(beyond).max():.3f}, and "
        f"vanishes {zeros} times",
    )


@check("text:eps as mediator")
def sharper_bounces() -> Fact:
    """Peak rates and smallest nutations of the paper's three values, zeta = 1."""
    printed = (4e-6, 6.4e-7, 1e-8)
    found = {e: solve(_posed(e, 1.0), model="reduced").bounces[0] for e in printed}

    def sharpens(order: tuple[float, ...]) -> bool:
        low, peak = [found[e].phi_min for e in order], [found[e].peak_psi_dot for e in order]
        return low == sorted(low, reverse=True) and peak == sorted(peak)

    told = ", ".join(f"{b.phi_min:.2e} rad and {b.peak_psi_dot:.1f}" for b in found.values())
    return Fact(
        printed=printed,
        holds=sharpens,
        others=(printed[::-1], (printed[1], printed[0], printed[2])),
        how=f"phi_min and peak psi' for eps = 4e-6, 6.4e-7, 1e-8: {told}",
    )


@check("text:straight rolling")
def straight_rolling() -> Both:
    """Speed of the centre, how fast its direction turns, and that the motion is steady."""
    rates = papers_accelerations()
    steady = {Phi: 0, phi_dd: 0, psi_dd: 0, theta_dd: 0}
    velocity = centre_velocity().subs({Phi: 0, Psi: 0})

    def left(precession: Expr) -> Expr:
        moving = centre_velocity()
        turning = moving[0] * rate(moving)[1] - moving[1] * rate(moving)[0]
        parts = [rates[psi_dd], rates[theta_dd], turning.subs(steady)]
        still = [x.subs({Phi: 0, Psi: precession}) for x in parts]
        return sp.Matrix([at_balance(rates[phi_dd]).subs({Phi: 0, Psi: precession}), *still])

    return Both(
        parts=(
            IdentityEvidence(
                printed=Theta**2, derived=sp.simplify(velocity.dot(velocity)), source="rolling"
            ),
            IdentityEvidence(
                printed=sp.Integer(0),  # Psi
                compared=left,
                derived=sp.zeros(4, 1),
                source="the equations of motion and the turning of the velocity",
            ),
        )
    )


@check("caption:fig01:hamiltonian_contours")
def contours_exist() -> Fact:
    """Compare the lowest point of the Hamiltonian with the lowest contour."""
    energies = (7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3)

    def lowest(constants: tuple[float, float]) -> float:
        epsilon, zeta = constants
        two = math.sqrt(epsilon)
        reduced = reduced_equation(PAPER_CAN, zeta * two, two)
        return float(reduced.potential(np.geomspace(1e-5, 1e-2, 4000)).min())

    printed, right = (1.43e-10, 0.40), (3.7628e-11, 0.66886)
    return Fact(
        printed=(printed, energies),
        corrected=(right, energies),
        holds=lambda said: min(said[1]) > lowest(said[0]),
        others=((printed, energies), (right, (7e-4, *energies[1:])), ((1e-10, 0.67), energies)),
        how=f"the Hamiltonian is at least {lowest(printed):.3e} with the printed eps and zeta, and "
        f"{lowest(right):.3e} with those of the release",
        wrong=ClaimStatus.INCONSISTENT,
    )


@check("caption:fig01:contact_pt_motion")
def cusps_near_the_boundary() -> Fact:
    """Compare the ratio of the rates with the line; theta' has to change its sign."""
    scale = float(paper_can.SECOND)
    posed = Problem(
        parameters=PAPER_CAN, phi=HEIGHT, psi_dot=1.7267 * scale, theta_dot=7 * scale, bounces=3
    )
    solution = solve(posed)
    rates = solution.at(solution.grid()).theta_dot
    ratio = 7 / 1.7267
    line = boundary_rotation(PAPER_CAN, 1.0)
    reverses = bool(rates.min() < 0 < rates.max())
    return Fact(
        printed=(1.7267, 7),
        holds=lambda pair: abs(pair[1] / pair[0] / line - 1) < AGREES and reverses,
        others=((0.72667, 7), (1.7267, -7), (1.7267, 7.2)),
        how=f"theta'/psi' = {ratio:.4f}, the line has {line:.4f}; theta' runs from "
        f"{rates.min():.3g} to {rates.max():.3g} sqrt(g/R) over three bounces",
    )
