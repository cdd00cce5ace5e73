"""Files of results: one format, a line a case, so that a change of them can be reviewed.

A file is replaced in one move. The scores of a report that was written earlier are read here too:
whatever a place holds.
"""

import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.core.writing import WriteError, writing
from harness.execution.atomic_write import write_atomically
from harness.metrics.quantities import Number
from harness.report.atomic_folder import FORMAT as REPORT_FORMAT
from harness.report.atomic_folder import MANIFEST
from harness.results.errors import FILE, BaselineError, Fault, ResultsError
from harness.results.result import FORMAT, VERSION, Result, make_result
from harness.results.scores import CaseIdentity, Score, identity, scene_digest, score_of_row

_WHAT = "a result to"

_DIGITS = 3
"""Of a spread: it is a largest departure of a few, known to a digit at best."""

_TINY = 1e-300
"""Far below every floor, and above where a double loses its digits."""

_IDENTITY = TypeAdapter(CaseIdentity)

_OUTCOMES = {outcome.value: outcome.name for outcome in Outcome}
"""Names of outcomes by the sentences that a manifest tells them with."""

RESULTS = Path("tables", "results.parquet")
"""Where a report of `validate` has its table of all cases."""


def write_result(result: Result, path: Path, fix: str = "") -> Path:
    """Write a result, whole or not at all, and return the file.

    Parameters
    ----------
    result : Result
    path : Path
    fix : str
        What to do where it cannot be written, as the error says it.

    Raises
    ------
    WriteError
        If it cannot be written.
    """
    with writing(path, _WHAT, fix):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path.absolute(), to_text(result).encode())
    return path


_LONGEST = 100
"""Characters of settings in the name of a file."""


def result_name(engine: str, version: str, suite: str, settings: Mapping[str, str]) -> str:
    """Return the name of the file of a result of an engine: with the settings on top, if any.

    Parameters
    ----------
    engine, version, suite : str
    settings : mapping of str to str
        By `engine.name`.
    """
    plain = re.sub(r"[^\w.+-]", "-", version)
    # an engine in an environment of its own often has its version in its name
    release = engine if engine.endswith(f"-{plain}") else f"{engine}-{plain}"
    words = "".join(f"-{k.removeprefix(f'{engine}.')}-{value}" for k, value in settings.items())
    on_top = re.sub(r"[^\w.+-]", "-", words)[:_LONGEST]
    return f"{release}-{suite}{on_top}.json"


def check_place(folder: Path, fix: str) -> None:
    """Refuse at once a folder that `write_result` would refuse at the end of a long run.

    Raises
    ------
    WriteError
        If it is a file, or cannot be written to.
    """
    place = next(p for p in (folder.absolute(), *folder.absolute().parents) if p.exists())
    if not place.is_dir() or not os.access(place, os.W_OK):
        reason = f"'{place}' is no folder that you may write to"
        raise WriteError(path=folder, reason=reason, what=_WHAT, fix=fix)


def to_text(result: Result) -> str:
    """Return the content of the file of a result: its head, then a line a case."""
    head = result.model_dump(mode="json", exclude={"cases"})
    lines = [f" {json.dumps(key)}: {_json(value)},\n" for key, value in head.items()]
    cases = ",\n".join(f"  {_json(_record(score))}" for score in result.cases)
    return f'{{\n{"".join(lines)} "cases": [\n{cases}\n ]\n}}\n'


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _record(score: Score) -> dict[str, Any]:
    """Return a case as its line has it."""
    spread = {name: _rounded_up(value) for name, value in score.spread.items()}
    return {**score.model_dump(mode="json"), "spread": spread}


def _rounded_up(spread: Number) -> Number:
    """Return a spread in few digits, none of them smaller than it was; of few digits, as it is."""
    if spread is None or spread == 0.0:
        return spread
    spread = max(spread, _TINY)
    nearest = float(f"{spread:.{_DIGITS - 1}e}")
    unit = 10.0 ** (math.floor(math.log10(spread)) - _DIGITS + 1)
    return nearest if nearest >= spread else float(f"{nearest + unit:.{_DIGITS - 1}e}")


def read_result(path: Path) -> Result:
    """Return the result of a file.

    Raises
    ------
    ResultsError
        If there is none, or what the file holds is not what was written.
    """
    try:
        text = path.read_text(encoding="utf-8")
        stored = json.loads(text)
    except FileNotFoundError as error:
        raise ResultsError(place=path, fault=Fault.NO_FOLDER) from error
    except (OSError, ValueError, RecursionError) as error:
        raise ResultsError(place=path, fault=Fault.UNREADABLE, reason=str(error)) from error
    known = stored if isinstance(stored, dict) else {}
    if (known.get("format"), known.get("version")) != (FORMAT, VERSION):
        raise ResultsError(place=path, fault=Fault.VERSION, reason=str(VERSION))
    with _reading(path, Fault.DAMAGED):
        return Result.model_validate_json(text).read_from(str(path))


def read_baseline(folder: Path) -> Result:
    """Return the accepted results of a folder.

    Raises
    ------
    ResultsError
        If it holds none, or what it holds is not what was written.
    """
    if not (folder / FILE).is_file():
        raise ResultsError(place=folder, fault=Fault.MISSING)
    return read_result(folder / FILE).read_from(str(folder))


def result_files(places: Sequence[Path]) -> tuple[Path, ...]:
    """Return the files of results that places name: files, and folders with all that they hold.

    Raises
    ------
    ResultsError
        If a place is not there, or is a folder without any.
    """
    files: list[Path] = []
    for place in places:
        own = sorted(place.glob("*.json")) if place.is_dir() else [place]
        if not own or not own[0].exists():
            fault = Fault.NO_RESULTS if place.is_dir() else Fault.NO_FOLDER
            raise ResultsError(place=place, fault=fault)
        files += own
    return tuple(dict.fromkeys(files))


@contextmanager
def _reading(place: Path, fault: Fault) -> Iterator[None]:
    """Turn any error of content into a `ResultsError` of one sentence."""
    try:
        yield
    except BaselineError:
        raise
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        reason = " ".join((f"{key}: {first['msg']}" if key else first["msg"]).split())
        raise ResultsError(place=place, fault=fault, reason=reason) from error
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise ResultsError(place=place, fault=fault, reason=reason) from error


def manifest_keys(designed: Case, suite: str, settings: Mapping[str, str]) -> dict[str, Any]:
    """Return the entries of a case in a manifest from which its scores can be read again.

    Parameters
    ----------
    designed : Case
        As the suite has it, without settings on top.
    suite : str
    settings : mapping of str to str
        That the run put on top, by `engine.name`.
    """
    return {
        "identity": asdict(identity(designed)),
        "scene_digest": scene_digest(designed.scene),
        "suite": suite,
        "set_on_top": dict(settings),
    }


def read_scores(place: Path) -> Result:
    """Return the result of a file, of a folder with accepted results, or of a `validate` report.

    Raises
    ------
    ResultsError
        If it holds none of these.
    """
    if place.is_file():
        return read_result(place)
    if (place / FILE).is_file():
        return read_baseline(place)
    if not (place / MANIFEST).is_file():
        fault = Fault.NEITHER if place.is_dir() else Fault.NO_FOLDER
        raise ResultsError(place=place, fault=fault)
    with _reading(place, Fault.DAMAGED_REPORT):
        manifest = json.loads((place / MANIFEST).read_text(encoding="utf-8"))
        if manifest["format"] != REPORT_FORMAT:
            raise ResultsError(place=place, fault=Fault.FOREIGN_REPORT)
        cases = {case["digest"]: case for case in manifest["cases"] if "identity" in case}
        if not cases or not (place / RESULTS).is_file():
            raise ResultsError(place=place, fault=Fault.OTHER_REPORT)
        return _of_report(place, manifest, cases).read_from(str(place))


def _of_report(
    folder: Path, manifest: Mapping[str, Any], cases: Mapping[str, Mapping[str, Any]]
) -> Result:
    import pyarrow.parquet as pq  # noqa: PLC0415 - a file of results is read without it

    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(folder / RESULTS, pre_buffer=False) as file:
        table = file.read(use_threads=False)
    rows = table.to_pandas(use_threads=False).to_dict("records")
    any_case = next(iter(cases.values()))
    settings = dict(any_case["set_on_top"])
    scores: dict[CaseIdentity, Score] = {}
    versions, inputs = {}, {}
    for row in rows:
        case = cases[str(row["digest"])]
        name = _IDENTITY.validate_python(case["identity"])
        versions[name.engine] = str(case["engine_version"])
        inputs[name.scene] = str(case["scene_digest"])
        outcome = _OUTCOMES.get(str(case["outcome"]), str(case["outcome"]))
        scores[name] = score_of_row(row, identity=name, outcome=outcome, settings=settings)
    return make_result(
        str(any_case["suite"]),
        scores.values(),
        versions=versions,
        inputs=inputs,
        settings=settings,
        origin=dict(manifest["provenance"]),
    )
