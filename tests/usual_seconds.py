"""Measure what each claim of the audit and each figure of the gallery takes.

``python -m tests.usual_seconds`` writes `harness/paper/usual_seconds.json`, from which `audit` and
`gallery` say how long they will take: seconds of processor, of claims that take half a second or
more, and of every figure.
"""

import json
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import harness.paper
from harness.paper.audit import CLAIMS
from harness.paper.audit.checks import audit
from harness.paper.gallery import FIGURES

PLACE = Path(harness.paper.__file__).parent / "usual_seconds.json"

LONG = 0.5
"""s: shorter claims count as so many average ones."""


def taken(things: Iterable[tuple[str, Callable[[], object]]]) -> dict[str, float]:
    """Return processor seconds by name."""
    seconds = {}
    for name, do in things:
        start = time.process_time()
        do()
        seconds[name] = round(time.process_time() - start, 1)
    return seconds


def main() -> None:
    """Measure, and write the file."""
    rows = audit(CLAIMS)
    claims = taken((claim.label, lambda: next(rows)) for claim in CLAIMS)
    known = {
        "audit": {name: claims[name] for name in sorted(claims) if claims[name] >= LONG},
        "gallery": taken((draw.__name__, draw) for draw in FIGURES),
    }
    PLACE.write_text(json.dumps(known, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
