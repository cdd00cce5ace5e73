"""A table row by row, as the report reads what studies wrote."""

from collections.abc import Mapping

from harness.artefact import Table
from harness.report.digits import is_missing
from harness.report.tables import rows

Row = Mapping[str, object]


def records(table: Table) -> list[Row]:
    """Return each row by column name; what is missing is None."""
    names = [str(name) for name in table.frame.columns]
    return [
        {name: None if is_missing(value) else value for name, value in zip(names, row, strict=True)}
        for row in rows(table.frame)
    ]
