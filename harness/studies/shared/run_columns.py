"""Columns that tables of several studies share: which run a row is of, and how it ended."""

from collections.abc import Iterable
from dataclasses import replace

from harness.core.report_model import Column
from harness.core.simulation import Simulation

SCENE = Column("scene", "Name of the scene.")
ENGINE = Column("engine", "Name of the engine.")
PROFILE = Column(
    "profile", "default: as it ships; matched: what the scene declares; adaptive: and own steps."
)
MODEL = Column("model", "What was solved.")
TIMESTEP = Column("timestep_s", "Timestep, s.")
OUTCOME = Column("outcome", "How the run ended.")
NOTE = Column("note", "What else is to be known of it.")
CASE = Column("case", "Names the case in this version of its engine.")
LINK = Column("case", "Digest of the case; its command is in the list of cases.")
COMMAND = Column("command", "Runs the case again.")


def run_cells(simulation: Simulation) -> dict[str, object]:
    """Return the cells that say of a run which it is and how it ended, by column."""
    case = simulation.case
    return {
        "scene": case.scene.name,
        "engine": case.engine,
        "profile": case.profile,
        "model": simulation.model,
        "timestep_s": simulation.timestep,
        "steps": simulation.steps,
        "constraint_rows": simulation.constraint_rows,
        "outcome": simulation.outcome.value,
        "note": simulation.note,
        "case": case.digest(simulation.engine_version),
        "command": case.command(),
    }


def without(columns: Iterable[Column], *names: str) -> tuple[Column, ...]:
    """Return columns of which the page and the terminal do not show some; the files have all."""
    return tuple(replace(c, shown=False) if c.name in names else c for c in columns)
