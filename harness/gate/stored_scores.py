"""Scores of a report that was written earlier, or of accepted results: whatever a folder holds.

Whether a run may be held against accepted results at all, and which cases it owes.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
from pydantic import TypeAdapter

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.gate.baseline import FILE, BaselineError, read_baseline
from harness.gate.scores import (
    CaseIdentity,
    Score,
    Scores,
    identity,
    scene_digest,
    stored_score,
)
from harness.report.atomic_folder import FORMAT, MANIFEST

RESULTS = Path("tables", "results.parquet")
"""Where a report of `validate` has its table of all cases."""


_IDENTITY = TypeAdapter(CaseIdentity)


def gate_keys(designed: Case, suite: str, settings: Mapping[str, str]) -> dict[str, Any]:
    """Return what the manifest of a report says of a case so that its scores can be read again.

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
    BaselineError
        If it holds neither.
    """
    if (folder / FILE).is_file():
        return read_baseline(folder)
    if not (folder / MANIFEST).is_file():
        what = "no folder" if not folder.is_dir() else "neither a report nor accepted results"
        raise BaselineError(
            f"'{folder}' is {what}; name one that rockingcan validate wrote, with --out or with "
            "--accept"
        )
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        if manifest["format"] != FORMAT:
            raise BaselineError(f"'{folder}' is no report of rockingcan")
        told = {case["digest"]: case for case in manifest["cases"] if "identity" in case}
        if not told or not (folder / RESULTS).is_file():
            raise BaselineError(
                f"'{folder}' is a report, but not of rockingcan validate, or of a version that "
                "could not be compared yet; write it again"
            )
        return _scores(folder, manifest, told)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, BaselineError):
            raise
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise BaselineError(f"the report in '{folder}' cannot be read ({reason})") from error


def _scores(
    folder: Path, manifest: Mapping[str, Any], told: Mapping[str, Mapping[str, Any]]
) -> Scores:
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(folder / RESULTS, pre_buffer=False) as file:
        table = file.read(use_threads=False)
    rows = table.to_pandas(use_threads=False).to_dict("records")
    found: dict[CaseIdentity, Score] = {}
    versions = {"rockingcan": str(manifest["provenance"]["rockingcan"])}
    for row in rows:
        case = told[str(row["digest"])]
        name = _IDENTITY.validate_python(case["identity"])
        versions[name.engine] = str(case["engine_version"])
        found[name] = stored_score(
            row,
            identity=name,
            scene=str(case["scene_digest"]),
            outcome=_outcome(str(case["outcome"])),
        )
    any_case = next(iter(told.values()))
    return Scores(
        suite=str(any_case["suite"]),
        scores=found,
        versions=versions,
        made=dict(manifest["provenance"]),
        settings=dict(any_case["set_on_top"]),
        place=str(folder),
    )


def _outcome(sentence: str) -> str:
    """Return the name of the outcome that a manifest tells by its sentence."""
    return next((one.name for one in Outcome if one.value == sentence), sentence)


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
        False if only some engines were chosen.

    Raises
    ------
    BaselineError
        If the accepted results are of another suite or engine, or a scene has changed since.
    """
    names = {identity(case): case for case in designed}
    engines = {case.engine for case in designed}
    known = {name.engine for name in accepted.scores}
    if not engines & known:
        raise BaselineError(
            f"'{accepted.place}' holds no accepted results of {', '.join(sorted(engines))}, only "
            f"of {', '.join(sorted(known)) or 'none'}; accept some first, with --accept"
        )
    common = [name for name in names if name in accepted.scores]
    fresh = [n for n in names if n.engine in known and n not in accepted.scores]
    if accepted.suite != suite and len(fresh) > _FRESH * len(common):
        raise BaselineError(
            f"'{accepted.place}' holds the {accepted.suite} suite, which has {len(common)} of the "
            f"{len(common) + len(fresh)} cases of the {suite} suite; run --suite {accepted.suite}, "
            f"or accept the {suite} suite with --accept"
        )
    changed = sorted(
        {
            name.scene
            for name in common
            if accepted.scores[name].scene_digest != scene_digest(names[name].scene)
        }
    )
    if changed:
        raise BaselineError(
            f"'{accepted.place}' was accepted for other scenes: since then {', '.join(changed)} "
            "changed, and errors of two motions cannot be compared; accept anew with --accept"
        )
    if accepted.suite != suite:
        return tuple(common)
    return tuple(n for n in accepted.scores if every_engine or n.engine in engines)
