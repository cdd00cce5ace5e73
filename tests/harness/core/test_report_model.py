"""The cell of a column: from a path, a method, a function, or a mapping that has it already."""

from dataclasses import dataclass

import pytest

from harness.core.report_model import Column, rows_of, table_of


@dataclass(frozen=True)
class Limit:
    """A number with a method that needs no argument."""

    value: float

    def label(self) -> str:
        """Return it in words."""
        return f"{self.value:g} s"


@dataclass(frozen=True)
class Record:
    """What a row is of."""

    limit: Limit | None


WHOLE, EMPTY = Record(Limit(2.5)), Record(None)


@pytest.mark.parametrize(
    ("value", "of_whole", "of_empty"),
    [("limit.value", 2.5, None), ("limit.label", "2.5 s", None), (repr, repr(WHOLE), repr(EMPTY))],
)
def test_a_cell_is_read_by_path_method_or_function(
    value: str, of_whole: object, of_empty: object
) -> None:
    column = Column("limit_s", "A limit.").of(value)
    assert (column.cell(WHOLE), column.cell(EMPTY)) == (of_whole, of_empty)


def test_a_mapping_gives_the_cell_of_its_own_name_before_any_path() -> None:
    column = Column("limit_s", "A limit.", "record.limit.value")
    rows = [{"record": WHOLE}, {"record": WHOLE, "limit_s": 7.0}, {"record": EMPTY}, {}]
    assert [row["limit_s"] for row in rows_of((column,), rows)] == [2.5, 7.0, None, None]
    assert table_of("t", "T", (column,), rows).frame["limit_s"].tolist()[:2] == [2.5, 7.0]
