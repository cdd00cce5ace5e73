"""The programs of the findings print what is printed below them."""

import re
from pathlib import Path

import pytest

from tests.docs.programs import check_program, sections

FOLDER = Path(__file__).parents[2] / "docs" / "findings"
SECTIONS = ["Symptom", "Cause", "Minimal program", "Cure", "How rockingcan tells it"]
FINDINGS = sorted(path for path in FOLDER.glob("*.md") if path.name != "README.md")


@pytest.mark.parametrize(
    ("engine", "path"),
    [(path.name.partition("-")[0], path) for path in FINDINGS],
    ids=lambda value: getattr(value, "stem", value),
)
def test_a_program_prints_what_is_said(engine: str, path: Path) -> None:
    assert engine
    text = path.read_text(encoding="utf-8")
    assert sections(text) == SECTIONS
    check_program(text)


def test_each_finding_is_listed_by_its_title() -> None:
    listed = re.findall(
        r"^- \[(.*)\]\((.*)\)$", (FOLDER / "README.md").read_text("utf-8"), re.MULTILINE
    )
    titles = [path.read_text(encoding="utf-8").splitlines()[0] for path in FINDINGS]
    assert sorted(listed) == sorted(
        (title.removeprefix("# "), path.name) for title, path in zip(titles, FINDINGS, strict=True)
    )
