"""Every quantity of every engine with its number, what is allowed, and a verdict in words.

What is allowed is what cannot be seen, or what changes the motion in kind; each has its reason at
its definition. A run that ended early failed in all quantities; one that cannot be compared is said
to be not decidable, and why.

The comparison in one table: a row a scene and engine, as it ships beside the best it can do.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation
from harness.metrics.energy import energy
from harness.metrics.quantities import QUANTITIES, recorded_turn_error, turn_error
from harness.studies.comparison.results import CASE, Row, frame, key
from harness.studies.comparison.selection import ended, finest
from harness.studies.comparison.suite import Unsupported

_SCORECARD_COLUMNS: Mapping[str, str] = {
    "scene": CASE["scene"],
    "engine": CASE["engine"],
    "shipped_verdict": "As it ships: agrees, deviates, failed, unsupported, or not decidable.",
    "shipped_turn_error_deg": "First angle of turn, engine minus truth, as it ships.",
    "shipped_phi_rms_rad": "Root mean square error of phi, as it ships.",
    "best_verdict": "The same at the best that was run.",
    "best_turn_error_deg": "First angle of turn, engine minus truth, of the best run.",
    "best_phi_rms_rad": "Root mean square error of phi of the best run.",
    "best_run": "Profile and timestep of the best run.",
    "case": "Digest of the best run; its command is in the list of cases.",
}

AGREES_TURN = 0.1
"""deg: what a protractor on the table would not show."""

AGREES_PHI = 0.01
"""Share of the largest true phi, for the rms error of phi: what a figure a hand wide would show."""


def scorecard(evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()) -> Table:
    """Return the scorecard of the comparison."""
    rows: list[Row] = []
    pairs = dict.fromkeys(
        (e.simulation.case.scene.name, e.simulation.case.engine) for e in evaluations
    )
    for scene, engine in pairs:
        own = [
            e
            for e in evaluations
            if (e.simulation.case.scene.name, e.simulation.case.engine) == (scene, engine)
        ]
        shipped = next((e for e in own if e.simulation.case.profile == "default"), None)
        tuned = [e for e in own if e.simulation.case.profile != "default"]
        rows.append(_row(scene, engine, shipped, min(tuned, key=_badness, default=None)))
    rows += [
        {
            "scene": one.scene,
            "engine": one.engine,
            "shipped_verdict": one.verdict,
            "best_verdict": one.verdict,
        }
        for one in unsupported
    ]
    return Table(
        name="scorecard",
        title="As it ships, and at its best",
        frame=frame(rows, _SCORECARD_COLUMNS),
        columns=_SCORECARD_COLUMNS,
    )


def _row(scene: str, engine: str, shipped: Evaluation | None, best: Evaluation | None) -> Row:
    """Return the row of a scene and an engine."""
    row: Row = {"scene": scene, "engine": engine}
    for prefix, e in (("shipped", shipped), ("best", best)):
        if e is None:
            continue
        row[f"{prefix}_verdict"] = scorecard_verdict(e)
        if e.errors is not None:
            row[f"{prefix}_phi_rms_rad"] = e.errors.phi_rms
            row[f"{prefix}_turn_error_deg"] = turn_error(e)
    if best is not None:
        simulation = best.simulation
        row["best_run"] = f"{simulation.case.profile}, {simulation.timestep:.2g} s"
        row["case"] = simulation.case.digest(simulation.engine_version)
    return row


def scorecard_verdict(e: Evaluation) -> str:
    """Return in words how faithful a run was, with the number behind it."""
    undecided = _undecided(e)
    if undecided is not None:
        return undecided
    much = excess(e)
    return "agrees" if much <= 1.0 else deviation(much)


_WHOLE = 10.0
"""Factors from here on are told without decimals."""


def deviation(factor: float) -> str:
    """Return in words by what factor something exceeds what is allowed."""
    return (
        f"deviates by a factor {factor:.0f}"
        if factor >= _WHOLE
        else (f"deviates by a factor {factor:.2g}")
    )


def excess(e: Evaluation) -> float:
    """Return the worst error of a run over what agrees: of any turn, or of phi over the run."""
    if e.errors is None or e.truth is None:
        return math.inf
    turns = [
        abs(recorded_turn_error(e, place) or 0.0) / AGREES_TURN
        for place in range(len(e.errors.angle_of_turn))
    ]
    largest = float(e.truth.angles.phi.max())
    return max(*turns, e.errors.phi_rms / (AGREES_PHI * largest), 0.0)


def _undecided(e: Evaluation) -> str | None:
    """Return why a run has no error that could be weighed, or None if it has one."""
    end = ended(e)
    if end:
        return end
    if e.errors is None:
        return "not decidable: there is no exact motion"
    if e.truth_pulls:
        return "not decidable: the exact motion asks the plane to pull"
    if e.true_bounces and not e.errors.angle_of_turn:
        return "failed: no complete bounce"
    if e.true_bounces and not e.bounces[0].resolved:
        return "deviates: too coarse to count the turns"
    return None


def _badness(e: Evaluation) -> tuple[bool, float, float]:
    """Return what the best run has least of; of a chaotic scene it is followed longest."""
    return _undecided(e) is not None, excess(e), -(math.inf if e.parts_at is None else e.parts_at)


_COLUMNS: Mapping[str, str] = {
    **CASE,
    "quantity": "What was compared; the unit is its suffix.",
    "value": "Engine minus truth, or how far the contact is from the ideal one, which has zero.",
    "allowed": "Size up to which it agrees.",
    "verdict": "In words: agrees; deviates, by what factor; failed; unsupported; or not decidable.",
    "case": "Digest of the run; its command is in the list of cases.",
    "command": "Runs the case again.",
}

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
        Of what size it may be.
    rolls : bool
        Whether it supposes that the can may roll: it is then not decidable where the exact motion
        asks the plane to pull.
    bounces : bool
        Whether it is a property of bounces.
    """

    key: str
    value: Callable[[Evaluation], float | None]
    allowed: Callable[[Evaluation], float]
    rolls: bool = True
    bounces: bool = False


def fidelity(evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()) -> Table:
    """Return the verdicts on each profile of each engine, at its smallest timestep."""
    rows: list[Row] = []
    for e in finest(evaluations):
        for quantity in JUDGED:
            value, allowed = quantity.value(e), _allowed(quantity, e)
            rows.append(
                {
                    **key(e),
                    "quantity": quantity.key,
                    "value": value,
                    "allowed": allowed,
                    "verdict": verdict(quantity, e),
                    "case": e.simulation.case.digest(e.simulation.engine_version),
                    "command": e.simulation.case.command(),
                }
            )
    rows += [
        {
            "scene": one.scene,
            "engine": one.engine,
            "profile": "matched",
            "quantity": quantity.key,
            "verdict": one.verdict,
        }
        for one in unsupported
        for quantity in JUDGED
    ]
    return Table(
        name="fidelity",
        title="Every quantity and its verdict",
        frame=frame(rows, _COLUMNS),
        columns=_COLUMNS,
        shown=tuple(name for name in _COLUMNS if name != "command"),
    )


def verdict(quantity: FidelityQuantity, e: Evaluation) -> str:
    """Return in words how an engine fares in a quantity."""
    end = ended(e)
    if end:
        return end
    doubt = _undecidable(quantity, e)
    if doubt:
        return f"not decidable: {doubt}"
    if quantity.bounces and not e.bounces:
        return "failed: no complete bounce"
    if quantity.key == _TURN and any(not bounce.resolved for bounce in e.bounces):
        return "deviates: too coarse to count the turns"
    value, allowed = quantity.value(e), _allowed(quantity, e)
    if value is None or allowed is None:
        return "not decidable: the run has no such number"
    factor = abs(value) / allowed
    return "agrees" if factor <= 1.0 else deviation(factor)


def _undecidable(quantity: FidelityQuantity, e: Evaluation) -> str:
    """Return why a quantity cannot be weighed, or nothing."""
    if e.errors is None or e.truth is None:
        return "there is no exact motion"
    if quantity.rolls and e.truth_pulls:
        return "the exact motion asks the plane to pull"
    if quantity.bounces and not e.true_bounces:
        return "the scene has no bounce"
    if quantity.key == _SLIP and e.simulation.case.scene.effects.slip is not None:
        return "the scene lets the can slip"
    if quantity.key == _ENERGY and e.energy_drift is None:
        return "the scene does not conserve its energy"
    return ""


def _allowed(quantity: FidelityQuantity, e: Evaluation) -> float | None:
    return quantity.allowed(e) if e.truth is not None else None


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


def _clearance(e: Evaluation) -> float:
    """Return how high the far rim is above the plane at its lowest, m."""
    if e.truth is None:
        return math.nan
    return 2.0 * e.simulation.case.scene.can.radius * math.sin(float(e.truth.angles.phi.min()))


def _speed(e: Evaluation) -> float:
    """Return the speed of the centre at its largest, m/s."""
    if e.truth is None:
        return math.nan
    squares = (e.truth.trajectory.velocity**2).sum(axis=1)
    return math.sqrt(float(squares.max()))


def _spendable(e: Evaluation) -> float:
    """Return the energy at release over that of the can lying flat, in m g R."""
    if e.truth is None:
        return math.nan
    scene, trajectory = e.simulation.case.scene, e.truth.trajectory
    can, point = scene.can, scene.effects.point_mass
    scale = can.mass * scene.gravity * can.radius
    flat = can.mass * scene.gravity * can.half_height
    if point is not None:
        flat += point.mass * scene.gravity * (can.half_height + point.z)
    return (float(energy(trajectory, scene)[0]) - flat) / scale


_TURN = "turn_error_deg"
_SLIP = "slip_m_s"
_ENERGY = "energy_drift"

JUDGED = (
    # a tenth of a degree: what a protractor on the table would not show
    FidelityQuantity(key=_TURN, value=_turn, allowed=lambda _: AGREES_TURN, bounces=True),
    FidelityQuantity(
        key="contact_locus_m",
        value=QUANTITIES["contact_locus_hausdorff_m"].of_run,
        allowed=lambda e: _SEEN * e.simulation.case.scene.can.radius,
    ),
    FidelityQuantity(
        key="friction_ratio_error",
        value=_friction,
        allowed=lambda e: _SEEN * _asked(e),
        bounces=True,
    ),
    # against the fastest that the centre goes: creeping at a hundredth of it looks like rolling
    FidelityQuantity(
        key=_SLIP,
        value=QUANTITIES["max_slip_m_s"].of_run,
        allowed=lambda e: _SEEN * _speed(e),
    ),
    # deeper, and the far rim touches the plane where the exact can clears it: another motion
    FidelityQuantity(
        key="penetration_m",
        value=QUANTITIES["max_penetration_m"].of_run,
        allowed=_clearance,
    ),
    FidelityQuantity(
        key="lift_off_fraction",
        value=QUANTITIES["lift_off_fraction"].of_run,
        allowed=lambda _: _SEEN,
    ),
    # of what the can has to spend: phi follows it in proportion
    FidelityQuantity(
        key=_ENERGY,
        value=QUANTITIES["energy_drift"].of_run,
        allowed=lambda e: _SEEN * _spendable(e),
        rolls=False,
    ),
)
"""In the order of the scorecard; an ideal rolling can has zero in all of them."""
