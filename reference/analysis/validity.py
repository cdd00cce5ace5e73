"""Validity of a solution: whether the plane pushes the rim, and at one point.

A model does not check its assumptions. Rolling without slipping takes any force that it needs, even
a pull; every model takes the contact to be one point of the rim, however near the far rim is to the
plane. This module examines a motion and reports each assumption that it breaks.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from reference.analysis.coming_to_rest import FLAT, is_regular
from reference.equations.reaction_force import contact_force_in_world, ratio_of
from reference.problem.outcome import Outcome
from reference.problem.states import Floats, States
from reference.solution import Solution

# The friction that few pairs of materials exceed.
PLENTY = 1.0
# Height of the far rim over R that no can has: below an atom's 1e-10 m for a radius of 0.1 m.
ATOM = 1e-9
# Where rigid contact with friction has no motion that follows, or several (Painleve).
PARADOXES = {Outcome.INCONSISTENT, Outcome.INDETERMINATE, Outcome.JAMMED}
# Of the weight: a normal force below this is that of a can about to lift off.
LIGHT = 1e-3
# Of the weight, or of the largest friction if that is more: what is held lets go 2e-9 beyond its
# cone (`reference.nonsmooth.slip_onset.BEYOND`), and a friction of large terms has their round-off.
BESIDE_CONE = 1e-8
# What a can does next that is no longer touching at one point of its rim.
ENDINGS = {Outcome.OVERTURNED, Outcome.FELL_FLAT, Outcome.LIFTED, *PARADOXES}
# A solver's own limits.
LIMITS = {Outcome.OUTWORKED, Outcome.VIBRATES, Outcome.STALLED, Outcome.UNRESOLVED}
NONE_CARRIES = "No reference model carries it."
UNILATERAL_CARRIES = "Declare restitution, be it 0: `unilateral` carries it."
# Where a contact that only pushes is lost, met with the whole face, or drives its rim into itself.
LEAVES_THE_POINT = {Outcome.LIFTED, Outcome.FELL_FLAT, Outcome.JAMMED}


class FindingKind(Enum):
    """What a finding is about."""

    REFUSED = "the reference does not carry the scene"
    DISAGREEMENT = "two methods part by more than round-off"
    ENDING = "the can no longer touches at one point of its rim"
    LIMIT = "the solver came to a limit of its own"
    PULL = "the plane would have to pull"
    FRICTION = "rolling needs more friction than few pairs have"
    FAR_RIM = "the far rim all but touches"
    CONE = "the rim sticks with more friction than there is"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """An assumption that a motion breaks.

    Attributes
    ----------
    kind : FindingKind
    sentence : str
    model : str
        The larger reference model that would carry it; empty if none does, or one does with
        another effect declared, as the sentence then says.
    """

    kind: FindingKind
    sentence: str
    model: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Guard:
    """Extremes over a motion of the quantities that its model makes assumptions about.

    Attributes
    ----------
    friction_ratio : float
        Largest |F|/N: of a rim that never slips the friction that it needs; infinite where N is not
        positive. Of a can that may leave the plane, outside its whole bounces, at instants with N
        of a thousandth of the weight or more: at lift-off N is zero, and |F|/N is no friction that
        a pair of materials could have, or the quotient of two round-offs. Zero where there is no
        such instant.
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
    """Examine a solution at the given times, dense by angle, shape (n,)."""
    states = solution.at(times)
    parameters = solution.problem.parameters
    force = contact_force_in_world(states, parameters).T
    friction, normal = np.hypot(*force[:2]), force[2]
    peaks = [bounce.peak_friction_ratio for bounce in solution.bounces]
    ratio, pressed = ratio_of(force), normal
    if states.gap is not None and solution.problem.effects.compliance is None:
        # in the air there is neither force nor friction
        touches = states.gap == 0
        ratio, pressed = ratio[touches & (normal > LIGHT)], normal[touches]
    elif solution.outcome is Outcome.LIFTED:
        ratio = ratio[normal >= LIGHT]
    guard = Guard(
        friction_ratio=float(max([*ratio, *peaks], default=0.0)),
        normal_force=float(pressed.min(initial=np.inf)) if pressed.size else 0.0,
        phi_min=float(states.phi.min()),
        phi_max=float(states.phi.max()),
        gap=_far_rim(states),
        findings=(),
    )
    return Guard(
        friction_ratio=guard.friction_ratio,
        normal_force=guard.normal_force,
        phi_min=guard.phi_min,
        phi_max=guard.phi_max,
        gap=guard.gap,
        findings=(*_findings(solution, guard), *_beyond_cone(solution, states, friction, normal)),
    )


def _far_rim(states: States) -> float:
    """Return the least height of the far rim above the plane, in R, shape (n,)."""
    gap = 0.0 if states.gap is None else states.gap
    return float((2 * np.sin(states.phi) + gap).min())


def _beyond_cone(
    solution: Solution, states: States, friction: Floats, normal: Floats
) -> list[Finding]:
    """Return the finding that a rim sticks with too little friction: the solution is wrong."""
    effects = solution.problem.effects
    mu = effects.mu if effects.mu_static is None else effects.mu_static
    # of what ends where it begins the release is all there is, and nothing that sticks
    if mu is None or states.slip is None or solution.t_end == 0:
        return []
    needs = friction - mu * normal
    needs[np.hypot(*states.slip.T) > 0] = 0.0
    worst = int(np.argmax(needs))
    if needs[worst] <= BESIDE_CONE * max(1.0, float(friction.max())):
        return []
    told = f"The rim sticks with a friction of {friction[worst]:.4g} m g where the plane has"
    sentence = f"{told} {mu * normal[worst]:.4g}: this is no motion of the model."
    return [Finding(kind=FindingKind.CONE, sentence=sentence)]


def _findings(solution: Solution, guard: Guard) -> list[Finding]:
    findings = []
    seen = solution.agreement
    if seen is not None and not seen.holds and seen.sentence:
        findings.append(Finding(kind=FindingKind.DISAGREEMENT, sentence=seen.sentence))
    # of a can that may leave the plane the motion itself is the answer to a pull, and to a far rim
    unilateral = solution.problem.effects.restitution is not None
    never_slips = solution.problem.effects.mu is None
    if solution.outcome in ENDINGS and not is_regular(solution):
        where = _laws_and_state(solution) if solution.outcome in PARADOXES else ""
        further = _carried(solution) if solution.outcome in LEAVES_THE_POINT else NONE_CARRIES
        sentence = f"{solution.outcome.value} {where}{further}"
        findings.append(Finding(kind=FindingKind.ENDING, sentence=sentence))
    if solution.outcome in LIMITS:
        findings.append(Finding(kind=FindingKind.LIMIT, sentence=solution.outcome.value))
    # at lift-off it is zero but for round-off, and the outcome has said so
    lifted = solution.outcome is Outcome.LIFTED
    # and where the whole face meets the plane at once nothing rolls any more
    lifted |= solution.outcome is Outcome.FELL_FLAT and guard.normal_force == 0.0
    yields = solution.problem.effects.compliance is not None
    if never_slips and guard.normal_force <= 0 and not lifted and not yields and not unilateral:
        pull = f"Rolling asks the plane to pull, with up to {-guard.normal_force:.4g} m g: "
        sentence = f"{pull}a can that is only pushed lifts off. {_carried(solution)}"
        findings.append(Finding(kind=FindingKind.PULL, sentence=sentence))
    elif never_slips and guard.friction_ratio > PLENTY:
        findings.append(_slippery(solution, guard.friction_ratio))
    if yields and guard.gap < 0:
        deep = f"The far rim comes {-guard.gap:.2g} R deep into the plane: a real can is pushed "
        sentence = f"{deep}there as well, and the model at its lowest point alone. {NONE_CARRIES}"
        findings.append(Finding(kind=FindingKind.FAR_RIM, sentence=sentence))
    elif guard.gap < ATOM and solution.outcome not in FLAT and not unilateral:
        near = f"The far rim comes within {guard.gap:.2g} R of the plane, less than an atom: "
        sentence = f"{near}a real can touches it with more than one point. {NONE_CARRIES}"
        findings.append(Finding(kind=FindingKind.FAR_RIM, sentence=sentence))
    return findings


def _carried(solution: Solution) -> str:
    """Return the sentence that says which model carries a contact that is lost, found or jams."""
    effects = solution.problem.effects
    held = effects.restitution is None and effects.compliance is None
    if solution.outcome is Outcome.JAMMED:
        # an impulse of friction frees a rim that slips, and none that moments have jammed
        moments = effects.drilling or effects.rolling_resistance or effects.contour or effects.patch
        held &= bool(effects.mu) and not moments
    return UNILATERAL_CARRIES if held else NONE_CARRIES


def _laws_and_state(solution: Solution) -> str:
    """Return the sentence that names the laws of friction and the state of a paradox."""
    effects, end = solution.problem.effects, solution.at(solution.t_end)
    laws = {
        "mu": effects.mu,
        "mu_static": effects.mu_static,
        "an arm of drilling": effects.drilling,
        "an arm of rolling resistance": effects.rolling_resistance,
        "a patch": effects.patch,
        "a coefficient along the rim": effects.contour,
        "a damping along the rim": effects.contour_damping,
        "a film of air": effects.film,
        "boundary layers of air": effects.boundary_layer,
    }
    named = [f"{name} {value:g}" for name, value in laws.items() if value]
    slip = 0.0 if end.slip is None else float(np.hypot(*end.slip[0]))
    return (
        f"The law has {', '.join(named) or 'no friction'}; the state is phi = {end.phi[0]:.6g} "
        f"rad, phi' = {end.phi_dot[0]:.4g}, psi' = {end.psi_dot[0]:.4g}, theta' = "
        f"{end.theta_dot[0]:.4g} "
        f"sqrt(g/R), slipping at {slip:.4g} sqrt(g R). "
    )


def _slippery(solution: Solution, ratio: float) -> Finding:
    """Return the finding that a rim that never slips needs more friction than there is."""
    needs = (
        f"Rolling needs a friction of {ratio:.4g}, which few pairs have: with less the rim slips"
        if np.isfinite(ratio)
        else "A rim that never slips needs friction without bound where its contact is lost"
    )
    if solution.problem.effects.compliance is not None:
        sentence, model = f"{needs}. Declare slip: `compliant` carries it.", ""
    elif solution.problem.effects.declared():
        carries = "general" if solution.problem.effects.restitution is None else "unilateral"
        sentence, model = f"{needs}. Declare slip: `{carries}` carries it.", ""
    else:
        sentence, model = f"{needs}, and the scene should declare slip.", "coulomb"
    return Finding(kind=FindingKind.FRICTION, sentence=sentence, model=model)
