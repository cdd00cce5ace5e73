"""The reference on hard and random scenes: exact formula against integration, energy, cost.

Where the can bounces the formula is a quadrature between turning points, without time stepping, and
the integrator marches; elsewhere two sets of equations are integrated, or one has a closed form.
Energy is weighed by `models`, which knows none of them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Column, Table, table_of
from harness.engines.reference import Kind
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import Truth, cancelled, difference, perturb, solve_case, truth
from harness.engines.stepping.horizon import natural_time
from harness.evaluation.case_cache import case_key, case_metadata
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata, checksum
from harness.execution.tasks import ResultCache
from harness.execution.worker import LostTaskError
from harness.metrics.energy import energy
from harness.metrics.error import rotation_between
from harness.studies.stability.failure_criteria import available_energy
from harness.studies.study import Work
from models.body_effects import Damping
from models.catalogue import load
from models.effects import IDEAL
from models.scene import Scene

ALLOWED = 1e-9
"""Relative: the digits that the paper asks for; round-off of a thousand operations is 1e-13."""

MOST_EVALUATIONS = 4000
"""Of the equations, on one bounce: none needs more, however hard it is."""

ULPS = 16.0
"""A disagreement of so many times what one ulp of the input does is the input's, not the solvers':
they round some ten numbers that are made of it."""

_FORMULAS = frozenset({"exact", "pendulum"})

EPS = float(np.finfo(float).eps)

_SAMPLES = 33

_HARDLY = Damping(linear=1e-20)
"""1/s: less than round-off."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceCheck:
    """Result of the check of the reference on one scene.

    Parameters
    ----------
    scene : str
    outcome : str
        How the integrated motion ends.
    disagreement : float
        Largest relative difference of formula and integration: period, turn, rotation, least phi,
        peak precession rate, and the orientation all along.
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


def examine(scene: Scene) -> ReferenceCheck:
    """Return how the reference fares on a scene, solved in two ways."""
    reason = refusal(scene)
    if reason:
        return ReferenceCheck(scene=scene.name, refusal=reason)
    slips = _slips(scene)
    posed = scene if slips else replace(scene, effects=IDEAL)
    try:
        one, other = _two_ways(posed, slips=slips)
    except Exception as error:  # noqa: BLE001 - a crash is a finding, and the others go on
        return ReferenceCheck(scene=scene.name, failure=f"{type(error).__name__}: {error}")
    return compared(posed, one, other)


def _two_ways(scene: Scene, *, slips: bool) -> tuple[Truth, Truth]:
    """Return two solutions of a scene, the second of which integrates the smallest model.

    A rim that slips is followed by the equations of its own model and by those of the general can.
    One that rolls is integrated, and beside that solved by the formula where it bounces, in closed
    form where it moves in a plane, and else by the equations of stick and slip with friction
    without bound: other variables, another integrator. A can that lands has one model, whose motion
    on the rim is that of a rolling can, or of the general one if anything damps it.
    """
    if scene.release.height > 0.0:
        damped = replace(scene, effects=replace(scene.effects, damping=_HARDLY))
        return _solved(damped, "auto"), _solved(scene, "auto")
    if slips:
        return _solved(scene, "general"), _solved(scene, "auto")
    formula, integrated = _solved(scene, "exact"), _solved(scene, "rolling")
    if formula.solution.model == "exact":
        return formula, integrated
    planar = formula.chosen.model == "pendulum"
    return _solved(scene, "pendulum" if planar else "coulomb"), integrated


def _solved(scene: Scene, model: str) -> Truth:
    return solve_case(Case(scene=scene, engine="reference", options=(("model", model),)))


def _slips(scene: Scene) -> bool:
    """Whether the rim of a scene slips."""
    slip = scene.effects.slip
    if slip is None or _holds(scene, slip.mu):
        return False
    return any(phase.kind is not Kind.STICK for phase in truth(scene).phases)


def _holds(scene: Scene, mu: float) -> bool:
    """Whether the can bounces and rolling asks for less friction than there is, in a whole period.

    By the formula: to follow stick and slip through a thousand bounces takes a minute.
    """
    if scene.effects.declared() != ("slip",):
        return False
    bounces = solve_case(Case(scene=replace(scene, effects=IDEAL), engine="reference")).bounces
    return bool(bounces) and all(bounce.peak_friction_ratio < mu for bounce in bounces)


def compared(scene: Scene, one: Truth, other: Truth) -> ReferenceCheck:
    """Return the differences of two solutions of one scene."""
    off = _apart(one, other)
    drift = max(_energy_error(scene, truth) for truth in (one, other))
    finding = ReferenceCheck(
        scene=scene.name,
        outcome=other.solution.outcome.name.lower().replace("_", " "),
        disagreement=off,
        energy_error=drift,
        evaluations=other.solution.evaluations,
        failure=_failure(one, other, off, drift),
    )
    same = one.solution.outcome is other.solution.outcome and len(one.bounces) == len(other.bounces)
    # no ulp excuses a drift of energy
    if not finding.failure or not drift <= ALLOWED or (same and off <= ALLOWED):
        return finding
    # a formula has the digits of the motion; a second integration may lose some that are its own
    best = one if one.solution.model in _FORMULAS else other
    ulp, of = _of_an_ulp(best), "of the release or of the can"
    # a motion that depends on the time, or slips, is another one when it begins elsewhere
    passes = bool(best.solution.minima.size) and not scene.effects.declared()
    if not _explains(ulp, off) and passes:
        ulp, of = _of_an_ulp(_from_least_phi(scene, best)), "of where phi is least"
    if not _explains(ulp, off):
        lost = cancelled(other)
        if ALLOWED < off <= lost:
            reason = f"An integration loses {lost:.0e} of the force on phi, whose terms cancel."
            return ReferenceCheck(scene=scene.name, refusal=reason, conditioning=lost)
        return replace(finding, conditioning=ulp)
    does = "decides how this motion ends" if math.isinf(ulp) else f"moves this motion by {ulp:.0e}"
    reason = f"One ulp {of} {does}: a double cannot hold it."
    return ReferenceCheck(scene=scene.name, refusal=reason, conditioning=ulp)


def _explains(ulp: float, off: float) -> bool:
    """Whether a change by one ulp is large, and a disagreement no larger than some of them."""
    return ulp > ALLOWED and off <= ULPS * ulp


def _from_least_phi(scene: Scene, motion: Truth) -> Truth:
    """Return a motion from its first minimum of phi on.

    One that then goes over the top slowly has lost digits there that its release had.
    """
    least = motion.solution.path.at(motion.solution.minima[:1])
    unit = natural_time(scene)
    release = replace(
        scene.release,
        phi=float(least.phi[0]),
        phi_dot=0.0,
        psi_dot=float(least.psi_dot[0]) / unit,
        theta_dot=float(least.theta_dot[0]) / unit,
    )
    return _solved(replace(scene, release=release), motion.solution.model)


def _apart(one: Truth, other: Truth) -> float:
    """Return the largest relative difference of two motions, in bounces and all along."""
    off = difference(one, other)
    ends = min(one.ends, other.ends)
    if not ends > 0.0:
        return off
    # not to the very end: at pi/2 the other rim comes down, and its speed is another one
    times = np.linspace(0.0, (1.0 - ALLOWED) * ends, _SAMPLES)
    mine, theirs = one.at(times), other.at(times)
    off = max(off, abs(one.ends - other.ends) / ends)
    turned = float(rotation_between(mine.quaternion, theirs.quaternion).max())
    return max(off, turned) if math.isfinite(turned) else math.inf


def _failure(first: Truth, second: Truth, off: float, drift: float) -> str:
    """Return a sentence on the difference of two solutions of one scene; empty if there is none."""
    one, other = first.solution, second.solution
    if one.outcome is not other.outcome:
        return f"{one.model} ends as {one.outcome.name}, {other.model} as {other.outcome.name}"
    if len(one.bounces) != len(other.bounces):
        return f"{one.model} has {len(one.bounces)} bounces, {other.model} has {len(other.bounces)}"
    if not off <= ALLOWED:
        return f"{one.model} and {other.model} differ by {off:.1e}"
    if not drift <= ALLOWED:
        return f"the energy changes by {drift:.1e}"
    rolls = other.model == "rolling"
    if rolls and other.evaluations > MOST_EVALUATIONS * max(1, len(other.bounces)):
        return f"the integration took {other.evaluations} evaluations"
    return ""


def _of_an_ulp(motion: Truth) -> float:
    """Return the change of a motion by one ulp of its input; infinite if it ends otherwise."""
    total = 0.0
    for pair in perturb(motion, EPS):
        for other in pair:
            same = other.solution.outcome is motion.solution.outcome
            if not same or len(other.bounces) != len(motion.bounces):
                return math.inf
        total += max(_apart(motion, other) for other in pair)
    return total


def _energy_error(scene: Scene, truth: Truth) -> float:
    """Return the largest change of energy and work along a motion, over the spendable energy."""
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
    times = np.unique(times[times < truth.ends])
    record = truth.at(times)
    whole = energy(record, scene) + truth.lost(times)
    change = np.abs(whole - whole[0]).max()
    # heights are known to an ulp of the can's size
    size = scene.can.mass * scene.gravity * scene.can.bounding_radius
    error = float(change) / max(available_energy(record, scene), size)
    return error if math.isfinite(error) else math.inf


Part = tuple[Scene, ...]
"""Scenes that are examined in one task."""


def reference_check_cache(store: CacheFolder) -> ResultCache[Part, list[ReferenceCheck]]:
    """Return the cache of the checks of the reference."""
    module = examine.__module__

    def case(part: Part) -> Case:  # of the reference, which carries no effects
        return Case(scene=replace(part[0], effects=IDEAL), engine="reference")

    def key(part: Part) -> str:
        texts = [case_key(case(part), module), *(str(scene.to_dict()) for scene in part)]
        return checksum("\n".join(texts).encode())[:32]

    def metadata(part: Part) -> Metadata:
        label = f"the reference on {len(part)} scenes from {part[0].name}"
        own = case_metadata(case(part), module)
        return replace(own, label=label, command="rockingcan stability")

    return ResultCache(store=store, kind="findings", key=key, metadata=metadata)


def _examined(part: Part) -> list[ReferenceCheck]:
    return [examine(scene) for scene in part]


def _unexamined(part: Part, error: LostTaskError) -> list[ReferenceCheck]:
    return [ReferenceCheck(scene=scene.name, failure=error.reason) for scene in part]


EXAMINING: Work[Part, list[ReferenceCheck]] = Work(
    name="the reference",
    call=_examined,
    lost=_unexamined,
    label=lambda part: f"{len(part)} scenes from {part[0].name}",
    cache=reference_check_cache,
    effort=lambda part: 0.05 * len(part),
)
"""Solve scenes in two ways, and compare."""


_CASES = (
    Column("scene", "Name of the hard case."),
    Column("why", "Why it is hard, and where it comes from."),
    Column("reference", "What the reference makes of it."),
    Column("disagreement", "Largest relative difference of formula and integration."),
    Column("energy_error", "Largest change of energy over what the can has to spend."),
    Column("evaluations", "Evaluations of the equations that the integration needed."),
)


def case_table(checks: Sequence[ReferenceCheck]) -> Table:
    """Return the table of hard cases: why each is hard, and how the reference solves it."""
    rows = []
    for check in checks:
        solved = not check.refusal
        outcome = f"solved: {check.outcome}" if solved else f"refused: {check.refusal}"
        rows.append(
            {
                "scene": check.scene,
                "why": load(check.scene).cite.removeprefix("Hard because "),
                "reference": check.failure or outcome,
                "disagreement": check.disagreement if solved else math.nan,
                "energy_error": check.energy_error if solved else math.nan,
                "evaluations": check.evaluations if solved else None,
            }
        )
    return table_of("hard-cases", "The hard cases, and the reference on each", _CASES, rows)


_SURVEY = (
    Column("ends", "How the motion ends."),
    Column("scenes", "How many random scenes."),
    Column("failures", "How many of them failed."),
    Column("ill_conditioned", "In how many one ulp of the input does more than 1e-9: refused."),
    Column("largest_disagreement", "Of formula and integration, relative."),
    Column("largest_energy_error", "Over what the can has to spend."),
    Column("most_evaluations", "Of the equations, in one bounce."),
)


def survey_table(checks: Sequence[ReferenceCheck]) -> Table:
    """Return how the reference fared on random scenes, by how they end."""

    def ending(check: ReferenceCheck) -> str:
        return "refused" if check.refusal else check.outcome or "crash"

    rows = []
    for ends, own in groupby(sorted(checks, key=ending), ending):
        group = list(own)
        sure = [check.disagreement for check in group if check.conditioning <= ALLOWED]
        rows.append(
            {
                "ends": ends,
                "scenes": len(group),
                "failures": sum(bool(check.failure) for check in group),
                "ill_conditioned": len(group) - len(sure),
                "largest_disagreement": max(sure, default=math.nan),
                "largest_energy_error": max(check.energy_error for check in group),
                "most_evaluations": max(check.evaluations for check in group),
            }
        )
    return table_of("random-scenes", "The reference on random scenes", _SURVEY, rows)
