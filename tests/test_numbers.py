"""Every number in README, CONTRIBUTING and the docs comes from a file that a command wrote."""

import json
import re

import pytest

from docs.formatting import ROOT
from docs.measure import KEPT, measured
from docs.numbers import MARKED, TEXTS, filled
from harness.core.errors import HarnessError
from harness.engines.registry import engine
from tests.support.engines import INSTALLED

STATED = {
    "2302.08335": "the number of the paper at arXiv",
    "3.11": "a version of Python",
    "3.12": "a version of Python",
    "3.13": "a version of Python",
    "80": "a rule on the length of files",
    "250": "a rule on the length of files",
    "400": "a rule on the length of files, which a test holds",
}
"""Numbers that nobody measures, with what they are."""


@pytest.mark.parametrize("name", TEXTS)
def test_the_numbers_are_those_of_the_files(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert filled(text) == text, "run `make numbers`"


MEASURED = (
    *("README.md", "docs/index.md", "docs/start.md", "docs/how-to/gate.md"),
    *(name for name in TEXTS if name.startswith("docs/results/")),
)
"""Texts that say what was measured, and nothing else in numbers."""


@pytest.mark.parametrize("name", MEASURED)
def test_what_was_measured_has_numbers_to_fill(name: str) -> None:
    assert name == "docs/results/robustness.md" or MARKED.search(
        (ROOT / name).read_text(encoding="utf-8")
    )


@pytest.mark.parametrize("name", [*MEASURED, "CONTRIBUTING.md"])
def test_no_other_number_stands_there(name: str) -> None:
    text = MARKED.sub(" ", (ROOT / name).read_text(encoding="utf-8"))
    # code, inputs of commands and addresses are not measured
    for code in (r"```.*?```", r"^ {4}.*$", r"`[^`]*`", r"\]\([^)]*\)"):
        text = re.sub(code, " ", text, flags=re.DOTALL if "```" in code else re.MULTILINE)
    numbers = re.findall(r"(?<![\w.])\d(?:[\d.,]*\d)?(?:e-?\d+)?", text)
    assert [number for number in numbers if number not in STATED] == []


@pytest.mark.parametrize("name", TEXTS)
def test_no_line_of_prose_begins_with_a_mark(name: str) -> None:
    """There a comment would begin a block of HTML, and end the paragraph."""
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if re.match(r"<!-- (= [\w.-]+|/) -->.", line)] == []


@pytest.mark.parametrize("name", ["quick.tables", "nothing.at_all"])
def test_a_number_that_no_source_has_is_an_error_that_names_it(name: str) -> None:
    with pytest.raises(HarnessError, match=name):
        filled(f"<!-- = {name} -->1<!-- / -->")


@pytest.mark.parametrize("name", measured())
def test_each_file_was_written_by_the_command_that_is_named(name: str) -> None:
    what = measured()[name]
    made = json.loads((KEPT / name / "made.json").read_text(encoding="utf-8"))
    assert made["command"] == what.command
    kept = {path.name for path in (KEPT / name).iterdir()}
    assert kept == {"made.json", *(file.rpartition("/")[2] for file in what.files)}


@pytest.mark.parametrize("name", INSTALLED)
def test_the_table_of_effects_tells_of_the_engine_as_it_is(name: str) -> None:
    files = [KEPT / each / "printed.json" for each in ("capabilities", "capabilities-physx")]
    told = [one for file in files for one in json.loads(file.read_text())["engines"]]
    able = engine(name).capabilities
    (own,) = [one for one in told if one["name"] == name and one["installed"]]
    assert own["honours"] == sorted(able.honours), "run `python -m docs.measure capabilities`"
    assert own["imposes"] == dict(able.imposes), "run `python -m docs.measure capabilities`"
