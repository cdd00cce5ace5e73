"""`rockingcan audit`: what it writes, and what it says when it cannot."""

import csv
import sys
from pathlib import Path

import pytest

from harness.cli.paper import MissingMathematicsError, audit
from harness.core.writing import WriteError
from harness.paper.audit import CLAIMS


def test_without_sympy_one_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # as if the module that needs sympy had never been imported and could not be
    monkeypatch.setitem(sys.modules, "harness.paper.audit.checks", None)
    monkeypatch.setenv("PATH", "")  # no pip of another environment is meant
    with pytest.raises(MissingMathematicsError) as caught:
        audit(tmp_path)
    assert caught.value.install.endswith("-m pip install 'rockingcan[paper]'")
    assert not list(tmp_path.iterdir())


def test_a_file_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine", encoding="utf-8")
    with pytest.raises(WriteError) as caught:
        audit(tmp_path / "taken")
    assert caught.value.path == tmp_path / "taken"


def test_both_files_are_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = tuple(claim for claim in CLAIMS if claim.label in {"eq:phistar", "text:R_GB"})
    monkeypatch.setattr("harness.cli.paper.CLAIMS", few)
    audit(tmp_path / "new", tmp_path / "page")
    assert "false as printed" in capsys.readouterr().out
    assert "R_ij converts frame i to frame j" in (tmp_path / "new" / "audit.md").read_text(
        encoding="utf-8"
    )
    with (tmp_path / "new" / "audit.csv").open(encoding="utf-8") as file:
        rows = {row["label"]: row["verdict"] for row in csv.DictReader(file)}
    assert rows == {"eq:phistar": "holds", "text:R_GB": "false as printed"}
    page = (tmp_path / "page" / "index.html").read_text(encoding="utf-8")
    assert "Of 2 claims of the paper: 1 holds, 1 false as printed." in page
    assert "The first that is wrong is text:R_GB." in page
