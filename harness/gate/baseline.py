"""Accepted results as one file, a line a case, so that a change of them can be reviewed.

The file lies beside whatever else a baseline's folder holds, and is replaced in one move.

What wrong use of the gate raises.
"""

import json
import math
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from harness.core.errors import HarnessError, OutputError
from harness.execution.atomic_write import write_atomically
from harness.gate.scores import Score, Scores
from harness.gate.spread import SIZES
from harness.metrics.quantities import Number


class BaselineError(HarnessError, ValueError):
    """Accepted results, or a report, cannot be read or do not fit what they are held against."""


FILE = "accepted.json"
FORMAT, VERSION = "rockingcan-baseline", 1

_DIGITS = 3
"""Of a spread: it is a largest departure of a few, known to a digit at best."""


_TINY = 1e-300
"""Far below every floor, and above where a double loses its digits."""


def write_baseline(scores: Scores, folder: Path) -> Path:
    """Write accepted results into a folder, whole or not at all, and return the file.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    path = folder / FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(path, _text(scores).encode())
    except OSError as error:
        raise OutputError(
            f"cannot write accepted results to '{path}': {error.strerror or error}; "
            "name a folder that you may write to with --baseline"
        ) from error
    return path


def check_place(folder: Path) -> None:
    """Refuse at once a place that `write_baseline` would refuse at the end of a long run.

    Raises
    ------
    OutputError
        If it is a file, or cannot be written to.
    """
    place = next(p for p in (folder.absolute(), *folder.absolute().parents) if p.exists())
    if not place.is_dir() or not os.access(place, os.W_OK):
        raise OutputError(
            f"cannot write accepted results to '{folder}': '{place}' is no folder that you may "
            "write to; name another with --baseline"
        )


def read_baseline(folder: Path) -> Scores:
    """Return the accepted results of a folder.

    Raises
    ------
    BaselineError
        If it holds none, or what it holds is not what was written.
    """
    path = folder / FILE
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise BaselineError(
            f"'{folder}' holds no accepted results ('{FILE}'); write some with: "
            f"rockingcan validate --accept --baseline {folder}"
        ) from error
    except (OSError, ValueError) as error:
        raise BaselineError(f"accepted results '{path}' cannot be read: {error}") from error
    try:
        if (told["format"], told["version"]) != (FORMAT, VERSION):
            raise BaselineError(
                f"'{path}' is no file of accepted results of version {VERSION}; write it anew with "
                "--accept"
            )
        # a case is told in one flat record: what names it, and its numbers
        scores = [_SCORE.validate_python({**case, "identity": case}) for case in told["cases"]]
        return Scores(
            suite=str(told["suite"]),
            scores={score.identity: score for score in scores},
            versions=dict(told["versions"]),
            made=dict(told["made"]),
            place=str(folder),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, BaselineError):
            raise
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise BaselineError(f"accepted results '{path}' are damaged ({reason})") from error


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
    cases = ",\n".join(f"  {_json(_told(score))}" for score in scores.scores.values())
    return f'{{\n{"".join(lines)} "cases": [\n{cases}\n ]\n}}\n'


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _told(score: Score) -> dict[str, Any]:
    return {
        **asdict(score.identity),
        "scene_digest": score.scene_digest,
        "digest": score.digest,
        "outcome": score.outcome,
        "truth_pulls": score.truth_pulls,
        "values": dict(score.values),
        "members": score.members,
        "spread": {k: _rounded_up(v) for k, v in score.spread.items()},
        "endings": dict(score.endings),
    }


def _rounded_up(spread: Number) -> Number:
    """Return a spread in few digits, none of them smaller than it was."""
    if spread is None or spread == 0.0:
        return spread
    spread = max(spread, _TINY)
    unit = 10.0 ** (math.floor(math.log10(spread)) - _DIGITS + 1)
    return float(f"{math.ceil(spread / unit) * unit:.{_DIGITS - 1}e}")


_SCORE = TypeAdapter(Score)
