"""Records of other programs, held against the exact motion as an engine's runs are."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from harness.core.case import RECORDED, Case, Value
from harness.core.report_model import Artefact, Column, Table, table_of
from harness.core.simulation import Outcome, Simulation
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import truth
from harness.evaluation.evaluate import measure_simulation
from harness.evaluation.evaluation import Evaluation
from harness.records.columns import read_columns
from harness.records.evidence import evidence
from harness.records.understanding import Understood, understand
from models.scene import Scene

UNKNOWN = "unknown"
"""Version of a program that nobody said."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Labels:
    """What a user says of a record.

    Parameters
    ----------
    name : str
        Of the program.
    version : str
    timestep : float, optional
        s.
    settings : mapping of str to Value
    """

    name: str
    version: str = UNKNOWN
    timestep: float | None = None
    settings: Mapping[str, Value] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scored:
    """A record, what was understood of it, and its evaluation."""

    path: Path
    understood: Understood
    evaluation: Evaluation

    @property
    def unknown(self) -> tuple[str, ...]:
        """What the record cannot tell and why, in sentences."""
        note = self.evaluation.simulation.note
        found = [*self.understood.unknown, *([f"the end: {note}"] if note else [])]
        if any(not each.resolved for each in self.evaluation.bounces):
            found.append("turns: the record is too coarse to count them in its bounces")
        return tuple(found)


def score(
    scene: Scene,
    path: Path,
    labels: Labels,
    *,
    columns: Mapping[str, str] | None = None,
    convention: Mapping[str, str] | None = None,
) -> Scored:
    """Return a record of a scene, held against its exact motion.

    Parameters
    ----------
    scene : Scene
    path : Path
        CSV or Parquet.
    labels : Labels
    columns : mapping of str to str, optional
        Names in the file by ours.
    convention : mapping of str to str, optional
        Parts of the convention that are known.

    Raises
    ------
    RecordFileError
        If the file is no record of the scene.
    """
    understood = understand(read_columns(path, columns), scene, dict(convention or {}))
    trajectory = understood.trajectory
    case = Case(
        scene=scene,
        engine=labels.name,
        profile=RECORDED,
        timestep=labels.timestep,
        options=(
            *labels.settings.items(),
            *([("--version", labels.version)] if labels.version != UNKNOWN else []),
            *((f"--column {ours}", theirs) for ours, theirs in (columns or {}).items()),
            *((f"--convention {part}", word) for part, word in (convention or {}).items()),
            ("file", str(path)),
        ),
    )
    simulation = Simulation(
        case=case,
        outcome=Outcome.FINISHED,
        trajectory=trajectory,
        engine_version=labels.version,
        model=labels.name,
        timestep=labels.timestep,
        settings=labels.settings,
        parity=evidence(trajectory, scene),
    )
    evaluation = measure_simulation(simulation)
    if note := _missing_end(evaluation):
        simulation = replace(simulation, outcome=Outcome.ENDED_EARLY, note=note)
        evaluation = replace(evaluation, simulation=simulation)
    return Scored(path=path, understood=understood, evaluation=evaluation)


def _missing_end(evaluation: Evaluation) -> str:
    """Return what a record lacks at its end; empty if it has all that its scene asks for."""
    simulation = evaluation.simulation
    scene, trajectory = simulation.case.scene, simulation.trajectory
    if trajectory is None or refusal(scene):
        return ""
    exact, time = truth(scene), trajectory.time
    there, due = len(evaluation.bounces), len(exact.bounces)
    if (there >= due) if due else (2.0 * time[-1] - time[-2] >= exact.ends):
        return ""
    bounces = f", with {there} of {due} bounces complete" if due else ""
    return (
        f"the record ends at {time[-1]:.6g} s{bounces}: it must go a little beyond the end of the "
        f"exact motion, {exact.ends:.6g} s"
    )


_COLUMNS = (
    Column("program", "Name of the program."),
    Column("file", "The record."),
    Column("understood", "What was understood of it."),
    Column("cannot", "What it cannot tell, and why."),
)


def understood_table(scored: list[Scored]) -> tuple[Artefact, ...]:
    """Return what was understood of each record, as a table."""
    rows = [
        {
            "program": one.evaluation.simulation.model,
            "file": one.path.name,
            "understood": "; ".join(one.understood.said),
            "cannot": "; ".join(one.unknown) or "nothing: the record has all that is asked of it",
        }
        for one in scored
    ]
    table: Table = table_of("records", "What was understood of the records", _COLUMNS, rows)
    return (table,)
