"""Scores of a report that was written earlier, or of accepted results: whatever a folder holds."""

import json
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pyarrow.parquet as pq

from harness.case import Case
from harness.gate.baseline import FILE, read_baseline
from harness.gate.errors import BaselineError
from harness.gate.identity import Identity, identity, scene_digest, told_identity
from harness.gate.scores import Score, Scores, score
from harness.report.folder import FORMAT, MANIFEST
from harness.simulation import Outcome

RESULTS = Path("tables", "results.parquet")
"""Where a report of `validate` has its table of all cases."""


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
        "identity": identity(designed).to_dict(),
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
        reason = f"{type(error).__name__}: {error}"
        raise BaselineError(f"the report in '{folder}' cannot be read ({reason})") from error


def _scores(
    folder: Path, manifest: Mapping[str, Any], told: Mapping[str, Mapping[str, Any]]
) -> Scores:
    # in this thread alone: one of Arrow's own that outlives the interpreter can abort the program
    with pq.ParquetFile(folder / RESULTS, pre_buffer=False) as file:
        table = file.read(use_threads=False)
    rows = table.to_pandas(use_threads=False).to_dict("records")
    found: dict[Identity, Score] = {}
    versions = {"rockingcan": str(manifest["provenance"]["rockingcan"])}
    for row in rows:
        case = told[str(row["digest"])]
        name = told_identity(case["identity"])
        versions[name.engine] = str(case["engine_version"])
        found[name] = score(
            row,
            identity=name,
            scene=str(case["scene_digest"]),
            outcome=_outcome(str(case["outcome"])),
        )
    any_case = next(iter(told.values()))
    return Scores(
        suite=str(any_case["suite"]),
        scores=MappingProxyType(found),
        versions=MappingProxyType(versions),
        made=MappingProxyType(dict(manifest["provenance"])),
        settings=MappingProxyType({str(k): str(v) for k, v in any_case["set_on_top"].items()}),
        place=str(folder),
    )


def _outcome(sentence: str) -> str:
    """Return the name of the outcome that a manifest tells by its sentence."""
    return next((one.name for one in Outcome if one.value == sentence), sentence)
