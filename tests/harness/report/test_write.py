"""The folder of a report: what is in it, and that it says what is in it."""

import hashlib
import json
import math
import signal
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Figure
from harness.core.writing import ForeignFolderError, UndrawnFiguresError
from harness.execution.isolated_pool import SerialExecutor
from harness.report.matplotlib_renderer import RenderedFigure
from harness.report.stored import read_report
from harness.report.style import LineStyle
from harness.report.write import write_chapters, write_report

TOP = {
    "index.html",
    "summary.md",
    "artefacts.json",
    "columns.md",
    "junit.xml",
    "manifest.json",
    "tables",
}


Write = Callable[..., Path]


@pytest.fixture
def write(artefacts: tuple[Artefact, ...], provenance: Provenance) -> Write:
    """Return `write_report` of artefacts of all kinds, for the folder and what a test varies."""
    return partial(write_report, artefacts, title="t", cases=(), provenance=provenance)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_every_file_is_there(report: Path) -> None:
    assert set(names(report)) == TOP
    assert names(report / "tables") == [
        f"{name}.{form}" for name in ("parity", "scorecard") for form in ("csv", "parquet")
    ]


def test_the_manifest_tells_every_other_file(report: Path, provenance: Provenance) -> None:
    manifest = json.loads((report / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["format"] == "rockingcan-report"
    assert manifest["provenance"] == provenance.to_dict()
    assert [case["digest"] for case in manifest["cases"]] == [
        "0123456789abcdef",
        "fedcba9876543210",
    ]
    found = {
        path.relative_to(report).as_posix(): path.read_bytes()
        for path in report.rglob("*")
        if path.is_file() and path.name != "manifest.json"
    }
    assert {file["path"]: (file["bytes"], file["sha256"]) for file in manifest["files"]} == {
        name: (len(content), hashlib.sha256(content).hexdigest()) for name, content in found.items()
    }


def test_the_same_report_gives_the_same_bytes(
    report: Path, artefacts: tuple[Artefact, ...], provenance: Provenance, tmp_path: Path
) -> None:
    told = json.loads((report / "manifest.json").read_text(encoding="utf-8"))
    page = write_report(
        artefacts,
        tmp_path / "again",
        title=told["title"],
        cases=told["cases"],
        provenance=provenance,
    )
    again = json.loads((page.parent / "manifest.json").read_text(encoding="utf-8"))
    assert again == told


@pytest.mark.slow
def test_figures_for_paper_are_drawn_once_and_alike_in_any_process(
    write: Write, artefacts: tuple[Artefact, ...], tmp_path: Path
) -> None:
    drawn = {}
    for cores in (1, 3):
        told: list[str] = []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("os.sched_getaffinity", lambda _, n=cores: set(range(n)))
            write(
                tmp_path / str(cores),
                figures=True,
                on_progress=lambda part, *_, told=told: told.append(part),
            )
        # thinned once and drawn once
        figures = [a.title for a in artefacts if isinstance(a, Figure)]
        assert [told.count(title) for title in figures] == [2, 2, 2]
        drawn[cores] = {p.name: p.read_bytes() for p in (tmp_path / str(cores)).glob("figures/*")}
    assert sorted(drawn[1]) == [
        f"{name}.{form}" for name in ("angles", "locus", "order") for form in ("png", "svg")
    ]
    assert drawn[1] == drawn[3]


@pytest.mark.slow
def test_what_stops_while_figures_are_drawn_leaves_no_report(write: Write, tmp_path: Path) -> None:
    def stop(part: str, done: int, total: int) -> None:
        assert 0 < done <= total
        if (tuple(tmp_path.glob(".*/figures/*.png"))) and part:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "report", figures=True, jobs=1, on_progress=stop)
    assert names(tmp_path) == []


def killed_at_the_locus(figure: Figure, inks: Mapping[str, LineStyle]) -> RenderedFigure:
    if figure.name == "locus":
        signal.raise_signal(signal.SIGKILL)
    return RenderedFigure(png=b"", svg=",".join(inks))


@pytest.mark.slow
def test_a_process_that_dies_costs_its_figure_and_no_other(
    write: Write,
    artefacts: tuple[Artefact, ...],
    provenance: Provenance,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("harness.report.matplotlib_renderer.render", killed_at_the_locus)
    out, told = tmp_path / "report", []
    with pytest.raises(UndrawnFiguresError, match="killed: SIGKILL") as caught:
        write(out, figures=True, jobs=1, on_progress=lambda *step: told.append(step))
    (title,) = (a.title for a in artefacts if isinstance(a, Figure) and a.name == "locus")
    assert caught.value.titles == (title,)
    assert str(caught.value) == (
        f"the report in '{out}' is written without the figures for paper of '{title}' "
        f"({caught.value.reason}); to draw them again: rockingcan report {out} --figures"
    )
    assert names(out / "figures") == ["angles.png", "angles.svg", "order.png", "order.svg"]
    page = (out / "index.html").read_text(encoding="utf-8")
    assert "figures/angles.png" in page
    assert "figures/locus" not in page
    assert told[-1][1] == told[-1][2]
    # the report is whole: the figure can be drawn from it
    monkeypatch.undo()
    write_chapters(read_report(out), out, title="t", provenance=provenance, figures=True, jobs=1)
    assert (out / "figures" / "locus.png").stat().st_size > 1000


def test_figures_are_drawn_in_as_many_processes_as_are_allowed(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[int] = []

    def executor(count: int, **_: object) -> SerialExecutor:
        started.append(count)
        return SerialExecutor()

    picture = RenderedFigure(png=b"", svg="")
    monkeypatch.setattr("harness.report.matplotlib_renderer.render", lambda *_: picture)
    monkeypatch.setattr("harness.report.write.local_executor", executor)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: set(range(8)))
    for jobs in (1, 2, 9, None):
        write(tmp_path / "report", figures=True, jobs=jobs)
    assert started == [1, 2, 3, 3]  # there are three figures


def test_progress_counts_every_part_to_the_end(write: Write, tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    write(tmp_path / "report", on_progress=lambda *step: told.append(step))
    assert [done for _, done, _ in told] == list(range(1, 3 + 2 + 1 + 1))
    assert {total for *_, total in told} == {6}
    assert told[-1][0] == "the page"


def test_the_summary_can_be_pasted(report: Path) -> None:
    text = (report / "summary.md").read_text(encoding="utf-8")
    assert text.startswith("# Two engines\n\nBoth engines agree.\n\nThe gap is of first order.\n")
    assert "| engine | angle of turn error (°) | steps | verdict | case |" in text
    assert "mujoco 4.0.0" in text
    assert "commit 000000000000 + changes" in text


def test_hostile_names_stay_in_the_folder(hostile_report: Path) -> None:
    assert set(names(hostile_report)) == TOP
    assert names(hostile_report.parent) == [hostile_report.name]
    for path in hostile_report.rglob("*"):
        assert set(path.stem) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")


def test_hostile_texts_stay_texts_in_the_summary(hostile_report: Path) -> None:
    for name in ("summary.md", "columns.md"):
        text = (hostile_report / name).read_text(encoding="utf-8")
        assert "owned" in text
        assert "<" not in text.replace("\\<", "")


def test_a_case_says_what_json_cannot(provenance: Provenance, tmp_path: Path) -> None:
    case = {
        "digest": "a",
        "solref": (0.02, np.float64(1.0)),
        "clamp": math.inf,
        "rows": np.int64(3),
    }
    write_report((), tmp_path / "report", title="", cases=[case], provenance=provenance)
    text = (tmp_path / "report" / "manifest.json").read_text(encoding="utf-8")
    assert json.loads(text, parse_constant=pytest.fail)["cases"] == [
        {"digest": "a", "solref": [0.02, 1.0], "clamp": "inf", "rows": 3}
    ]


def test_a_report_of_nothing_is_a_report(provenance: Provenance, tmp_path: Path) -> None:
    page = write_report((), tmp_path / "report", title="Nothing", cases=[], provenance=provenance)
    assert "Nothing" in page.read_text(encoding="utf-8")


def test_a_folder_of_something_else_is_refused(provenance: Provenance, tmp_path: Path) -> None:
    (tmp_path / "precious").touch()
    with pytest.raises(ForeignFolderError):
        write_report((), tmp_path, title="", cases=[], provenance=provenance)
    assert names(tmp_path) == ["precious"]
