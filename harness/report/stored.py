"""Artefacts as one file, so that a page can be made again, and of several studies together.

`artefacts.json` holds what the page was made of: tables with every digit, curves as the page shows
them, as base64 of little-endian doubles. What is read back makes the same page, byte for byte.

Values in JSON's own types.
"""

import base64
import json
import math
import numbers
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd

from harness.core.errors import ReportError
from harness.core.provenance import Commit, Provenance
from harness.core.report_model import (
    Artefact,
    Body,
    Figure,
    Floats,
    Heatmap,
    Panel,
    Prose,
    Replay,
    Series,
    Table,
)
from harness.report.number_format import is_missing
from harness.report.section import Section


def to_plain(value: object) -> object:
    """Return a value in JSON's own types: what JSON cannot say, infinity included, as text."""
    if isinstance(value, Mapping):
        return {str(key): to_plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_plain(inner) for inner in value]
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real) and math.isfinite(value):
        return float(value)
    return str(value)


ARTEFACTS = "artefacts.json"
VERSION = 1
"""Of the file; a later one is refused by an earlier reader."""

_KINDS: Mapping[str, type[Artefact]] = {
    "figure": Figure,
    "table": Table,
    "prose": Prose,
    "replay": Replay,
}
_Part = Panel | Series | Body | Heatmap

_NESTED: Mapping[str, type[_Part]] = {
    "panels": Panel,
    "series": Series,
    "bodies": Body,
}


def to_json(chapters: Sequence[Section]) -> str:
    """Return chapters as the text of `artefacts.json`."""
    told = {
        "format": "rockingcan-artefacts",
        "version": VERSION,
        "chapters": [
            {
                "title": chapter.title,
                "provenance": chapter.provenance.to_dict(),
                "cases": [to_plain(case) for case in chapter.cases],
                "artefacts": [_artefact(artefact) for artefact in chapter.artefacts],
            }
            for chapter in chapters
        ],
    }
    return json.dumps(told, ensure_ascii=False, allow_nan=False, separators=(",", ":")) + "\n"


def read_report(folder: Path) -> tuple[Section, ...]:
    """Return the chapters of a report that was written earlier.

    Raises
    ------
    ReportError
        If the folder holds no report, or one that this version cannot read.
    """
    path = folder / ARTEFACTS
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        if told["version"] != VERSION:
            raise ReportError(
                f"cannot read '{path}': it is of version {told['version']}, this reads {VERSION}"
            )
        return tuple(_chapter(chapter) for chapter in told["chapters"])
    except OSError as error:
        raise ReportError(
            f"cannot read '{path}': {error.strerror or error}; name the folder of a report, "
            "such as reports/latest"
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise ReportError(f"cannot read '{path}': it is no record of a report") from error


def _chapter(told: Mapping[str, Any]) -> Section:
    return Section(
        title=told["title"],
        artefacts=tuple(_read(artefact) for artefact in told["artefacts"]),
        cases=tuple(told["cases"]),
        provenance=_provenance(told["provenance"]),
        fine=True,
    )


def _provenance(told: Mapping[str, Any]) -> Provenance:
    commit = told["commit"]
    return Provenance(
        packages=MappingProxyType(dict(told["packages"])),
        commit=None
        if commit is None
        else Commit(digest=commit, changed=bool(told["changed_since_commit"])),
        **{
            name: told[name]
            for name in ("rockingcan", "python", "platform", "processor", "cores", "written")
        },
    )


def _artefact(artefact: Artefact) -> dict[str, Any]:
    kind = next(name for name, made in _KINDS.items() if isinstance(artefact, made))
    return {"kind": kind} | _fields(artefact)


def _fields(item: Artefact | _Part) -> dict[str, Any]:
    return {field.name: _spelled(getattr(item, field.name)) for field in fields(item)}


def _spelled(value: object) -> object:
    if isinstance(value, np.ndarray):
        data = base64.b64encode(value.astype("<f8").tobytes()).decode("ascii")
        return {"shape": list(value.shape), "f8": data}
    if isinstance(value, pd.DataFrame):
        return {str(name): _column(value[name]) for name in value.columns}
    if isinstance(value, Panel | Series | Body | Heatmap):
        return _fields(value)
    if isinstance(value, tuple):
        return [_spelled(inner) for inner in value]
    if isinstance(value, Mapping):
        return dict(value)
    return value


def _column(column: "pd.Series[Any]") -> dict[str, Any]:
    """Return a column with its type; infinities and what is missing are told apart."""
    dtype = str(column.dtype)
    values = [None if is_missing(value) else value for value in column.tolist()]
    return {"dtype": dtype, "values": [_number(value) for value in values]}


def _number(value: object) -> object:
    if isinstance(value, float) and np.isinf(value):
        return {"inf": 1 if value > 0.0 else -1}
    return to_plain(value)


def _read(told: Mapping[str, Any]) -> Artefact:
    made = _KINDS[told["kind"]]
    return made(**_given(made, told))


def _given(made: type[Artefact | _Part], told: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields that are told; an earlier version did not have all of those of today."""
    return {f.name: _value(f.name, told[f.name]) for f in fields(made) if f.name in told}


def _value(name: str, told: Any) -> Any:  # noqa: ANN401 - whatever JSON holds
    if name in _NESTED:
        made = _NESTED[name]
        return tuple(made(**_given(made, one)) for one in told)
    if name == "heat" and told is not None:
        return Heatmap(**_given(Heatmap, told))
    if name == "frame":
        return pd.DataFrame({key: _series(column) for key, column in told.items()})
    if isinstance(told, dict) and "f8" in told:
        return _array(told)
    return tuple(told) if isinstance(told, list) else told


def _series(told: Mapping[str, Any]) -> "pd.Series[Any]":
    values = [
        value["inf"] * np.inf if isinstance(value, dict) else value for value in told["values"]
    ]
    column: pd.Series[Any] = pd.Series(values, dtype=told["dtype"])
    return column


def _array(told: Mapping[str, Any]) -> Floats:
    values: Floats = np.frombuffer(base64.b64decode(told["f8"]), dtype="<f8").astype(np.float64)
    return values.reshape(told["shape"])
