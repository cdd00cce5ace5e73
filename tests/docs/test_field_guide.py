"""The pages of the field guide: their programs print what stands there, their scenes are run."""

import math
import re
from pathlib import Path

import pytest

from docs.field_guide import GUIDE, PAGES
from harness.engines.reference.to_reference_problem import problem
from models.catalogue import field_names, load
from reference import solve
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


def test_the_guide_lists_first_what_still_happens() -> None:
    text = (GUIDE / "README.md").read_text(encoding="utf-8")
    first, others = text.split("## What was mended")
    still = {page for page in PAGES if "\n- status: happens\n" in page.read_text(encoding="utf-8")}
    assert {page for page in PAGES if f"({page.name})" in first} == still
    assert {page for page in PAGES if f"({page.name})" in others} == set(PAGES) - still


NUMBER = re.compile(r"(?<![\w.^#])[+-]?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w|\.\d)")
"""A number with its digits; no version (2.2.1), no thread (#1540), no power (m^2)."""


def unproved(text: str) -> list[str]:
    """Return the numbers that a page says in short and that have no source in it.

    A source is what the program prints, a table or what is exact; of a setting in backticks, the
    program too.
    """
    short, exact = (
        re.findall(rf"^## {title}$(.*?)^## ", text, re.MULTILINE | re.DOTALL)[0]
        for title in ("In short", "What is exact")
    )
    printed = re.findall(r"```text\n(.*?)```", text, re.DOTALL)
    program = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    tables = re.findall(r"^\|.*$", text, re.MULTILINE)
    proof = NUMBER.findall("\n".join([exact, *printed, *tables]))
    settings = NUMBER.findall("\n".join([*program, *printed]))
    told = [(each, proof) for each in NUMBER.findall(re.sub("`[^`]*`", "", short))]
    told += [(each, settings) for each in NUMBER.findall(" ".join(re.findall("`[^`]*`", short)))]
    # "0.42 m/s" may stand for a -0.42 that is printed, but not "-0.15" for a 0.15
    return [n for n, known in told if not {n, f"+{n}", f"-{n}"} & set(known)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_each_number_in_short_stands_elsewhere_in_its_page(page: Path) -> None:
    assert unproved(page.read_text(encoding="utf-8")) == []


def test_a_number_that_stands_nowhere_else_is_found() -> None:
    page = """# Engine: a complaint
## In short
- happens: {} m/s with `iterations={}` in 2.2.1, {} rad/s^2
- cure: 7.0 m
## What is exact
It is 7.0 m.
## Scene
It is 8.0 m.
| 0.42 |
```python
run(iterations=50)
```
```text
slip -0.15 m/s
```
"""
    assert unproved(page.format("0.42", "50", "0.15")) == []
    assert unproved(page.format("-0.15", "50", "0.42")) == []
    assert unproved(page.format("0.4", "60", "+0.15")) == ["0.4", "+0.15", "60"]
    assert unproved(page.format("8.0", "50", "50")) == ["8.0", "50"]


def test_mujoco_1040_quotes_the_exact_tilt() -> None:
    scene = load("gentle-rock")
    time = 0.4 / math.sqrt(scene.can.radius / scene.gravity)  # of 0.4 s, in sqrt(R/g)
    (tilt,) = solve(problem(scene, 0.5)).at(time).phi
    assert f"{tilt:.3f} rad 0.4 s later" in (GUIDE / "mujoco-1040.md").read_text(encoding="utf-8")


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
