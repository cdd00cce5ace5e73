"""`rockingcan report`: reports that exist become one page, and nothing is run."""

import json
from pathlib import Path

import pandas as pd
import pytest

from harness.cli.main import code_of
from harness.core.provenance import provenance
from harness.core.report_model import Prose, Table
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.report.write import write_report


def written(out: Path, name: str) -> Path:
    """Write a report with a text, a table and a case."""
    told = Table(
        name=f"{name}-numbers",
        title=f"Numbers of {name}",
        frame=pd.DataFrame({"turn_deg": [209.36]}),
        columns={"turn_deg": "Angle of turn."},
    )
    text = Prose(name="summary", title="Summary", text=f"What {name} found.")
    case = {"digest": name, "label": name, "command": f"rockingcan run {name}"}
    write_report((text, told), out / name, title=name, cases=[case], provenance=provenance())
    return out / name


def test_reports_are_joined_without_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first, second = (written(tmp_path, name) for name in ("first", "second"))
    monkeypatch.setattr(IsolatedProcessPool, "submit", lambda *_: pytest.fail("something was run"))
    out = tmp_path / "all"
    assert code_of(["report", str(first), str(second), "--out", str(out)]) == 0
    assert "2 studies in one report" in capsys.readouterr().out
    page = (out / "index.html").read_text(encoding="utf-8")
    for words in ("What first found.", "What second found.", "Numbers of first"):
        assert words in page
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    assert [case["digest"] for case in manifest["cases"]] == ["first", "second"]
    assert code_of(["report", str(out), str(first), "--out", str(tmp_path / "more")]) == 0
    assert "3 studies in one report" in capsys.readouterr().out


def test_a_folder_is_named_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "all[" / "b]"  # to rich the end of something bold
    assert code_of(["report", str(written(tmp_path, "first")), "--out", str(out)]) == 0
    assert str(out / "index.html") in capsys.readouterr().out


def test_a_folder_without_a_report_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty").mkdir()
    out = tmp_path / "all"
    assert code_of(["report", str(tmp_path / "empty"), "--out", str(out)]) == 2
    assert "name the folder of a report, such as reports/latest" in capsys.readouterr().err
    assert not out.exists()


def test_validate_refuses_a_missing_report_before_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        "harness.cli.validate.run_with_progress", lambda *_, **__: pytest.fail("it ran")
    )
    words = ["validate", "--with", str(tmp_path / "none"), "--out", str(tmp_path / "out")]
    assert code_of(words) == 2
    assert "cannot read" in capsys.readouterr().err
