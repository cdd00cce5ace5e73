"""The pages of the field guide: their programs print what stands there, their scenes are run."""

import re
from pathlib import Path

import pytest

from docs.formatting import ROOT
from docs.numbers import GUIDE, PAGES, facts
from models.catalogue import field_names, load
from tests.docs.programs import check_program, engine_of, sections
from tests.support.command_line import Command

SECTIONS = ["In short", "Complaint", "What is exact", "Scene", "Cure", "Minimal program"]
OPTIONAL = "What engines do"
STATUS = {"happens", "mended", "not run", "not so"}
"""What a page may say of its complaint; docs/field-guide/README.md explains the words."""

ADDRESS = re.compile(
    r"^\[([\w.-]+/[\w.-]+)#(\d+)\]\(https://github\.com/\1/(?:issues|pull)/\2\)", re.MULTILINE
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "page"),
    [(engine_of(page.read_text(encoding="utf-8")), page) for page in PAGES],
    ids=lambda value: getattr(value, "stem", value),
)
def test_a_program_prints_what_is_said(engine: str, page: Path) -> None:
    assert engine
    check_program(page.read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_has_its_thread_and_its_sections(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert re.match(r"# [^:\n]+: .+\n", text)
    assert ADDRESS.search(text)
    assert [title for title in sections(text) if title != OPTIONAL] == SECTIONS
    said = re.findall(r"^- (\w+): (.+)$", text, re.MULTILINE)[:4]
    assert [part for part, _ in said] == ["status", "exact", "happens", "cure"]
    assert dict(said)["status"] in STATUS


def test_the_guide_explains_each_status() -> None:
    text = (GUIDE / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^- \*([\w ]+)\*: ", text, re.MULTILINE)) == STATUS


def test_readme_lists_just_what_still_happens() -> None:
    rows = {page for page in PAGES if f"({page.relative_to(ROOT)})" in facts("guide")["table"]}
    said = {page for page in PAGES if "\n- status: happens\n" in page.read_text(encoding="utf-8")}
    assert rows == said


def test_there_are_pages_for_sixteen_threads() -> None:
    threads = {ADDRESS.search(page.read_text(encoding="utf-8")) for page in PAGES}
    assert len({found[0] for found in threads if found}) >= 16


def test_every_scene_of_the_guide_has_a_page_and_its_exact_motion(rockingcan: Command) -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for name in field_names():
        assert f"models/scenes/field/{name}.toml" in text
        assert f"<!-- = field.{name} -->" in text
        assert load(name).name == name
        assert rockingcan("reference", name, "--json").code == 0
