"""The reference on random cans and releases: exact formula against integration, energy, cost.

The two are independent: the formula is a quadrature between turning points (no time stepping), the
integrator marches through the bounce. Energy is weighed by `models`, which knows neither. Cans from
disks to rods and releases from 1e-9 rad to nearly pi/2 are drawn evenly in their logarithms, some
rates exactly zero, in SI units with masses, radii and gravities over many decades.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.bounce import Bounce
from harness.case import Case
from harness.engines.horizon import natural_time
from harness.engines.reference import Truth, refusal, solved, truth
from harness.metrics.conservation import energy
from harness.studies.stability.signs import spendable
from models.can import Can
from models.effects import IDEAL
from models.scene import Horizon, Scene
from models.state import Release

ALLOWED = 1e-9
"""Relative: what issue and paper ask for; round-off of some thousand operations is 1e-13."""

MOST_EVALUATIONS = 4000
"""Of the equations, on one bounce: none needs more, however hard it is."""

LEAST_MOVING = 1e-3
"""rad: nutation of the flattest can that is released while phi moves. A can thrown up from phi to
phi_max keeps what sweeps it round at phi to eps (phi_max/phi)^2, in any state that is stored."""

_SEED = 20_230_208
_SAMPLES = 33
_ROUND_OFFS = 64.0  # of an integration of some hundred steps
_LEAST = 1e-12
_UNDECIDED = 1e-3
_SHORTLY = 1e-3  # of the fall: phi moves by its square and is known to round-off


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What was found of one scene.

    Parameters
    ----------
    scene : str
    outcome : str
        How the integrated motion ends.
    disagreement : float
        Largest relative difference of formula and integration: period, turn, rotation, least phi.
    conditioning : float
        What round-off alone may do to it, relative: added to what is allowed.
    energy_error : float
        Largest change of energy over what the can has to spend.
    evaluations : int
        That the integration needed.
    refusal : str
        A sentence if the reference refuses the scene; else empty.
    failure : str
        What is wrong, in a sentence; empty if nothing is.
    """

    scene: str
    outcome: str = ""
    disagreement: float = 0.0
    conditioning: float = 0.0
    energy_error: float = 0.0
    evaluations: int = 0
    refusal: str = ""
    failure: str = ""


def random_scenes(count: int) -> Iterator[Scene]:
    """Yield so many scenes, the same every time."""
    random = np.random.default_rng(_SEED)
    for number in range(count):
        yield _scene(random, number)


def _scene(random: np.random.Generator, number: int) -> Scene:
    """Return one random scene of one bounce."""

    def decades(low: float, high: float) -> float:
        return float(10.0 ** random.uniform(low, high))

    def rate() -> float:
        kind = random.integers(5)
        size = 0.0 if kind == 0 else decades(-10.0, 1.5)
        return float(random.choice((-1.0, 1.0))) * size

    h, a = decades(-2.0, 1.0), decades(-1.5, 1.5)
    can = Can.from_groups(
        mass=decades(-6.0, 6.0),
        radius=decades(-3.0, 1.0),
        a=a,
        c=a * random.uniform(1e-3, 2.0),
        h=h,
    )
    shape = random.integers(3)
    if shape == 0:
        phi = decades(-9.0, -0.5)
    elif shape == 1:
        phi = can.balancing_angle * (1.0 - decades(-5.0, -0.5))
    else:
        phi = random.uniform(0.01, 0.99) * math.pi / 2.0
    moving = random.integers(3) == 0
    if moving:
        phi = max(phi, LEAST_MOVING)
    psi, theta = rate(), rate()
    if random.integers(3) == 0:
        theta = -psi  # no spin: what is left of a bounce when the turn is all there is
    gravity = decades(-5.0, 3.0)
    unit = math.sqrt(can.radius / gravity)
    return Scene(
        name=f"random-{number}",
        gravity=gravity,
        can=can,
        release=Release(
            phi=float(phi),
            phi_dot=float(random.choice((-1.0, 1.0))) * decades(-4.0, 1.5) / unit
            if moving
            else 0.0,
            psi_dot=psi / unit,
            theta_dot=theta / unit,
        ),
        horizon=Horizon(bounces=1),
    )


def examine(scene: Scene) -> Finding:
    """Return how the reference fares on a scene."""
    reason = refusal(scene) or _slides(scene)
    if reason:
        return Finding(scene=scene.name, refusal=reason)
    ideal = replace(scene, effects=IDEAL)
    try:
        formula, integrated = (
            solved(Case(scene=ideal, engine="reference", options=(("model", model),)))
            for model in ("exact", "rolling")
        )
    except Exception as error:  # noqa: BLE001 - a crash is a finding, and the others go on
        return Finding(scene=scene.name, failure=f"{type(error).__name__}: {error}")
    return _compared(ideal, formula, integrated)


def _slides(scene: Scene) -> str:
    """Return why a scene with slip is not examined; nothing if its rim never slips."""
    slip = scene.effects.slip
    if slip is None or all(phase.kind == "stick" for phase in truth(scene).phases):
        return ""
    return f"With friction {slip.mu:g} the rim slips, and what is compared here rolls."


def _compared(scene: Scene, formula: Truth, integrated: Truth) -> Finding:
    """Return the differences of two solutions of one scene."""
    off = max(
        (
            _difference(one, other)
            for one, other in zip(formula.bounces, integrated.bounces, strict=False)
        ),
        default=0.0,
    )
    drift = max(_energy_error(scene, truth) for truth in (formula, integrated))
    ends = integrated.solution.outcome
    limit = _conditioning(scene, formula)
    if limit > _UNDECIDED:
        reason = f"Round-off alone moves this motion by {limit:.0e}: a double cannot hold it."
        return Finding(scene=scene.name, refusal=reason, conditioning=limit)
    return Finding(
        scene=scene.name,
        outcome=ends.name.lower().replace("_", " "),
        disagreement=off,
        energy_error=drift,
        evaluations=integrated.solution.evaluations,
        conditioning=limit,
        failure=_failure(formula, integrated, off, limit, drift),
    )


def _failure(formula: Truth, integrated: Truth, off: float, limit: float, drift: float) -> str:
    """Return what is wrong with two solutions that ought to be one."""
    one, other = formula.solution, integrated.solution
    if one.outcome is not other.outcome:
        return f"the formula says {one.outcome.name}, the integration {other.outcome.name}"
    if len(one.bounces) != len(other.bounces):
        return f"the formula has {len(one.bounces)} bounces, the integration {len(other.bounces)}"
    if not off <= ALLOWED + limit:
        return f"formula and integration differ by {off:.1e}"
    if not drift <= ALLOWED:
        return f"the energy changes by {drift:.1e}"
    if other.evaluations > MOST_EVALUATIONS * max(1, len(other.bounces)):
        return f"the integration took {other.evaluations} evaluations"
    return ""


def _conditioning(scene: Scene, truth: Truth) -> float:
    """Return what round-off alone does to a bounce, relative.

    A rounding of the energy moves the maximum of phi by itself over the force there; beside a fast
    spin that force may be small. And at a distance d from the balancing angle a fall takes
    log(1/d), of which the energy tells through d^2. What sweeps a can round that is thrown up from
    phi is a share (phi/phi_max)^2 of what an integrator carries at the top.
    """
    if not truth.bounces:
        return 0.0
    bounce, solution, can = truth.bounces[0], truth.solution, scene.can
    later = _SHORTLY * (bounce.time - bounce.start) / natural_time(scene)
    start = float(solution.maxima[0])
    top, after = start, start + later
    states = solution.at(np.array((top, after)))
    inertia = can.a + can.h**2 + 1.0
    force = inertia * abs(float(states.phi_dot[1] - states.phi_dot[0])) / later
    reach = force * (float(states.phi[0]) - bounce.phi_min)
    weight = can.mass * scene.gravity * can.radius
    total = float(energy(truth.at(np.zeros(1)), scene)[0]) / weight
    share = total / reach if reach > 0.0 else math.inf
    distance = 1.0 - float(states.phi[0]) / can.balancing_angle
    near = 1.0 / max(distance**2, _LEAST)
    thrown = (float(states.phi[0]) / scene.release.phi) ** 2
    return _ROUND_OFFS * float(np.finfo(float).eps) * (share + near + thrown)


def _difference(one: Bounce, other: Bounce) -> float:
    """Return the largest relative difference of two bounces; small angles count absolutely."""
    period = max(other.end - other.start, other.end)
    pairs = (
        (one.end - one.start, other.end - other.start, period),
        (one.time, other.time, period),
        (one.phi_min, other.phi_min, other.phi_min),
        (one.angle_of_turn, other.angle_of_turn, max(1.0, abs(other.angle_of_turn))),
        (one.rotation_turn, other.rotation_turn, max(1.0, abs(other.rotation_turn))),
    )
    off = [abs(a - b) / scale for a, b, scale in pairs]
    return max(off) if all(map(math.isfinite, off)) else math.inf


def _energy_error(scene: Scene, truth: Truth) -> float:
    """Return the largest change of energy along a motion, over what the can has to spend."""
    if truth.ends <= 0.0:
        return 0.0
    times = np.concatenate(
        (
            # not to the very end: at pi/2 the other rim comes down, and its speed is another one
            np.linspace(0.0, (1.0 - ALLOWED) * truth.ends, _SAMPLES),
            [bounce.time for bounce in truth.bounces],
            truth.solution.minima * natural_time(scene),
        )
    )
    record = truth.at(np.unique(times[times < truth.ends]))
    change = np.abs(energy(record, scene) - energy(record, scene)[0]).max()
    # heights are known to an ulp of the can's size
    size = scene.can.mass * scene.gravity * scene.can.bounding_radius
    error = float(change) / max(spendable(record, scene), size)
    return error if math.isfinite(error) else math.inf
