"""The published JSON schema of a result, made from its models.

`python -m harness.results.schema` writes it anew; a test holds the file equal to what is generated.
"""

import inspect
import json
import re
from pathlib import Path
from typing import Any

from harness.execution.atomic_write import write_atomically
from harness.results.result import VERSION, EngineRelease, Machine, Made, Program, Result
from harness.results.scores import Division, Part, Score

SCHEMA = Path(__file__).parents[1] / "report" / "schema" / f"result-{VERSION}.json"

_MODELS: tuple[type[Part], ...] = (EngineRelease, Machine, Made, Program, Score)


def schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a file of results."""
    made = Result.model_json_schema()
    _describe(made, Result)
    for model in _MODELS:
        _describe(made["$defs"][model.__name__], model)
    division = made["$defs"][Division.__name__]
    division["description"] = _summary(Division)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:rockingcan:{SCHEMA.stem}",
        **made,
        "title": f"Result of rockingcan, version {VERSION}",
    }


def to_text() -> str:
    """Return the content of the file of the schema."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def _summary(declared: type) -> str:
    return inspect.getdoc(declared).partition("\n\n")[0].replace("\n", " ")  # type: ignore[union-attr] # house style


def _describe(made: dict[str, Any], model: type[Part]) -> None:
    """Give the schema of a model and of its fields the words of the docstring."""
    made["description"] = _summary(model)
    text = (inspect.getdoc(model) or "").partition("Parameters\n----------\n")[2]
    for names, words in re.findall(r"^(\w[\w, ]*?)(?: :.*)?\n((?:    .*\n?)+)", text, re.MULTILINE):
        for name in names.split(", "):
            made["properties"][name]["description"] = " ".join(words.split())


if __name__ == "__main__":
    SCHEMA.parent.mkdir(exist_ok=True)
    write_atomically(SCHEMA, to_text().encode())
