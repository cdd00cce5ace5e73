"""The dictionary of all columns, for `reports/README.md`.

Written by `python -m tests.columns_table`.

Studies declare their columns as tuples of `Column`, or as dictionaries from name to meaning, where
they make their tables; this gathers the declarations, so that no list has to be kept beside them.
"""

import importlib
import pkgutil
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import TypeGuard

import harness
from harness.core.errors import ReportError
from harness.core.report_model import Column, Table
from harness.report.tables import plain_text

README = Path(__file__).parents[1] / "reports" / "README.md"

BEGIN, END = "<!-- columns: begin -->\n", "<!-- columns: end -->\n"

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PACKAGES = ("harness.studies", "harness.paper", "harness.sweep", "harness.report", "harness.gate")
_OPTIONAL = ("sympy", "mpmath")


def declared() -> dict[str, dict[str, str]]:
    """Return by the part of the harness that makes them the columns of its tables."""
    found: dict[str, dict[str, str]] = {}
    for module in _modules():
        if not any(getattr(module, kind.__name__, None) is kind for kind in (Table, Column)):
            continue
        own = {
            column: meaning
            for value in vars(module).values()
            for column, meaning in _columns(value).items()
        }
        if own:
            found.setdefault(_part(module), {}).update(own)
    return {part: dict(sorted(columns.items())) for part, columns in sorted(found.items())}


def _columns(value: object) -> Mapping[str, str]:
    """Return the columns that a value declares, with their meanings."""
    if isinstance(value, tuple) and all(isinstance(item, Column) for item in value):
        return {column.name: column.meaning for column in value}
    return value if _is_dictionary(value) else {}


def section() -> str:
    """Return the dictionary in Markdown, between its marks."""
    lines = [BEGIN]
    for part, columns in declared().items():
        lines.append(f"\n### {part}\n\n| Column | Meaning |\n| --- | --- |\n")
        lines += [
            f"| `{column}` | {plain_text(meaning)} |\n" for column, meaning in columns.items()
        ]
    return "".join([*lines, "\n", END])


def with_section(text: str) -> str:
    """Return a text with the dictionary put anew between its marks.

    Raises
    ------
    ReportError
        If the text has no marks, so that nobody can say where it belongs.
    """
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ReportError(f"no lines '{BEGIN.strip()}' and '{END.strip()}' to write between")
    return before + section() + after


def _modules() -> Iterator[ModuleType]:
    """Yield the modules that may make tables, without what needs an extra package."""
    for package in (importlib.import_module(name) for name in _PACKAGES):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            try:
                yield importlib.import_module(found.name)
            except ImportError as error:
                if (error.name or "").partition(".")[0] not in _OPTIONAL:
                    raise


def _part(module: ModuleType) -> str:
    """Return what a person calls the part: a study, or the report, the gate, the sweep."""
    words = module.__name__.removeprefix(f"{harness.__name__}.").split(".")
    return words[1] if words[0] in {"studies", "paper"} else words[0]


def _is_dictionary(value: object) -> TypeGuard[Mapping[str, str]]:
    """Return whether a value says of columns what they mean: names, and sentences."""
    if not isinstance(value, Mapping) or not value:
        return False
    if not all(isinstance(name, str) and _NAME.fullmatch(name) for name in value):
        return False
    texts = list(value.values())
    sentences = [t for t in texts if isinstance(t, str) and (t[:1].isupper() or ": " in t)]
    return len(sentences) == len(texts) and all(" " in str(text) for text in texts)


if __name__ == "__main__":
    README.write_text(with_section(README.read_text(encoding="utf-8")), encoding="utf-8")
