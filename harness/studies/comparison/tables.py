"""The tables of the comparison: all cases, bounces, model parity, observed orders."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from harness.core.bounce import Bounce
from harness.core.report_model import Column, Table, table_of
from harness.core.simulation import ParityRow
from harness.evaluation.evaluation import Evaluation
from harness.metrics.convergence import Order, observed_order
from harness.metrics.quantities import QUANTITIES, column, turn_error

SCENE = "Name of the scene."
ENGINE = "Name of the engine."
PROFILE = "default: as it ships; matched: what the scene declares; adaptive: and own steps."


def case_digest(e: Evaluation) -> str:
    """Return what names the case of a run, in the version of its engine."""
    return e.simulation.case.digest(e.simulation.engine_version)


CASE = (
    Column("scene", SCENE, lambda e: e.simulation.case.scene.name),
    Column("engine", ENGINE, lambda e: e.simulation.case.engine),
    Column("profile", PROFILE, lambda e: e.simulation.case.profile),
    Column(
        "timestep_s",
        "Timestep of the engine, s; the largest of an adaptive run.",
        lambda e: e.simulation.timestep,
    ),
)
"""The columns that name a case; the records are runs."""


def _of_record(column: Column) -> Column:
    return Column(column.name, column.meaning, lambda record: column.cell(record.run), column.shown)


def of_run(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Return columns of runs as those of records that have a run as their field `run`."""
    return tuple(map(_of_record, columns))


_RESULTS = (
    *CASE,
    Column("outcome", "How the run ended.", lambda e: e.simulation.ending),
    column("angle_of_turn_deg", shown=True),
    column("angle_of_turn_error_deg", shown=True),
    Column(
        "turn_resolved",
        "Whether the record is dense enough to count the turns of psi.",
        lambda e: e.bounces[0].resolved if e.bounces else None,
        shown=False,
    ),
    column("bounce_time_error_s", shown=True),
    column("phi_min_rad"),
    column("peak_friction_ratio"),
    column("peak_friction_ratio_error", shown=True),
    column("phi_rms_rad", shown=True),
    column("phi_rms_before_rad"),
    column("phi_rms_after_rad"),
    column("phi_max_rad"),
    column("rotation_rms_rad"),
    column("psi_rms_rad"),
    column("theta_rms_rad"),
    column("contact_locus_rms_m", shown=True),
    column("contact_locus_hausdorff_m"),
    Column(
        "parts_at_s",
        "When the orientation is first 0.1 rad from the truth's; empty if it never is.",
        lambda e: e.parts_at,
        shown=False,
    ),
    column("energy_drift", shown=True),
    column("max_penetration_m", shown=True),
    column("max_slip_m_s", shown=True),
    column("lift_off_fraction"),
    column("multi_contact_fraction"),
    Column(
        "static_penetration_m",
        "Depth at which the can was released.",
        lambda e: e.simulation.static_penetration,
        shown=False,
    ),
    Column(
        "simulated_s",
        "Length of the run.",
        lambda e: None if e.motion is None else float(e.motion.time[-1]),
        shown=False,
    ),
    column("steps", shown=True),
    column("constraint_rows"),
    column("setup_s"),
    column("wall_s", shown=True),
    column("cpu_s"),
    Column(
        "truth_pulls",
        "Whether the exact motion asks the plane to pull, which no engine's can.",
        shown=False,
    ),
    Column("digest", "Names the case in this version of its engine.", case_digest, shown=False),
    Column("command", "Runs the case again.", lambda e: e.simulation.case.command(), shown=False),
)


def results(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all cases, with everything that was measured of them."""
    return table_of("results", "All cases", _RESULTS, evaluations)


class _BounceOfRun(NamedTuple):
    run: Evaluation
    number: int
    bounce: Bounce

    @property
    def true(self) -> Bounce | None:
        bounces = self.run.true_bounces
        return bounces[self.number] if self.number < len(bounces) else None


def _bounce_column(name: str, meaning: str, key: str = "") -> Column:
    read = QUANTITIES[key or name].of_bounce
    return Column(name, meaning, lambda record: read(record.bounce))


_LINK = Column("case", "Digest of the case; its command is in the list of cases.", case_digest)

_BOUNCES = (
    *of_run(CASE),
    Column("bounce", "Number of the bounce, from 1.", lambda record: record.number + 1),
    _bounce_column("time_s", "Time of the minimum of phi.", "bounce_time_s"),
    _bounce_column("phi_min_rad", "Smallest phi."),
    _bounce_column("angle_of_turn_deg", "Change of psi between the maxima of phi on either side."),
    Column(
        "angle_of_turn_true_deg",
        "The same of the exact motion.",
        lambda record: record.true and QUANTITIES["angle_of_turn_deg"].of_bounce(record.true),
    ),
    _bounce_column("rotation_turn_deg", QUANTITIES["rotation_turn_deg"].meaning),
    _bounce_column("peak_psi_dot_rad_s", "Precession rate of largest magnitude."),
    _bounce_column("peak_friction_ratio", "Largest |F|/N."),
    Column(
        "resolved",
        "Whether the record is dense enough to count the turns of psi.",
        lambda record: record.bounce.resolved,
    ),
    *of_run((_LINK,)),
)


def bounces(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all bounces."""
    records = [
        _BounceOfRun(e, n, bounce) for e in evaluations for n, bounce in enumerate(e.bounces)
    ]
    return table_of("bounces", "All bounces", _BOUNCES, records)


class _Property(NamedTuple):
    run: Evaluation
    row: ParityRow


def _parity_column(name: str, meaning: str) -> Column:
    return Column(name, meaning, lambda record: getattr(record.row, name))


_PARITY = (
    *of_run(CASE),
    _parity_column("quantity", "Property of the model."),
    _parity_column("unit", "Its unit."),
    _parity_column("declared", "What the scene declares."),
    _parity_column("found", "What the compiled engine has."),
    _parity_column(
        "verdict",
        "equal; imposed: the profile is known to differ here; mismatch: the run stopped.",
    ),
    _parity_column("how", "How it was read or probed."),
    *of_run((_LINK,)),
)


def parity(evaluations: Sequence[Evaluation]) -> Table:
    """Return what each engine compiled against what the scene declares, at one timestep each."""
    seen: set[tuple[str, str, str]] = set()
    records = []
    for e in evaluations:
        case = e.simulation.case
        model = (case.scene.name, case.engine, case.profile)
        differs = any(row.verdict == "mismatch" for row in e.simulation.parity)
        if model in seen and not differs:
            continue
        seen.add(model)
        records += [_Property(e, row) for row in e.simulation.parity]
    return table_of("parity", "Model parity: the can that each engine compiled", _PARITY, records)


class _Ladder(NamedTuple):
    run: Evaluation
    quantity: str
    order: Order
    smallest_error: float


_ORDERS = (
    *of_run(CASE[:2]),
    Column("quantity", "Which error."),
    Column(
        "observed_order",
        "Slope of log error against log timestep, profile matched.",
        lambda ladder: ladder.order.order,
    ),
    Column(
        "spread",
        "Half the range of the slopes between neighbouring timesteps.",
        lambda ladder: ladder.order.spread,
    ),
    Column("timesteps", "How many timesteps it rests on.", lambda ladder: ladder.order.points),
    Column("smallest_error", "Error at the smallest timestep, in the quantity's unit."),
    *of_run((_LINK,)),
)


def orders(evaluations: Sequence[Evaluation]) -> Table:
    """Return the observed orders of all ladders; the case is the run at the smallest timestep."""
    return table_of("orders", "Observed order", _ORDERS, _ladders(evaluations))


def _ladders(evaluations: Sequence[Evaluation]) -> Iterator[_Ladder]:
    ladders: dict[tuple[str, str], list[Evaluation]] = {}
    for e in evaluations:
        case = e.simulation.case
        if case.profile == "matched" and e.errors is not None and e.simulation.timestep:
            ladders.setdefault((case.scene.name, case.engine), []).append(e)
    reads: tuple[tuple[str, Callable[[Evaluation], float | None]], ...] = (
        ("phi_rms_rad", QUANTITIES["phi_rms_rad"].of_run),
        ("angle_of_turn_deg", turn_error),
    )
    for ladder in ladders.values():
        steps = [e.simulation.timestep or math.nan for e in ladder]
        finest = steps.index(min(steps))
        for quantity, read in reads:
            known = (read(e) for e in ladder)
            errors = [math.nan if error is None else error for error in known]
            order = observed_order(steps, [_weighty(errors, error) for error in errors])
            if order.points > 1:
                yield _Ladder(ladder[finest], quantity, order, errors[finest])


def _weighty(errors: Sequence[float], error: float) -> float:
    """Return an error that an order can rest on; NaN for round-off and where the sign changes."""
    signs = {math.copysign(1.0, other) for other in errors if math.isfinite(other)}
    return error if len(signs) == 1 and abs(error) > _ROUND_OFF else math.nan


_ROUND_OFF = 1e-12
"""rad or deg: below it an error is the sum of roundings, which has no order."""
