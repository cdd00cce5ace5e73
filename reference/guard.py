"""Whether a solution keeps to what its model assumes: a rim that is pushed at one point.

A model does not know where it ends. Rolling without slipping takes whatever force it needs, were it
a pull; every model takes the contact to be one point of the rim, however near the far rim is to the
plane. Here the motion is looked at again, and each assumption that it breaks is said.
"""

from dataclasses import dataclass

import numpy as np

from reference.contact import contact_force_in_world
from reference.outcome import Outcome
from reference.solution import Solution
from reference.states import Floats

# The friction that few pairs of materials exceed.
PLENTY = 1.0
# Height of the far rim over R that no can has: below an atom's 1e-10 m for a radius of 0.1 m.
ATOM = 1e-9
ENDINGS = {
    Outcome.OVERTURNED,
    Outcome.FELL_FLAT,
    Outcome.LIFTED,
    Outcome.JAMMED,
    Outcome.OUTWORKED,
    Outcome.STALLED,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """An assumption that a motion breaks.

    Attributes
    ----------
    sentence : str
    model : str
        The reference model that would carry it; empty if none does.
    """

    sentence: str
    model: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Guard:
    """What the assumptions of a model came to, over a whole motion.

    Attributes
    ----------
    friction_ratio : float
        Largest |F|/N: of a rim that never slips the friction that it needs; infinite where N is not
        positive.
    normal_force : float
        The least, in m g.
    phi_min, phi_max : float
    gap : float
        Least height of the far rim above the plane, in R.
    findings : tuple of Finding
    """

    friction_ratio: float
    normal_force: float
    phi_min: float
    phi_max: float
    gap: float
    findings: tuple[Finding, ...]


def examine(solution: Solution, times: Floats) -> Guard:
    """Look at a solution again at the given times, dense by angle, shape (n,)."""
    states = solution.at(times)
    parameters = solution.problem.parameters
    normal = contact_force_in_world(states, parameters)[:, 2]
    peaks = [bounce.peak_friction_ratio for bounce in solution.bounces]
    friction = np.hypot(*contact_force_in_world(states, parameters)[:, :2].T)
    ratio = np.divide(friction, normal, out=np.full_like(normal, np.inf), where=normal > 0)
    found = Guard(
        friction_ratio=float(max([ratio.max(), *peaks])),
        normal_force=float(normal.min()),
        phi_min=float(states.phi.min()),
        phi_max=float(states.phi.max()),
        gap=float(2 * np.sin(states.phi.min())),
        findings=(),
    )
    return Guard(
        friction_ratio=found.friction_ratio,
        normal_force=found.normal_force,
        phi_min=found.phi_min,
        phi_max=found.phi_max,
        gap=found.gap,
        findings=tuple(_findings(solution, found)),
    )


def _findings(solution: Solution, found: Guard) -> list[Finding]:
    findings = []
    never_slips = solution.problem.effects.mu is None
    if solution.outcome in ENDINGS:
        findings.append(Finding(sentence=solution.outcome.value))
    if never_slips and found.normal_force <= 0:
        findings.append(
            Finding(
                sentence=(
                    f"Rolling asks the plane to pull, with up to {-found.normal_force:.4g} m g: "
                    "a can that is only pushed lifts off."
                ),
                model="",
            )
        )
    elif never_slips and found.friction_ratio > PLENTY:
        findings.append(
            Finding(
                sentence=(
                    f"Rolling needs a friction of {found.friction_ratio:.4g}, which few pairs "
                    "have: with less the rim slips, and the scene should declare it."
                ),
                model="coulomb" if not solution.problem.effects.declared() else "general",
            )
        )
    if found.gap < ATOM and solution.outcome is not Outcome.FELL_FLAT:
        findings.append(
            Finding(
                sentence=(
                    f"The far rim comes within {found.gap:.2g} R of the plane, less than an atom: "
                    "a real can touches it with more than one point."
                ),
                model="",
            )
        )
    return findings
