"""Names that mean harm where they are free: paths, citations, tables, figures, settings."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.core.provenance import provenance
from harness.core.report_model import Figure, Panel, Prose, Series, Table
from harness.report.write import write_report
from models import load
from models.errors import ModelError
from models.to_mjcf import mjcf
from models.to_urdf import urdf
from tests.fuzz.verdict import WRONG_USE, judged

HARM = (
    "../../escaped",
    "/escaped",
    "..\\escaped",
    "<script>alert(1)</script>",
    '"/><geom name="x"',
    "</script><script>alert(1)</script>",
    "=cmd|' /C calc'!A0",
    "\x1b[31mred\x1b[0m",
    "nul\x00byte",
    "\u202egnp.exe",
    "x" * 200,
    "[bold]loud[/]",
    "{{ 7 * 7 }}",
    "javascript:alert(1)",
    "' onmouseover='alert(1)",
    "",
    ".",
    "..",
)


@pytest.mark.slow
@pytest.mark.parametrize("harm", HARM)
def test_a_report_keeps_to_its_folder_and_runs_nothing(tmp_path: Path, harm: str) -> None:
    x = np.array([0.0, 1.0])
    series = Series(label=harm, kind=harm, x=x, y=x, hover=(harm, harm))
    panel = Panel(title=harm, x_label=harm, y_label=harm, series=(series,))
    frame = pd.DataFrame({"text": [harm], "number_m": [1.0]})
    out = tmp_path / "inside" / "report"
    write_report(
        [
            Figure(name=harm, title=harm, seen=harm, panels=(panel,), scene=harm),
            Table(
                name=harm,
                title=harm,
                frame=frame,
                columns={"text": harm, "number_m": harm},
                scene=harm,
            ),
            Prose(name=harm, title=harm, text=harm, scene=harm),
        ],
        out,
        title=harm,
        cases=[{"digest": harm, "label": harm, "command": harm}],
        provenance=provenance(),
    )
    everything = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert all(path.is_relative_to(out) for path in everything)
    assert all(re.fullmatch(r"[a-z0-9.-]+", path.name) for path in everything)
    page = (out / "index.html").read_text(encoding="utf-8", errors="replace")
    for alive in ("<script>alert", "onmouseover='alert", 'href="javascript', "<geom", ">49<"):
        assert alive not in page
    for path in out.rglob("*.csv"):
        cells = path.read_text(encoding="utf-8", errors="replace").splitlines()[1].split(",")
        assert not cells[0].strip('"').startswith(("=", "+", "-", "@"))
    for path in out.rglob("*.svg"):
        root = ET.fromstring(path.read_text(encoding="utf-8"))  # noqa: S314 - of our own making
        assert not [e for e in root.iter() if e.tag.endswith("}script") or e.tag == "script"]


@pytest.mark.parametrize("harm", HARM)
def test_a_citation_does_not_reach_a_model(harm: str) -> None:
    try:
        scene = replace(load("gentle-rock"), cite=harm)
    except ModelError:
        return
    for text, plain in (
        (mjcf(scene), mjcf(load("gentle-rock"))),
        (urdf(scene), urdf(load("gentle-rock"))),
    ):
        assert text == plain


@pytest.mark.parametrize("harm", [harm for harm in HARM if "\x00" not in harm])
def test_where_a_name_is_asked_for_harm_is_refused(tmp_path: Path, harm: str) -> None:
    out = str(tmp_path / "out")
    for words in (
        ["reference", harm, "--json"],
        ["export", harm, "--format", "urdf"],
        ["export", "gentle-rock", "--format", harm],
        ["run", "gentle-rock", "--engine", harm],
        ["run", "gentle-rock", "--engine", "mujoco", "--profile", harm],
        ["run", "gentle-rock", "--engine", "mujoco", "--set", f"{harm}=1"],
        ["run", "gentle-rock", "--engine", "mujoco", "--set", f"cone={harm}"],
        ["sweep", "gentle-rock", "--over", f"{harm}=1:2:3", "--out", out],
        ["sweep", "gentle-rock", "--over", "can.h=1:2:3", "--quantity", harm, "--out", out],
    ):
        verdict = judged(words)
        assert (verdict.code, verdict.fault) == (WRONG_USE, ""), words
    assert list(tmp_path.iterdir()) == []
