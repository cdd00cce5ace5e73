"""Records of other programs, held against the exact motion as an engine's runs are."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from harness.core.case import Case, Value
from harness.core.report_model import Artefact, Column, Table, table_of
from harness.core.simulation import Outcome, Simulation
from harness.evaluation.evaluate import measure_simulation
from harness.evaluation.evaluation import Evaluation
from harness.records.columns import read_columns
from harness.records.evidence import evidence
from harness.records.understanding import Understood, understand
from models.scene import Scene


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
    version: str = "unknown"
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
        unresolved = [each for each in self.evaluation.bounces if not each.resolved]
        if not unresolved:
            return self.understood.unknown
        coarse = "turns: the record is too coarse to count them in its bounces"
        return (*self.understood.unknown, coarse)


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
    simulation = Simulation(
        case=Case(scene=scene, engine=labels.name, timestep=labels.timestep),
        outcome=Outcome.FINISHED,
        trajectory=trajectory,
        engine_version=labels.version,
        model=labels.name,
        timestep=labels.timestep,
        settings=labels.settings,
        parity=evidence(trajectory, scene),
    )
    return Scored(path=path, understood=understood, evaluation=measure_simulation(simulation))


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
