"""A verdict has a status that programs read and a text that people read; a column says it once."""

import pytest

from harness.cli.terminal import to_json
from harness.core.report_model import Column, rows_of, table_of
from harness.core.verdict import Status, Verdict


def test_no_status_both_passes_and_fails() -> None:
    assert not any(status.passed and status.failed for status in Status)
    assert {status for status in Status if status.passed} == {
        Status.AGREES,
        Status.SAME,
        Status.BETTER,
    }
    assert {status for status in Status if status.failed} == {
        Status.DEVIATES,
        Status.FAILED,
        Status.WORSE,
        Status.MISSING,
    }


def test_a_verdict_reads_as_its_text() -> None:
    verdict = Verdict(Status.DEVIATES, "off by a factor 3")
    assert str(verdict) == "off by a factor 3"
    assert '"verdict": "off by a factor 3"' in to_json({"verdict": verdict})


def test_a_table_follows_from_its_columns() -> None:
    columns = (
        Column(
            "turn_deg", "Angle of turn.", lambda run: run["turn"], verdict="judged", case="case"
        ),
        Column("judged", "Verdict on it.", shown=False),
        Column("case", "Digest.", shown=False),
    )
    runs = [{"turn": 3.0, "judged": "agrees", "case": "0123"}, {"turn": 4.0}]
    table = table_of("t", "T", columns, runs, scene="petals")
    assert list(table.frame.columns) == list(table.columns) == ["turn_deg", "judged", "case"]
    assert table.shown == ("turn_deg",)
    assert (table.verdicts, table.cases) == ({"turn_deg": "judged"}, {"turn_deg": "case"})
    assert table.scene == "petals"
    assert table.frame["turn_deg"].tolist() == [3.0, 4.0]
    assert rows_of(columns, runs)[1] == {"turn_deg": 4.0, "judged": None, "case": None}


def test_a_record_without_the_field_is_an_error() -> None:
    with pytest.raises(AttributeError):
        Column("steps", "Steps.").cell(object())
