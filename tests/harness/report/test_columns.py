"""The dictionary in `reports/README.md` has every column of every table that is made."""

import pytest

from harness.core.errors import ReportError
from tests.columns_table import README, declared, section, with_section


def test_the_readme_is_as_the_code_declares() -> None:
    text = README.read_text(encoding="utf-8")
    again = "write it again with: python -m tests.columns_table"
    assert with_section(text) == text, again
    assert section() in text


def test_the_columns_of_every_part_are_known() -> None:
    known = declared()
    assert {"comparison", "gate", "report", "cost", "stability", "sweep"} <= set(known)
    assert {"scene", "angle_of_turn_error_deg", "allowed", "observed_order"} <= set(
        known["comparison"]
    )
    assert {"accepted", "tolerance"} <= set(known["gate"])
    assert {"stability_percent", "cause"} <= set(known["report"])


def test_a_text_without_marks_is_left_alone() -> None:
    with pytest.raises(ReportError):
        with_section("# Another text\n")
