"""The report of what accuracy costs, with every case that was run for it."""

from pathlib import Path

from harness.provenance import provenance
from harness.report import write_report
from harness.studies.cost import Cost, read
from harness.studies.cost.hard_tables import hard_command
from harness.studies.cost.points import Point


def cost_report(found: Cost, folder: Path) -> Path:
    """Write the report of a study and return its page."""
    return write_report(
        read(found),
        folder,
        title=f"rockingcan, what accuracy costs: {found.plan.scene.name}",
        cases=[
            *(_case(point, point.command) for point in found.points),
            *(
                _case(point, hard_command(point))
                for _, ladders in found.hardness
                for _, ladder in ladders
                for point in ladder
            ),
        ],
        provenance=provenance(),
    )


def _case(point: Point, command: str) -> dict[str, str]:
    """Return a case as the manifest says it."""
    return {
        "digest": point.digest,
        "label": point.case.label(),
        "command": command,
        "engine": point.case.engine,
        "engine_version": point.version,
        "outcome": point.outcome.value,
    }
