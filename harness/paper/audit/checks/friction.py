"""Section 6.3: the friction that rolling asks for."""

import math
from functools import cache

import mpmath as mp
import sympy as sp

from harness.paper import release
from harness.paper.audit import paper_can
from harness.paper.audit.claims import ClaimStatus
from harness.paper.audit.evidence import (
    Both,
    Fact,
    IdentityEvidence,
    Number,
    Rate,
    check,
    check_each,
)
from harness.paper.audit.newton_euler import contact_force, turn_z
from harness.paper.audit.symbols import A, Expr, H, R, a, a_p, h, m, psi
from reference import PAPER_CAN, Parameters, Problem, solve
from reference.equations.reaction_force import friction_ratio as ratio_of
from reference.problem.states import initial_states


@check("eq01:friction_short")
def friction_ratio() -> IdentityEvidence:
    """Insert the force in G; compare its square with that of the force in I, without psi."""
    letters = sp.symbols("F_x F_y N")
    force = contact_force()
    seen = (turn_z(psi).T * force).subs(psi, 0)
    return IdentityEvidence(
        printed=(letters[0] ** 2 + letters[1] ** 2) / letters[2] ** 2,
        compared=lambda square: square.subs(dict(zip(letters, force, strict=True))) * force[2] ** 2,
        derived=seen[0] ** 2 + seen[1] ** 2,
        source="the force along and across the lean of the can, the square times N^2",
    )


@check("eq01:required_friction")
def required_friction() -> Both:
    """Leading terms for Psi = B/phi^2; and with letters."""
    y, b = sp.symbols("y b", positive=True)
    # eq01:Phi, L and N for small phi: the terms in B_-2^2/phi^3 and B_-2^2/phi^3 alone
    bend = a_p * b**2 / ((a_p + 1) * y**3)
    forward = -h * bend + h * y * (b / y**2) ** 2
    return Both(
        IdentityEvidence(
            printed=h / a_p, derived=sp.simplify(forward / bend), source="eq01:Phi and L"
        ),
        IdentityEvidence(
            printed=m * R * H / (A + m * H**2), derived=h / a_p, source="eq01:scalings"
        ),
    )


@check("text:peak friction")
def peak_friction() -> Number:
    """Take the largest ratio of the exact motion."""
    return Number(
        printed="0.508",
        value=release.bounce().bounces[0].peak_friction_ratio,
        source="exact motion",
    )


@check("text:predicted friction")
def predicted_friction() -> Number:
    """h/a_p from the printed groups, which are rounded."""
    low, high = paper_can.reach(lambda h_, a_: h_ / a_, "1.473", "2.897")
    return Number(
        printed="0.508",
        value=mp.mpf("1.473") / mp.mpf("2.897"),
        low=low,
        high=high,
        source="h/a_p with the printed a_p = 2.897",
    )


@check("text:friction in short")
def friction_in_short() -> Number:
    """Two digits."""
    return Number(
        printed="0.51", value=release.bounce().bounces[0].peak_friction_ratio, source="exact motion"
    )


@check("text:uniform cylinder")
def uniform_cylinder() -> IdentityEvidence:
    """Integrate the moment of inertia of a cylinder of height 2 H."""
    r, angle, z = sp.symbols("r alpha z", positive=True)
    volume = 2 * sp.pi * h
    lever = ((r * sp.sin(angle)) ** 2 + z**2) * r
    moment = sp.integrate(lever, (r, 0, 1), (angle, 0, 2 * sp.pi), (z, -h, h)) / volume
    return IdentityEvidence(
        printed=12 * h / (3 + 13 * h**2),
        corrected=12 * h / (3 + 16 * h**2),
        derived=sp.simplify(h / (moment + h**2)),
        source="the moment of inertia of a cylinder of height 2 H, integrated",
    )


@check("text:largest friction")
def largest_friction() -> Number:
    """Find the maximum of the mended form; of the printed form it is 0.96."""
    forms = [12 * h / (3 + n * h**2) for n in (16, 13)]
    values = [form.subs(h, sp.solve(form.diff(h), h)[0]) for form in forms]
    return Number(
        printed="0.96",
        value=mp.mpmathify(sp.N(values[0], 30)),
        source="maximum of 12 h/(3 + 16 h^2)",
        also=f"that is sqrt(3)/2; the printed form has {sp.N(values[1], 4)}",
        wrong=ClaimStatus.FALSE,
    )


@check("text:height of largest friction")
def height_of_largest_friction() -> Number:
    """Where the mended form is largest."""
    found = sp.solve((12 * h / (3 + 16 * h**2)).diff(h), h)
    return Number(
        printed="0.48",
        value=mp.mpmathify(sp.N(found[0], 30)),
        source="maximum of 12 h/(3 + 16 h^2)",
        also="that is sqrt(3)/4",
        wrong=ClaimStatus.FALSE,
    )


@cache
def _peak(epsilon: float, zeta: float) -> float:
    """Return the exact peak of the friction ratio."""
    return (
        release.solved(release.of_constants(epsilon, zeta, bounces=1))
        .bounces[0]
        .peak_friction_ratio
    )


@check_each({"text:bound approached": (0.4,), "text:higher order": (-1.0, 0.4, 2.0)})
def bound_approached(*zetas: float) -> Rate:
    """Exact peaks for two values of eps, and for releases with several zeta."""
    can = {a: PAPER_CAN.a, h: PAPER_CAN.h}

    def remainder(bound: Expr, small: mp.mpf) -> mp.mpf:
        value = float(bound.subs(can))
        return mp.mpf(max(abs(_peak(float(small), zeta) - value) for zeta in zetas))

    return Rate(
        printed=h / (a + h**2),
        remainder=remainder,
        stated=1 / 2,
        at=release.STEEP,
        source="the exact peaks, which approach it, for zeta = " + ", ".join(map(str, zetas)),
    )


@check("text:outer friction")
def friction_of_the_outer_region() -> Fact:
    """Largest ratios of the exact release on either side of phi_0/10."""
    solution = release.bounce()
    states = solution.at(solution.grid())
    outside = states.phi >= release.INNER * release.PHI
    outer = float(ratio_of(states, PAPER_CAN)[outside].max())
    inner = solution.bounces[0].peak_friction_ratio
    largest = {"outer": outer, "inner": inner}
    return Fact(
        printed=("outer", "inner"),
        holds=lambda order: largest[order[0]] < largest[order[1]],
        how=f"exact: {outer:.4f} for phi > phi_0/10 and {inner:.4f} below: falling freely near "
        "phi = 0 asks for h/a_p too",
    )


@check("text:fast release")
def friction_of_a_fast_release() -> Fact:
    """Ratio that a release at pi/100 asks for at once, with the can pushed downwards."""

    def outer_less(push: float) -> bool:
        start = initial_states(release.problem(phi_dot=push / release.SECOND, bounces=1))
        return float(ratio_of(start, PAPER_CAN).max()) < PAPER_CAN.h / PAPER_CAN.a_p

    pushes = {"none": 0.0, "small": -0.3, "large": -0.7}
    return Fact(
        printed="large",
        holds=lambda size: not outer_less(pushes[size]),
        how="exact: with phi' = -0.7 sqrt(g/R) at pi/100, shortly before the can would lift off, "
        "the release itself asks for more than h/a_p; from rest, and at -0.3, for less",
    )


DISK = Parameters(a=0.25, c=0.5, h=1e-3)
"""A uniform disk a thousandth as thick as wide: the largest turn of a uniform cylinder."""
LOW = math.pi / 1000
"""Nutation of release: the friction that the fall asks for is in proportion to it."""
RATES = (0.1, 0.05, 0.01, 0.005, 0.001)
"""Precessions at release, in sqrt(g/R), on which the friction at pi/100 depends."""
LOW_RATE = 0.005
"""Precession of the release at LOW, in sqrt(g/R)."""


@cache
def disk_bounce(rate: float, phi: float) -> tuple[float, float]:
    """Return turn in degrees and largest friction ratio of a thin disk's bounce."""
    posed = Problem(parameters=DISK, phi=phi, psi_dot=rate, theta_dot=-rate, bounces=1)
    bounce = solve(posed).bounces[0]
    return math.degrees(abs(bounce.angle_of_turn)), bounce.peak_friction_ratio


@check("text:small a_p and friction")
def friction_of_small_inertias() -> Fact:
    """Let a_p = a + h^2 fall to 0 in two ways, and compute the bounce of a thin disk."""
    a, h = sp.symbols("a h", positive=True)
    ratio = h / (a + h**2)
    turn, friction = disk_bounce(LOW_RATE, LOW)
    thick, thin = (sp.limit(ratio.subs(a, h**n), h, 0) for n in (2, sp.Rational(1, 2)))
    said = ("large for every small a_p", "small for every small a_p", "at most 1/sqrt(a_p)")
    true = {
        said[0]: thick == thin == sp.oo,
        said[1]: thick == thin == 0,
        # h/a_p <= 1/sqrt(a_p) where h^2 <= a_p
        said[2]: bool(sp.expand(1 / ratio * h - h**2).is_positive),
    }
    return Fact(
        printed=said[0],
        corrected=said[2],
        holds=true.__getitem__,
        how=f"sympy: as a_p -> 0, h/a_p -> {thick} with a = h^2 and {thin} with a = sqrt(h); "
        f"h <= sqrt(a_p); exact bounce of a uniform thin disk released at pi/1000 with "
        f"{LOW_RATE:g} sqrt(g/R): turn {turn:.1f} degrees, largest |F|/N "
        f"{friction:.3f}; at pi/100 with psi' = -theta' of {RATES[0]:g} to {RATES[-1]:g} "
        f"sqrt(g/R) |F|/N is at most "
        + ", ".join(f"{disk_bounce(rate, release.PHI)[1]:.3f}" for rate in RATES),
    )
