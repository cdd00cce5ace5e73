"""The dictionary in `reports/README.md` has every column of every table that is made."""

import ast
from pathlib import Path

import pytest

import harness
from harness.core.errors import ReportError
from harness.report.columns import declared, section, with_section

ROOT = Path(harness.__file__).parent
README = ROOT.parent / "reports" / "README.md"


def test_the_readme_is_as_the_code_declares() -> None:
    text = README.read_text(encoding="utf-8")
    again = "write it again with: python -m harness.report.columns reports/README.md"
    assert with_section(text) == text, again
    assert section() in text


def test_every_table_that_is_made_has_its_columns_in_it() -> None:
    """Each call that makes a table names a dictionary, and all its names are known."""
    known = {column for columns in declared().values() for column in columns}
    made = 0
    for path in (*(ROOT / "studies").rglob("*.py"), *(ROOT / "report").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        given = {
            target.id: node.value
            for node in ast.walk(tree)
            if isinstance(node, (ast.Assign, ast.AnnAssign))
            for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
            if isinstance(target, ast.Name)
        }
        for call in ast.walk(tree):
            if not (isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Table"):
                continue
            columns = next(word.value for word in call.keywords if word.arg == "columns")
            node = given.get(columns.id) if isinstance(columns, ast.Name) else columns
            if isinstance(node, ast.Dict):
                made += 1
                names = {key.value for key in node.keys if isinstance(key, ast.Constant)}
                assert names <= known, (path, names - known)
    assert made > 15  # of some 25 tables; the others put theirs together from these


def test_a_text_without_marks_is_left_alone() -> None:
    with pytest.raises(ReportError, match="to write between"):
        with_section("# Another text\n")
