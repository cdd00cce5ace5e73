"""The reference on random cans and releases: exact formula against integration, energy, cost.

The two are independent: the formula is a quadrature between turning points (no time stepping), the
integrator marches through the bounce. Energy is weighed by `models`, which knows neither. Cans from
disks to rods and releases from 1e-9 rad to nearly pi/2 are drawn evenly in their logarithms, some
rates exactly zero, in SI units with masses, radii and gravities over many decades.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

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

ULPS = 16.0
"""A disagreement of so many times what one ulp of the input does is the input's, not the solvers':
they round some ten numbers that are made of it."""

_SEED = 20_230_208
_SAMPLES = 33


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
        What one ulp of each number of the input does to the answer, relative, all added up; looked
        at where formula and integration differ by more than is allowed.
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
            phi_dot=float(random.choice((-1.0, 1.0))) * decades(-10.0, 1.5) / unit
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
    return compared(ideal, formula, integrated)


def _slides(scene: Scene) -> str:
    """Return why a scene with slip is not examined; nothing if its rim never slips."""
    slip = scene.effects.slip
    if slip is None or _holds(scene, slip.mu):
        return ""
    if all(phase.kind == "stick" for phase in truth(scene).phases):
        return ""
    return f"With friction {slip.mu:g} the rim slips, and what is compared here rolls."


def _holds(scene: Scene, mu: float) -> bool:
    """Whether the can bounces and rolling asks for less friction than there is, in a whole period.

    By the formula: to follow stick and slip through a thousand bounces takes a minute.
    """
    if scene.effects.declared() != ("slip",):
        return False
    bounces = solved(Case(scene=replace(scene, effects=IDEAL), engine="reference")).bounces
    return bool(bounces) and all(bounce.peak_friction_ratio < mu for bounce in bounces)


def compared(scene: Scene, formula: Truth, integrated: Truth) -> Finding:
    """Return the differences of two solutions of one scene."""
    off = max(
        (
            _difference(one, other)
            for one, other in zip(formula.bounces, integrated.bounces, strict=False)
        ),
        default=0.0,
    )
    drift = max(_energy_error(scene, truth) for truth in (formula, integrated))
    finding = Finding(
        scene=scene.name,
        outcome=integrated.solution.outcome.name.lower().replace("_", " "),
        disagreement=off,
        energy_error=drift,
        evaluations=integrated.solution.evaluations,
        failure=_failure(formula, integrated, off, drift),
    )
    if not finding.failure:
        return finding
    ulp = _of_an_ulp(scene, formula)
    if not (ulp > ALLOWED and off <= ULPS * ulp):
        return replace(finding, conditioning=ulp)
    does = "decides how this motion ends" if math.isinf(ulp) else f"moves this motion by {ulp:.0e}"
    reason = f"One ulp of the release or of the can {does}: a double cannot hold it."
    return Finding(scene=scene.name, refusal=reason, conditioning=ulp)


def _failure(formula: Truth, integrated: Truth, off: float, drift: float) -> str:
    """Return what is wrong with two solutions that ought to be one."""
    one, other = formula.solution, integrated.solution
    if one.outcome is not other.outcome:
        return f"the formula says {one.outcome.name}, the integration {other.outcome.name}"
    if len(one.bounces) != len(other.bounces):
        return f"the formula has {len(one.bounces)} bounces, the integration {len(other.bounces)}"
    if not off <= ALLOWED:
        return f"formula and integration differ by {off:.1e}"
    if not drift <= ALLOWED:
        return f"the energy changes by {drift:.1e}"
    if other.evaluations > MOST_EVALUATIONS * max(1, len(other.bounces)):
        return f"the integration took {other.evaluations} evaluations"
    return ""


def _of_an_ulp(scene: Scene, truth: Truth) -> float:
    """Return what one ulp of the numbers of a scene does to its bounces; infinite if all."""
    total = 0.0
    for near in _neighbours(scene):
        other = solved(Case(scene=near, engine="reference", options=(("model", "exact"),)))
        same = other.solution.outcome is truth.solution.outcome
        if not same or len(other.bounces) != len(truth.bounces):
            return math.inf
        pairs = zip(truth.bounces, other.bounces, strict=True)
        total += max((_difference(one, two) for one, two in pairs), default=0.0)
    return total


def _neighbours(scene: Scene) -> Iterator[Scene]:
    """Yield a scene with one number after the other one ulp larger."""
    for part in ("release", "can"):
        whole = getattr(scene, part)
        for field in fields(whole):
            value = getattr(whole, field.name)
            if isinstance(value, float) and value and field.name not in {"mass", "radius"}:
                moved = replace(whole, **{field.name: math.nextafter(value, math.inf)})
                yield replace(scene, **{part: moved})


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
