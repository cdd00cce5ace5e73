"""Sections 2 and 6.3: what the printed numbers of the can and of the release are numbers of."""

import math

import sympy as sp

from harness.paper.audit.evidence import Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import ARM
from harness.paper.audit.symbols import H, R
from reference import Parameters, Problem, solve

DISK = Parameters(a=0.25, c=0.5, h=1e-3)
"""A uniform disk a thousandth as thick as wide: the largest turn of a uniform cylinder."""


LOW = math.pi / 1000
"""Nutation of release: the friction that the fall asks for is in proportion to it."""


@check("text:height of the can")
def height_of_the_can() -> IdentityEvidence:
    """Twice the height of the centre over the bottom: the contact point is H below the centre."""
    return IdentityEvidence(
        printed=H,
        corrected=2 * H,
        derived=-2 * ARM[2] * R,
        source="GP^B, with the centre halfway up",
    )


def _disk_peak(rate: float) -> tuple[float, float]:
    """Return turn in degrees and largest friction ratio of a thin disk's bounce."""
    posed = Problem(parameters=DISK, phi=LOW, psi_dot=rate, theta_dot=-rate, bounces=1)
    bounce = solve(posed).bounces[0]
    return math.degrees(abs(bounce.angle_of_turn)), bounce.peak_friction_ratio


@check("text:small a_p and friction")
def friction_of_small_inertias() -> Fact:
    """Let a_p = a + h^2 fall to 0 in two ways, and compute the bounce of a thin disk."""
    a, h = sp.symbols("a h", positive=True)
    ratio = h / (a + h**2)
    turn, friction = _disk_peak(0.005)
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
        others=said[:2],
        holds=true.__getitem__,
        how=f"sympy: as a_p -> 0, h/a_p -> {thick} with a = h^2 and {thin} with a = sqrt(h); "
        f"h <= sqrt(a_p); exact bounce of a uniform thin disk released at pi/1000: turn {turn:.1f} "
        f"degrees, largest |F|/N {friction:.3f}",
    )
