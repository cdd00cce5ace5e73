"""The comparison in one table: a row a scene and engine, as it ships beside the best it can do."""

import math
from collections.abc import Mapping, Sequence

from harness.artefact import Table
from harness.runner import Evaluation
from harness.studies.comparison.ending import ended
from harness.studies.comparison.rows import CASE, Row, frame
from harness.studies.comparison.unsupported import Unsupported

_COLUMNS: Mapping[str, str] = {
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
        frame=frame(rows, _COLUMNS),
        columns=_COLUMNS,
    )


def _row(scene: str, engine: str, shipped: Evaluation | None, best: Evaluation | None) -> Row:
    """Return the row of a scene and an engine."""
    row: Row = {"scene": scene, "engine": engine}
    for prefix, e in (("shipped", shipped), ("best", best)):
        if e is None:
            continue
        row[f"{prefix}_verdict"] = verdict(e)
        if e.errors is not None:
            row[f"{prefix}_phi_rms_rad"] = e.errors.phi_rms
            if e.errors.angle_of_turn and e.bounces[0].resolved:
                row[f"{prefix}_turn_error_deg"] = math.degrees(e.errors.angle_of_turn[0])
    if best is not None:
        simulation = best.simulation
        row["best_run"] = f"{simulation.case.profile}, {simulation.timestep:.2g} s"
        row["case"] = simulation.case.digest(simulation.engine_version)
    return row


def verdict(e: Evaluation) -> str:
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
    turns = [abs(math.degrees(turn)) / AGREES_TURN for turn in e.errors.angle_of_turn]
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
