"""Appendix E: what the text reads off the phase portrait."""

from functools import cache

import mpmath as mp
from scipy.optimize import brentq

from harness.paper.audit import flat_motion, paper_can, release
from harness.paper.audit.checks.hamiltonian import PRINTED
from harness.paper.audit.checks.numbers import exact_constants
from harness.paper.audit.evidence import Fact, IdentityEvidence, check
from harness.paper.audit.symbols import Phi, phi
from reference.asymptotic.small_nutation import reduced_of


@check("text:symmetry of the contours")
def symmetry_of_the_contours() -> IdentityEvidence:
    """Turn the sign of a momentum."""
    return IdentityEvidence(
        printed=-Phi,
        compared=lambda mirrored: PRINTED.subs(Phi, mirrored),
        derived=PRINTED,
        others=(-2 * Phi, 1 - Phi, Phi + phi),
        source="the Hamiltonian itself",
    )


@cache
def _rests() -> dict[str, mp.mpf]:
    """Return where the reduced force and the exact one vanish, at the release's constants."""
    reduced = reduced_of(release.bounce().problem)
    with mp.workdps(30):
        zero, two = exact_constants()
        guess = mp.cbrt(two**2 * paper_can.a_p)  # a_3/phi^3 = 1

        def exact(x: mp.mpf) -> mp.mpf:
            return flat_motion.drive(x, zero, two) - mp.cos(x) + paper_can.h * mp.sin(x)

        steady = mp.findroot(exact, (guess / 3, 3 * guess), solver="anderson")
    found = brentq(reduced.force, float(guess) / 3, 3 * float(guess))
    return {"steady": steady, "reduced": found, "phi*": mp.atan(1 / paper_can.h)}


@check("text:centre of the portrait")
def centre_of_the_portrait() -> Fact:
    """Compare with the exact steady motion of the same constants."""
    rests = _rests()
    return Fact(
        printed="steady",
        others=("phi*",),
        holds=lambda name: bool(abs(rests["reduced"] / rests[name] - 1) < mp.mpf("1e-3")),
        how=f"reduced equation: phi = {mp.nstr(rests['reduced'], 6)}; exact steady motion with the "
        f"same B_0 and B_-2: {mp.nstr(rests['steady'], 6)}",
    )
