"""Every quantity of every engine with its number, what is allowed, and a verdict in words.

What is allowed is what cannot be seen, or what changes the motion in kind; each has its reason at
its definition. A run that ended early failed in all quantities; one that cannot be compared is said
to be not decidable, and why.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from harness.artefact import Table
from harness.metrics.conservation import energy
from harness.runner import Evaluation
from harness.studies.comparison.curves import finest
from harness.studies.comparison.ending import ended
from harness.studies.comparison.rows import CASE, Row, frame, key
from harness.studies.comparison.scorecard import AGREES_TURN, deviation
from harness.studies.comparison.unsupported import Unsupported

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
class Quantity:
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
        for quantity in QUANTITIES:
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
        for quantity in QUANTITIES
    ]
    return Table(
        name="fidelity",
        title="Every quantity and its verdict",
        frame=frame(rows, _COLUMNS),
        columns=_COLUMNS,
        shown=tuple(name for name in _COLUMNS if name != "command"),
    )


def verdict(quantity: Quantity, e: Evaluation) -> str:
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


def _undecidable(quantity: Quantity, e: Evaluation) -> str:
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


def _allowed(quantity: Quantity, e: Evaluation) -> float | None:
    return quantity.allowed(e) if e.truth is not None else None


def _largest(values: Iterator[float]) -> float | None:
    """Return the number of largest size with its sign; None of none."""
    known = [value for value in values if math.isfinite(value)]
    return max(known, key=abs) if known else None


def _turn(e: Evaluation) -> float | None:
    turns = e.errors.angle_of_turn if e.errors else ()
    pairs = zip(turns, e.bounces, strict=False)
    return _largest(math.degrees(turn) for turn, bounce in pairs if bounce.resolved)


def _locus(e: Evaluation) -> float | None:
    return _known(e.errors.contact_locus_hausdorff) if e.errors else None


def _friction(e: Evaluation) -> float | None:
    return _largest(iter(e.errors.peak_friction_ratio)) if e.errors else None


def _asked(e: Evaluation) -> float:
    """Return the least peak of |F|/N that the exact bounces ask for."""
    return min((b.peak_friction_ratio for b in e.true_bounces), default=math.nan)


def _known(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


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

QUANTITIES = (
    # a tenth of a degree: what a protractor on the table would not show
    Quantity(key=_TURN, value=_turn, allowed=lambda _: AGREES_TURN, bounces=True),
    Quantity(
        key="contact_locus_m",
        value=_locus,
        allowed=lambda e: _SEEN * e.simulation.case.scene.can.radius,
    ),
    Quantity(
        key="friction_ratio_error",
        value=_friction,
        allowed=lambda e: _SEEN * _asked(e),
        bounces=True,
    ),
    # against the fastest that the centre goes: creeping at a hundredth of it looks like rolling
    Quantity(
        key=_SLIP,
        value=lambda e: _known(e.contact.max_slip) if e.contact else None,
        allowed=lambda e: _SEEN * _speed(e),
    ),
    # deeper, and the far rim touches the plane where the exact can clears it: another motion
    Quantity(
        key="penetration_m",
        value=lambda e: _known(e.contact.max_penetration) if e.contact else None,
        allowed=_clearance,
    ),
    Quantity(
        key="lift_off_fraction",
        value=lambda e: _known(e.contact.lift_off_fraction) if e.contact else None,
        allowed=lambda _: _SEEN,
    ),
    # of what the can has to spend: phi follows it in proportion
    Quantity(
        key=_ENERGY,
        value=lambda e: _known(e.energy_drift),
        allowed=lambda e: _SEEN * _spendable(e),
        rolls=False,
    ),
)
"""In the order of the scorecard; an ideal rolling can has zero in all of them."""
