"""A campaign in pieces, each kept when it is done, so that what was stopped goes on."""

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from tests.fuzz.campaign import Tally

PIECE = 500
"""Scene files."""

_APART = 1000
"""Between the seeds of campaigns: more than the pieces of any."""


def piece_seed(seed: int, number: int) -> int:
    """Return the seed of a piece."""
    return _APART * seed + number


def kept(run: Callable[[], Tally], folder: Path | None, count: int, seed: int) -> Tally:
    """Return what came of a piece: what is kept of it, or run it and keep that."""
    if folder is None:
        return run()
    path = folder / f"seed-{seed}-files-{count}.json"
    if path.exists():
        return _read(path.read_text(encoding="utf-8"))
    tally = run()
    folder.mkdir(parents=True, exist_ok=True)
    path.write_text(_written(tally), encoding="utf-8")
    return tally


def _written(tally: Tally) -> str:
    content = {
        "answered": dict(tally.answered),
        "refused": dict(tally.refused),
        "commands": tally.commands,
        "seconds": tally.seconds,
        "slowest": tally.slowest,
        "faults": [(*words, text.hex()) for *words, text in tally.faults],
    }
    return json.dumps(content, indent=1) + "\n"


def _read(text: str) -> Tally:
    content = json.loads(text)
    return Tally(
        answered=Counter(content["answered"]),
        refused=Counter(content["refused"]),
        commands=content["commands"],
        seconds=content["seconds"],
        slowest=content["slowest"],
        faults=[(a, b, c, bytes.fromhex(d)) for a, b, c, d in content["faults"]],
    )
