"""The other tables of the comparison: bounces, model parity, observed orders."""

import math
from collections.abc import Mapping, Sequence

from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation
from harness.metrics.convergence import observed_order
from harness.metrics.quantities import turn_error
from harness.studies.comparison.results import CASE, LINK, frame, key, link

_BOUNCES: Mapping[str, str] = {
    **CASE,
    "bounce": "Number of the bounce, from 1.",
    "time_s": "Time of the minimum of phi.",
    "phi_min_rad": "Smallest phi.",
    "angle_of_turn_deg": "Change of psi between the maxima of phi on either side.",
    "angle_of_turn_true_deg": "The same of the exact motion.",
    "rotation_turn_deg": "Change of theta between the maxima of phi on either side.",
    "peak_psi_dot_rad_s": "Precession rate of largest magnitude.",
    "peak_friction_ratio": "Largest |F|/N.",
    "resolved": "Whether the record is dense enough to count the turns of psi.",
    **LINK,
}


def bounces(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all bounces."""
    rows = []
    for e in evaluations:
        for number, bounce in enumerate(e.bounces):
            true = e.true_bounces[number] if number < len(e.true_bounces) else None
            rows.append(
                {
                    **key(e),
                    "bounce": number + 1,
                    "time_s": bounce.time,
                    "phi_min_rad": bounce.phi_min,
                    "angle_of_turn_deg": math.degrees(bounce.angle_of_turn),
                    "angle_of_turn_true_deg": None
                    if true is None
                    else math.degrees(true.angle_of_turn),
                    "rotation_turn_deg": math.degrees(bounce.rotation_turn),
                    "peak_psi_dot_rad_s": bounce.peak_psi_dot,
                    "peak_friction_ratio": bounce.peak_friction_ratio,
                    "resolved": bounce.resolved,
                    **link(e),
                }
            )
    return Table(name="bounces", title="All bounces", frame=frame(rows, _BOUNCES), columns=_BOUNCES)


_PARITY: Mapping[str, str] = {
    **CASE,
    "quantity": "Property of the model.",
    "unit": "Its unit.",
    "declared": "What the scene declares.",
    "found": "What the compiled engine has.",
    "verdict": "equal; imposed: the profile is known to differ here; mismatch: the run stopped.",
    "how": "How it was read or probed.",
    **LINK,
}


def parity(evaluations: Sequence[Evaluation]) -> Table:
    """Return what each engine compiled against what the scene declares, at one timestep each."""
    seen: set[tuple[str, str, str]] = set()
    rows = []
    for e in evaluations:
        case = e.simulation.case
        model = (case.scene.name, case.engine, case.profile)
        differs = any(row.verdict == "mismatch" for row in e.simulation.parity)
        if model in seen and not differs:
            continue
        seen.add(model)
        rows += [
            {**key(e), **{name: getattr(row, name) for name in row.__slots__}, **link(e)}
            for row in e.simulation.parity
        ]
    return Table(
        name="parity",
        title="Model parity: the can that each engine compiled",
        frame=frame(rows, _PARITY),
        columns=_PARITY,
    )


_ORDER: Mapping[str, str] = {
    "scene": CASE["scene"],
    "engine": CASE["engine"],
    "quantity": "Which error.",
    "observed_order": "Slope of log error against log timestep, profile matched.",
    "spread": "Half the range of the slopes between neighbouring timesteps.",
    "timesteps": "How many timesteps it rests on.",
    "smallest_error": "Error at the smallest timestep, in the quantity's unit.",
    "case": "Digest of the run at the smallest timestep; its command is in the list of cases.",
}


def orders(evaluations: Sequence[Evaluation]) -> Table:
    """Return the observed orders of all ladders."""
    ladders: dict[tuple[str, str], list[Evaluation]] = {}
    for e in evaluations:
        case = e.simulation.case
        if case.profile == "matched" and e.errors is not None and e.simulation.timestep:
            ladders.setdefault((case.scene.name, case.engine), []).append(e)
    rows = []
    for (scene, engine), ladder in ladders.items():
        steps = [e.simulation.timestep or math.nan for e in ladder]
        for quantity, errors in (
            ("phi_rms_rad", [e.errors.phi_rms if e.errors else math.nan for e in ladder]),
            ("angle_of_turn_deg", [_number(turn_error(e)) for e in ladder]),
        ):
            order = observed_order(steps, [_weighty(errors, error) for error in errors])
            if order.points > 1:
                smallest = errors[steps.index(min(steps))]
                rows.append(
                    {
                        "scene": scene,
                        "engine": engine,
                        "quantity": quantity,
                        "observed_order": order.order,
                        "spread": order.spread,
                        "timesteps": order.points,
                        "smallest_error": smallest,
                        **link(ladder[steps.index(min(steps))]),
                    }
                )
    return Table(name="orders", title="Observed order", frame=frame(rows, _ORDER), columns=_ORDER)


def _weighty(errors: Sequence[float], error: float) -> float:
    """Return an error that an order can rest on; NaN for round-off and where the sign changes."""
    signs = {math.copysign(1.0, other) for other in errors if math.isfinite(other)}
    return error if len(signs) == 1 and abs(error) > _ROUND_OFF else math.nan


_ROUND_OFF = 1e-12
"""rad or deg: below it an error is the sum of roundings, which has no order."""


def _number(value: float | None) -> float:
    return math.nan if value is None else value
