"""A report can be read back, made again, and joined with others; nothing is lost on the way."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.core.provenance import Provenance
from harness.core.report_model import Figure, Heatmap, Panel, Table
from harness.core.verdict import Status, Verdict
from harness.report.layout import Section
from harness.report.stored import ReportVersionError, UnreadableReportError, read_report
from harness.report.write import write_chapters, write_report


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize("name", ["joined_report", "hostile_joined_report"])
def test_what_is_read_back_makes_the_same_report(
    name: str, request: pytest.FixtureRequest, provenance: Provenance, tmp_path: Path
) -> None:
    folder: Path = request.getfixturevalue(name)
    title = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["title"]
    write_chapters(read_report(folder), tmp_path / "again", title=title, provenance=provenance)
    assert contents(tmp_path / "again") == contents(folder)


def test_joining_what_was_written_apart_is_the_same_as_writing_it_together(
    study_sections: list[Section], joined_report: Path, provenance: Provenance, tmp_path: Path
) -> None:
    for number, chapter in enumerate(study_sections):
        write_report(
            chapter.artefacts,
            tmp_path / str(number),
            title=chapter.title,
            cases=chapter.cases,
            provenance=chapter.provenance,
        )
    parts = [
        chapter
        for number in range(len(study_sections))
        for chapter in read_report(tmp_path / str(number))
    ]
    write_chapters(parts, tmp_path / "together", title="All studies", provenance=provenance)
    assert contents(tmp_path / "together") == contents(joined_report)


def test_every_kind_of_cell_comes_back(provenance: Provenance, tmp_path: Path) -> None:
    frame = pd.DataFrame(
        {
            "float": [0.1 + 0.2, np.nan, np.inf, -np.inf],
            "whole": [1, 2, 3, 2**53 + 1],
            "holes": [1, None, 3, 4],
            "truth": [True, False, True, False],
            "perhaps": pd.Series([True, None, False, None], dtype=object),
            "text": ["a", None, "", "ünï"],
            "verdict": [Verdict(status, f"{status.value}: why") for status in list(Status)[:4]],
            "mixed": pd.Series([1, "one", None, 1.5], dtype=object),
        }
    )
    heat = Heatmap(label="h", x=np.arange(3.0), y=np.arange(4.0), z=np.arange(6.0).reshape(3, 2))
    panel = Panel(title="p", x_label="x", y_label="y", series=(), heat=heat, x_range=(0.0, 1.0))
    figure = Figure(name="f", title="f", seen="", panels=(panel,))
    write_report(
        (Table(name="t", title="t", frame=frame, columns={}), figure),
        tmp_path / "report",
        title="t",
        cases=(),
        provenance=provenance,
    )
    (chapter,) = read_report(tmp_path / "report")
    table, drawn = chapter.artefacts
    assert isinstance(table, Table)
    assert isinstance(drawn, Figure)
    pd.testing.assert_frame_equal(table.frame, frame, check_exact=True)
    assert drawn.panels[0].x_range == (0.0, 1.0)
    assert drawn.panels[0].heat is not None
    np.testing.assert_array_equal(drawn.panels[0].heat.z, heat.z)
    assert chapter.provenance.to_dict() == provenance.to_dict()


def test_a_folder_without_a_report_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnreadableReportError) as caught:
        read_report(tmp_path)
    assert caught.value.path == tmp_path / "artefacts.json"
    assert isinstance(caught.value.__cause__, FileNotFoundError)


@pytest.mark.parametrize(
    "text", ["no json", "[]", "{}", '{"version": 2}', '{"version": 2, "chapters": [3]}']
)
def test_a_broken_record_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "artefacts.json").write_text(text)
    with pytest.raises(UnreadableReportError) as caught:
        read_report(tmp_path)
    assert caught.value.path == tmp_path / "artefacts.json"
    assert not isinstance(caught.value.__cause__, OSError)  # there is a file, but no record


@pytest.mark.parametrize("version", [1, 3])
def test_another_version_is_refused(version: int, joined_report: Path, tmp_path: Path) -> None:
    told = json.loads((joined_report / "artefacts.json").read_text(encoding="utf-8"))
    (tmp_path / "artefacts.json").write_text(json.dumps(told | {"version": version}))
    with pytest.raises(ReportVersionError) as caught:
        read_report(tmp_path)
    assert caught.value.version == version


def test_a_case_of_two_studies_is_listed_once(
    joined_report: Path, study_sections: list[Section]
) -> None:
    manifest = json.loads((joined_report / "manifest.json").read_text(encoding="utf-8"))
    digests = [case["digest"] for case in manifest["cases"]]
    assert len(digests) == len(set(digests)) == 3
    assert sum(len(chapter.cases) for chapter in study_sections) == 4
