"""Accepted results as one file, a line a case, so that a change of them can be reviewed.

The file lies beside whatever else a baseline's folder holds, and is replaced in one move. The
scores of a report that was written earlier are read here too: whatever a folder holds. So is
judged whether a run may be held against accepted results at all, and which cases it owes.
"""

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
from pydantic import TypeAdapter

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.core.writing import WriteError, writing
from harness.engines.registry import description_of
from harness.execution.atomic_write import write_atomically
from harness.gate.errors import (
    FILE,
    BaselineError,
    ChangedScenesError,
    Fault,
    OtherEnginesError,
    OtherSuiteError,
    ResultsError,
)
from harness.gate.scores import (
    CaseIdentity,
    Score,
    Scores,
    identity,
    scene_digest,
    score_of_row,
)
from harness.gate.spread import SIZES
from harness.metrics.quantities import Number
from harness.report.atomic_folder import FORMAT as REPORT_FORMAT
from harness.report.atomic_folder import MANIFEST
from harness.studies.comparison.suite import SUITES, suite_cases
from models.catalogue import load

FORMAT, VERSION = "rockingcan-baseline", 1
_WHAT = "accepted results to"

_DIGITS = 3
"""Of a spread: it is a largest departure of a few, known to a digit at best."""


_TINY = 1e-300
"""Far below every floor, and above where a double loses its digits."""

_SCORE, _IDENTITY = TypeAdapter(Score), TypeAdapter(CaseIdentity)

_OUTCOMES = {outcome.value: outcome.name for outcome in Outcome}
"""Names of outcomes by the sentences that a manifest tells them with."""


def write_baseline(scores: Scores, folder: Path) -> Path:
    """Write accepted results into a folder, whole or not at all, and return the file.

    Raises
    ------
    WriteError
        If it cannot be written.
    """
    path = folder / FILE
    fix = "name a folder that you may write to with --baseline"
    with writing(path, _WHAT, fix):
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(path, _text(scores).encode())
    return path


def check_place(folder: Path) -> None:
    """Refuse at once a place that `write_baseline` would refuse at the end of a long run.

    Raises
    ------
    WriteError
        If it is a file, or cannot be written to.
    """
    place = next(p for p in (folder.absolute(), *folder.absolute().parents) if p.exists())
    if not place.is_dir() or not os.access(place, os.W_OK):
        reason = f"'{place}' is no folder that you may write to"
        fix = "name another with --baseline"
        raise WriteError(path=folder, reason=reason, what=_WHAT, fix=fix)


def read_baseline(folder: Path) -> Scores:
    """Return the accepted results of a folder.

    Raises
    ------
    ResultsError
        If it holds none, or what it holds is not what was written.
    """
    path = folder / FILE
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise ResultsError(place=folder, fault=Fault.MISSING) from error
    except (OSError, ValueError) as error:
        raise ResultsError(place=path, fault=Fault.UNREADABLE, reason=str(error)) from error
    with _reading(path, Fault.DAMAGED):
        if (stored["format"], stored["version"]) != (FORMAT, VERSION):
            raise ResultsError(place=path, fault=Fault.VERSION, reason=str(VERSION))
        scores = [_SCORE.validate_python({**case, "identity": case}) for case in stored["cases"]]
        return Scores(
            suite=str(stored["suite"]),
            scores={score.identity: score for score in scores},
            versions=dict(stored["versions"]),
            made=dict(stored["made"]),
            place=str(folder),
        )


@contextmanager
def _reading(place: Path, fault: Fault) -> Iterator[None]:
    """Turn any error of content into a `ResultsError` of one sentence."""
    try:
        yield
    except BaselineError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise ResultsError(place=place, fault=fault, reason=reason) from error


def _text(scores: Scores) -> str:
    """Return the file: its head, then a line a case."""
    head = {
        "format": FORMAT,
        "version": VERSION,
        "suite": scores.suite,
        "versions": dict(scores.versions),
        "made": dict(scores.made),
        "perturbed_by": list(SIZES),
    }
    lines = [f" {json.dumps(key)}: {_json(value)},\n" for key, value in head.items()]
    cases = ",\n".join(f"  {_json(_record(score))}" for score in scores.scores.values())
    return f'{{\n{"".join(lines)} "cases": [\n{cases}\n ]\n}}\n'


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _record(score: Score) -> dict[str, Any]:
    """Return a case as one flat record: its identity, then its numbers."""
    record = asdict(score)
    record["spread"] = {name: _rounded_up(value) for name, value in score.spread.items()}
    return {**record.pop("identity"), **record}


def _rounded_up(spread: Number) -> Number:
    """Return a spread in few digits, none of them smaller than it was."""
    if spread is None or spread == 0.0:
        return spread
    spread = max(spread, _TINY)
    unit = 10.0 ** (math.floor(math.log10(spread)) - _DIGITS + 1)
    return float(f"{math.ceil(spread / unit) * unit:.{_DIGITS - 1}e}")


RESULTS = Path("tables", "results.parquet")
"""Where a report of `validate` has its table of all cases."""


def gate_keys(designed: Case, suite: str, settings: Mapping[str, str]) -> dict[str, Any]:
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


def read_scores(folder: Path) -> Scores:
    """Return the scores of a folder: of accepted results, or of a report of `validate`.

    Raises
    ------
    ResultsError
        If it holds neither.
    """
    if (folder / FILE).is_file():
        return read_baseline(folder)
    if not (folder / MANIFEST).is_file():
        fault = Fault.NEITHER if folder.is_dir() else Fault.NO_FOLDER
        raise ResultsError(place=folder, fault=fault)
    with _reading(folder, Fault.DAMAGED_REPORT):
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        if manifest["format"] != REPORT_FORMAT:
            raise ResultsError(place=folder, fault=Fault.FOREIGN_REPORT)
        cases = {case["digest"]: case for case in manifest["cases"] if "identity" in case}
        if not cases or not (folder / RESULTS).is_file():
            raise ResultsError(place=folder, fault=Fault.OTHER_REPORT)
        return _scores(folder, manifest, cases)


def _scores(
    folder: Path, manifest: Mapping[str, Any], cases: Mapping[str, Mapping[str, Any]]
) -> Scores:
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(folder / RESULTS, pre_buffer=False) as file:
        table = file.read(use_threads=False)
    rows = table.to_pandas(use_threads=False).to_dict("records")
    scores: dict[CaseIdentity, Score] = {}
    versions = {"rockingcan": str(manifest["provenance"]["rockingcan"])}
    for row in rows:
        case = cases[str(row["digest"])]
        name = _IDENTITY.validate_python(case["identity"])
        versions[name.engine] = str(case["engine_version"])
        scores[name] = score_of_row(
            row,
            identity=name,
            scene=str(case["scene_digest"]),
            outcome=_OUTCOMES.get(str(case["outcome"]), str(case["outcome"])),
        )
    any_case = next(iter(cases.values()))
    return Scores(
        suite=str(any_case["suite"]),
        scores=scores,
        versions=versions,
        made=dict(manifest["provenance"]),
        settings=dict(any_case["set_on_top"]),
        place=str(folder),
    )


def cases_of_absent(
    accepted: Scores, suite: str, engines: Sequence[str]
) -> tuple[CaseIdentity, ...]:
    """Return the accepted cases that a suite has of engines which are not installed."""
    scenes = {name: load(name) for name in SUITES[suite]}
    names = map(identity, suite_cases(suite, engines, scenes))
    return tuple(name for name in names if name in accepted.scores)


_FRESH = 0.25
"""Share of new cases beside accepted ones up to which a suite has grown, and is not another."""


def required_cases(
    accepted: Scores, suite: str, designed: Sequence[Case], *, every_engine: bool
) -> tuple[CaseIdentity, ...]:
    """Return the accepted cases that a run must have.

    A smaller suite owes those that it has in common with the accepted one; the same suite owes
    every accepted case, of the engines that were chosen.

    Parameters
    ----------
    accepted : Scores
    suite : str
        That is to be run.
    designed : sequence of Case
        Its cases.
    every_engine : bool
        False if only some engines were chosen; True for those that take part by default, too.

    Raises
    ------
    OtherEnginesError, OtherSuiteError
        If the accepted results are of other engines or another suite.
    ChangedScenesError
        If a scene has changed since.
    """
    names = {identity(case): case for case in designed}
    engines = {case.engine for case in designed}
    known = {name.engine for name in accepted.scores}
    if not engines & known:
        raise OtherEnginesError(
            place=accepted.place, engines=tuple(sorted(engines)), accepted=tuple(sorted(known))
        )
    common = [name for name in names if name in accepted.scores]
    fresh = [n for n in names if n.engine in known and n not in accepted.scores]
    if accepted.suite != suite and len(fresh) > _FRESH * len(common):
        raise OtherSuiteError(
            place=accepted.place,
            suite=suite,
            accepted=accepted.suite,
            cases=len(common) + len(fresh),
            common=len(common),
        )
    changed = sorted(
        {n.scene for n in common if accepted.scores[n].scene_digest != scene_digest(names[n].scene)}
    )
    if changed:
        raise ChangedScenesError(place=accepted.place, scenes=tuple(changed))
    if accepted.suite != suite:
        return tuple(common)
    return tuple(
        name
        for name in accepted.scores
        if name.engine in engines or (every_engine and description_of(name.engine).by_default)
    )
