"""Every quantity of every engine with its number, the allowed size, and a verdict.

What is allowed is what cannot be seen, or what changes the motion in kind; each has its reason at
its definition. A run that ended early failed in all quantities; one that cannot be compared is said
to be not decidable, and why.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from harness.core.report_model import Column, Table, table_of
from harness.core.verdict import Status, Verdict
from harness.engines.description import Method
from harness.engines.registry import is_constraint
from harness.evaluation.evaluation import Evaluation
from harness.metrics.energy import energy
from harness.metrics.motion import Motion
from harness.metrics.quantities import QUANTITIES, recorded_turn_error, turn_error
from harness.studies.comparison.selection import ended, finest
from harness.studies.comparison.suite import Unsupported
from harness.studies.shared import run_columns

AGREES_TURN = 0.1
"""deg: what a protractor on the table would not show."""

AGREES_PHI = 0.01
"""Share of the largest true phi, for the rms error of phi: what a figure a hand wide would show."""


def scorecard_verdict(e: Evaluation) -> Verdict:
    """Return how faithful a run was, with the number behind it."""
    return undecided(e) or size_verdict(excess(e))


_WHOLE = 10.0
"""Factors from here on are written without decimals."""


def size_verdict(factor: float) -> Verdict:
    """Return the verdict on a size, given as a factor over the allowed one."""
    if factor <= 1.0:
        return Verdict(Status.AGREES, "agrees")
    digits = f"{factor:.0f}" if factor >= _WHOLE else f"{factor:.2g}"
    return Verdict(Status.DEVIATES, f"deviates by a factor {digits}")


def excess(e: Evaluation) -> float:
    """Return the worst error of a run over the allowed one: of any turn, or of phi over the run."""
    if e.errors is None or e.truth is None:
        return math.inf
    turns = [
        abs(recorded_turn_error(e, place) or 0.0) / AGREES_TURN
        for place in range(len(e.errors.angle_of_turn))
    ]
    largest = float(e.truth.angles.phi.max())
    return max(*turns, e.errors.phi_rms / (AGREES_PHI * largest), 0.0)


def undecided(e: Evaluation) -> Verdict | None:
    """Return why a run has no error that could be weighed, or None if it has one."""
    if (end := ended(e)) is not None:
        return end
    if e.errors is None:
        return _not_decidable("there is no exact motion")
    if e.truth_pulls:
        return _not_decidable("the exact motion asks the plane to pull")
    if e.true_bounces and not e.errors.angle_of_turn:
        return _NO_BOUNCE
    if e.true_bounces and not e.bounces[0].resolved:
        return _TOO_COARSE
    return None


def _not_decidable(why: str) -> Verdict:
    return Verdict(Status.UNDECIDABLE, f"not decidable: {why}")


_NO_BOUNCE = Verdict(Status.FAILED, "failed: no complete bounce")
_TOO_COARSE = Verdict(Status.DEVIATES, "deviates: too coarse to count the turns")


_FIDELITY = (
    *run_columns.RUN,
    Column("quantity", "What was compared; the unit is its suffix."),
    Column(
        "value", "Engine minus truth, or how far the contact is from the ideal one, which has zero."
    ),
    Column("allowed", "Size up to which it agrees."),
    Column(
        "verdict",
        "In words: agrees; deviates, by what factor; failed; unsupported; or not decidable.",
    ),
    Column("case", "Digest of the run; its command is in the list of cases.", "simulation.digest"),
    *run_columns.without((run_columns.COMMAND,), "command"),
)

_SEEN = 0.01
"""Share that a figure a hand wide would show: of the radius, of a ratio, of a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FidelityQuantity:
    """One thing that engines are judged by.

    Parameters
    ----------
    key : str
        Name with the unit as its suffix.
    value : callable
        Signed, or None where the run has none.
    allowed : callable
        Of what size it may be, given the exact motion.
    rolls : bool
        Whether it supposes that the can may roll: it is then not decidable where the exact motion
        asks the plane to pull.
    bounces : bool
        Whether it is a property of bounces.
    contact : bool
        Whether it is how far a contact is from the ideal one, which a constraint is.
    """

    key: str
    value: Callable[[Evaluation], float | None]
    allowed: Callable[[Evaluation, Motion], float]
    rolls: bool = True
    bounces: bool = False
    contact: bool = False


def fidelity(evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()) -> Table:
    """Return the verdicts on each profile of each engine, where it was finest."""
    rows = [
        {
            "simulation": e.simulation,
            "quantity": quantity.key,
            "value": quantity.value(e),
            "allowed": _allowed(quantity, e),
            "verdict": verdict(quantity, e),
        }
        for e in finest(evaluations)
        for quantity in JUDGED
    ]
    rows += [
        {
            "scene": case.scene,
            "engine": case.engine,
            "profile": "matched",
            "quantity": quantity.key,
            "verdict": case.verdict,
        }
        for case in unsupported
        for quantity in JUDGED
    ]
    return table_of("fidelity", "Every quantity and its verdict", _FIDELITY, rows)


def verdict(quantity: FidelityQuantity, e: Evaluation) -> Verdict:
    """Return how an engine fares in a quantity."""
    if (end := ended(e)) is not None:
        return end
    imposed = quantity.contact and is_constraint(e.simulation.case.engine)
    doubt = Method.CONSTRAINT.refusal if imposed else _undecidable(quantity, e)
    if doubt:
        return _not_decidable(doubt)
    if quantity.bounces and not e.bounces:
        return _NO_BOUNCE
    if quantity.key == _TURN and any(not bounce.resolved for bounce in e.bounces):
        return _TOO_COARSE
    value, allowed = quantity.value(e), _allowed(quantity, e)
    if value is None or allowed is None:
        return _not_decidable("the run has no such number")
    return size_verdict(abs(value) / allowed)


def _undecidable(quantity: FidelityQuantity, e: Evaluation) -> str:
    """Return why a quantity cannot be weighed, or nothing."""
    if e.errors is None or e.truth is None:
        return "there is no exact motion"
    if quantity.rolls and e.truth_pulls:
        return "the exact motion asks the plane to pull"
    if quantity.bounces and not e.true_bounces:
        return "the scene has no bounce"
    if quantity.key == _ENERGY and e.energy_drift is None:
        return "the scene does not conserve its energy"
    return _of_the_exact_can(quantity, e, e.truth)


def _of_the_exact_can(quantity: FidelityQuantity, e: Evaluation, truth: Motion) -> str:
    """Return that the exact can does, or may do, what the ideal can never does; or nothing."""
    if quantity.key == _SLIP and e.simulation.case.scene.effects.slip is not None:
        return "the scene lets the can slip"
    if quantity.key == _LIFT_OFF and _unilateral(e) and not truth.touching.all():
        return "the exact can leaves the plane"
    lowest = min((bounce.phi_min for bounce in e.true_bounces), default=math.pi / 2)
    meets = min(_clearance(e, truth), _far_rim(e, lowest)) < _ATOM
    if quantity.key == _DEPTH and _unilateral(e) and meets:
        return "the exact can lands on its face"
    return ""


def _allowed(quantity: FidelityQuantity, e: Evaluation) -> float | None:
    return None if e.truth is None else quantity.allowed(e, e.truth)


def _largest(values: Iterable[float | None]) -> float | None:
    """Return the number of largest size with its sign; None of none."""
    known = [value for value in values if value is not None and math.isfinite(value)]
    return max(known, key=abs) if known else None


def _turn(e: Evaluation) -> float | None:
    return _largest(turn_error(e, place) for place in range(len(e.bounces)))


def _friction(e: Evaluation) -> float | None:
    return _largest(e.errors.peak_friction_ratio) if e.errors else None


def _asked(e: Evaluation) -> float:
    """Return the least peak of |F|/N that the exact bounces ask for."""
    return min((b.peak_friction_ratio for b in e.true_bounces), default=math.nan)


def _unilateral(e: Evaluation) -> bool:
    """Return whether the exact can may leave the plane, and land on it."""
    scene = e.simulation.case.scene
    return scene.effects.restitution is not None or scene.release.height > 0.0


def _clearance(e: Evaluation, truth: Motion) -> float:
    """Return how high the far rim is above the plane at its lowest, m."""
    return _far_rim(e, float(truth.angles.phi.min()))


def _far_rim(e: Evaluation, phi: float) -> float:
    """Return how high the far rim of a can is that leans on the other, m."""
    return 2.0 * e.simulation.case.scene.can.radius * math.sin(phi)


def _speed(truth: Motion) -> float:
    """Return the speed of the centre at its largest, m/s."""
    squares = (truth.trajectory.velocity**2).sum(axis=1)
    return math.sqrt(float(squares.max()))


def _spendable(e: Evaluation, truth: Motion) -> float:
    """Return the energy at release over that of the can lying flat, in m g R."""
    scene, trajectory = e.simulation.case.scene, truth.trajectory
    can, point = scene.can, scene.effects.point_mass
    scale = can.mass * scene.gravity * can.radius
    flat = can.mass * scene.gravity * can.half_height
    if point is not None:
        flat += point.mass * scene.gravity * (can.half_height + point.z)
    return (float(energy(trajectory, scene)[0]) - flat) / scale


_TURN = "turn_error_deg"
_SLIP = "slip_m_s"
_ENERGY = "energy_drift"
_LIFT_OFF = "lift_off_fraction"
_DEPTH = "penetration_m"
_ATOM = 1e-10
"""m: a far rim that comes nearer to the plane than the size of an atom meets it."""

JUDGED = (
    # a tenth of a degree: what a protractor on the table would not show
    FidelityQuantity(key=_TURN, value=_turn, allowed=lambda *_: AGREES_TURN, bounces=True),
    FidelityQuantity(
        key="contact_locus_m",
        value=QUANTITIES["contact_locus_hausdorff_m"].of_run,
        allowed=lambda e, _: _SEEN * e.simulation.case.scene.can.radius,
    ),
    FidelityQuantity(
        key="friction_ratio_error",
        value=_friction,
        allowed=lambda e, _: _SEEN * _asked(e),
        bounces=True,
    ),
    # against the fastest that the centre goes: creeping at a hundredth of it looks like rolling
    FidelityQuantity(
        key=_SLIP,
        value=QUANTITIES["max_slip_m_s"].of_run,
        allowed=lambda _, truth: _SEEN * _speed(truth),
        contact=True,
    ),
    # deeper, and the far rim touches the plane where the exact can clears it: another motion
    FidelityQuantity(
        key=_DEPTH,
        value=QUANTITIES["max_penetration_m"].of_run,
        allowed=_clearance,
        contact=True,
    ),
    FidelityQuantity(
        key=_LIFT_OFF,
        value=QUANTITIES["lift_off_fraction"].of_run,
        allowed=lambda *_: _SEEN,
        contact=True,
    ),
    # of what the can has to spend: phi follows it in proportion
    FidelityQuantity(
        key=_ENERGY,
        value=QUANTITIES["energy_drift"].of_run,
        allowed=lambda e, truth: _SEEN * _spendable(e, truth),
        rolls=False,
    ),
)
"""In the order of the scorecard; an ideal rolling can has zero in all of them."""
