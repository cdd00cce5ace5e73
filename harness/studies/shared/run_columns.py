"""Columns that tables of several studies share: which run a row is of, and how it ended.

Their cells are read from the `simulation` of a row, which is an evaluation or a mapping. A table
whose rows hold the scene or the engine elsewhere says where: `SCENE.of("path.scene.name")`.
"""

from collections.abc import Iterable
from dataclasses import replace

from harness.core.report_model import Column, Table, table_of
from harness.metrics.quantities import QUANTITIES

SCENE = Column("scene", "Name of the scene.", "simulation.case.scene.name")
ENGINE = Column("engine", "Name of the engine.", "simulation.case.engine")
PROFILE = Column(
    "profile",
    "default: as it ships; matched: what the scene declares; adaptive: and own steps.",
    "simulation.case.profile",
)
MODEL = Column("model", "What was solved.", "simulation.model")
TIMESTEP = Column(
    "timestep_s",
    "Timestep of the engine, s; the largest of an adaptive run.",
    "simulation.timestep",
)
RUN = (SCENE, ENGINE, PROFILE, TIMESTEP)
"""Columns that say which run a row is of."""

OUTCOME = Column("outcome", "How the run ended.", "simulation.outcome.value")
NOTE = Column("note", "What else is to be known of it.", "simulation.note")
CASE = Column("case", "Names the case in this version of its engine.", "simulation.digest")
LINK = Column(
    "case", "Digest of the case; its command is in the list of cases.", "simulation.digest"
)
COMMAND = Column("command", "Runs the case again.", "simulation.case.command")


def quantity_column(key: str, *, shown: bool = True) -> Column:
    """Return the column of a quantity of a run, whose rows are evaluations."""
    quantity = QUANTITIES[key]
    return Column(key, quantity.meaning, quantity.of_run, shown=shown)


def without(columns: Iterable[Column], *names: str) -> tuple[Column, ...]:
    """Return columns, those named hidden from page and terminal; files have all columns."""
    return tuple(replace(c, shown=False) if c.name in names else c for c in columns)


def scene_table(
    scene: str,
    name: str,
    title: str,
    columns: Iterable[Column],
    records: Iterable[object],
    *hidden: str,
) -> Table:
    """Return a table of one scene, which begins its name; hidden columns are in files alone."""
    shown = without(columns, *hidden)
    return table_of(f"{scene}-{name}", title, shown, records, scene=scene)
