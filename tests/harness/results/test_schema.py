"""The published schema: it is what the models say, and every committed result keeps to it."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from harness.results.errors import FILE
from harness.results.files import read_result, result_files, to_text
from harness.results.schema import SCHEMA, schema
from harness.results.schema import to_text as schema_text
from tests.support.gate_scores import make_score, make_scores

REPORTS = Path(__file__).parents[3] / "reports"
COMMITTED = [REPORTS / "baseline" / FILE, *sorted((REPORTS / "results").glob("*.json"))]


def violations(told: dict[str, Any]) -> list[str]:
    validator = jsonschema.Draft202012Validator(schema())
    return [error.message for error in validator.iter_errors(told)]


def test_the_file_is_current() -> None:
    jsonschema.Draft202012Validator.check_schema(schema())
    said = "write it anew: python -m harness.results.schema"
    assert SCHEMA.read_text(encoding="utf-8") == schema_text(), said


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.name)
def test_a_committed_result_keeps_to_it_and_is_written_as_it_was_read(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert violations(json.loads(text)) == []
    assert to_text(read_result(path)) == text


def test_each_submission_is_small() -> None:
    for path in COMMITTED[1:]:
        assert path.stat().st_size < 150_000, path.name


def test_a_result_made_by_hand_keeps_to_it() -> None:
    one = make_score({"steps": 1.0}, spread={"phi_rms_rad": None}, endings={"FLAT": 1})
    assert violations(json.loads(to_text(make_scores(one)))) == []


@pytest.mark.parametrize(
    "wrong",
    [
        {"version": 1},
        {"cases": [{}]},
        {"another": 1},
        {"inputs": {"gentle-rock": "short"}},
        {"settings": {"mujoco.cone": 1}},
        {"perturbed_by": ["1e-9"]},
        {"note": "two\nlines"},
    ],
)
def test_what_is_no_result_breaks_it(wrong: dict[str, object]) -> None:
    told = json.loads(to_text(make_scores(make_score())))
    assert violations(told | wrong)


def test_what_a_case_cannot_say_breaks_it() -> None:
    told = json.loads(to_text(make_scores(make_score())))
    for wrong in ({"outcome": "HAPPY"}, {"values": {"x": 1.0}}, {"endings": {"FLAT": 0}}):
        assert violations(told | {"cases": [told["cases"][0] | wrong]})


def test_fields_have_the_words_of_the_models() -> None:
    made = schema()
    assert made["properties"]["inputs"]["description"].startswith("Digests of the scenes")
    score = made["$defs"]["Score"]["properties"]
    assert {"description"} <= set(score["spread"])
    assert made["$defs"]["Division"]["enum"] == ["as shipped", "matched", "open"]


def test_files_are_named_by_files_and_folders(tmp_path: Path) -> None:
    for name in ("b.json", "a.json", "note.txt"):
        (tmp_path / name).write_text("{}", encoding="utf-8")
    files = (tmp_path / "a.json", tmp_path / "b.json")
    assert result_files([tmp_path, files[0]]) == files
