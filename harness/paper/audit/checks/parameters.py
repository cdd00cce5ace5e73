"""Sections 2 and 6.3: what the printed numbers of the can and of the release are numbers of."""

import math

import sympy as sp

from harness.paper.audit import paper_can
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence
from harness.paper.audit.newton_euler import ARM
from harness.paper.audit.registry import claim
from harness.paper.audit.symbols import H, R
from reference import Parameters, Problem, solve

DISK = Parameters(a=0.25, c=0.5, h=1e-3)
"""A uniform disk a thousandth as thick as wide: the largest turn of a uniform cylinder."""


LOW = math.pi / 1000
"""Nutation of release: the friction that the fall asks for is in proportion to it."""


@claim("text:height of the can", "2", "height H = 5.45e-2 m")
def height_of_the_can() -> IdentityEvidence:
    """Twice the height of the centre over the bottom: the contact point is H below the centre."""
    return IdentityEvidence(
        printed=H,
        corrected=2 * H,
        derived=-2 * ARM[2] * R,
        correct="half-height H = 5.45e-2 m: the cylinder of section 2 has height 2H, GP = "
        "(-R, 0, -H), and h = 1.473 is 5.45/3.70",
        source="GP^B, with the centre halfway up",
    )


@claim(
    "text:unit of the release",
    "2",
    "the rates 0.1001 and -0.1000 of the release are in scaled time, as dots are from (2.13) on",
)
def unit_of_the_release() -> Fact:
    """Compute the peak rate of the bounce with the rates in either unit."""
    second = float(paper_can.SECOND)

    def peak(unit: float) -> float:
        """Return the largest dpsi/dt in sqrt(g/R)."""
        posed = Problem(
            parameters=Parameters(a=0.727, c=0.615, h=1.473),
            phi=math.pi / 100,
            psi_dot=0.1001 * unit,
            theta_dot=-0.1 * unit,
            bounces=1,
        )
        return solve(posed).bounces[0].peak_psi_dot

    scaled, unscaled = peak(1.0), peak(second)
    units = {"sqrt(g/R)": scaled, "rad/s": unscaled}
    return Fact(
        printed="sqrt(g/R)",
        corrected="rad/s",
        others=("sqrt(g/R)",),
        holds=lambda unit: round(units[unit]) in {3449, 3575},
        how=f"exact peak of dpsi/dt {unscaled:.1f} sqrt(g/R) with the rates in rad/s and "
        f"{scaled:.1f} with them in sqrt(g/R); the paper prints 3575 and 3449",
        correct="they are in rad/s, as only the caption of fig01:contact_pt_motion says: in "
        "scaled time the release is (0, 0.006148, pi/100, 0, 0, -0.006141)",
    )


def _disk_peak(rate: float) -> tuple[float, float]:
    """Return turn in degrees and largest friction ratio of a thin disk's bounce."""
    posed = Problem(parameters=DISK, phi=LOW, psi_dot=rate, theta_dot=-rate, bounces=1)
    bounce = solve(posed).bounces[0]
    return math.degrees(abs(bounce.angle_of_turn)), bounce.peak_friction_ratio


@claim(
    "text:small a_p and friction",
    "6.3",
    "a small a_p results in a large coefficient of friction, so large turns are infeasible",
)
def friction_of_small_inertias() -> Both:
    """Let a_p = a + h^2 fall to 0 in two ways, and compute the bounce of a thin disk."""
    a, h = sp.symbols("a h", positive=True)
    ratio = h / (a + h**2)
    turn, friction = _disk_peak(0.005)
    thick, thin = (sp.limit(ratio.subs(a, h**n), h, 0) for n in (2, sp.Rational(1, 2)))
    return Both(
        parts=(
            Fact(
                printed="large for every small a_p",
                corrected="at most 1/sqrt(a_p)",
                others=("large for every small a_p", "small for every small a_p"),
                holds=lambda said: {
                    "large for every small a_p": thick == thin == sp.oo,
                    "small for every small a_p": thick == thin == 0,
                    # h/a_p <= 1/sqrt(a_p) where h^2 <= a_p
                    "at most 1/sqrt(a_p)": sp.expand(1 / ratio * h - h**2).is_positive,
                }[said],
                how=f"sympy: as a_p -> 0, h/a_p -> {thick} with a = h^2 and {thin} with "
                "a = sqrt(h); h <= sqrt(a_p)",
                correct="h/a_p lies between 0 and 1/sqrt(a_p): a thin disk (h = 0) has a large "
                "turn and needs no friction to leading order, 402 degrees if it is uniform",
            ),
            Fact(
                printed=402,
                others=(209, 360),
                holds=lambda degrees: abs(turn - degrees) < 1 and friction < 0.1,  # noqa: PLR2004
                how=f"exact bounce of a uniform thin disk released at pi/1000: turn {turn:.1f} "
                f"degrees, largest |F|/N {friction:.3f}",
            ),
        )
    )
