"""Mutate what judges: ``python -m tests.mutation --out reports/mutation.md``.

Leaves with code 1 if a mutant survives that `survivors.toml` gives no reason for.
"""

import argparse
import hashlib
import json
import random
import sys
from math import ceil
from pathlib import Path

from harness.engines.registry import not_installed, our_names
from tests.mutation.mutants import Mutant, mutant, sources
from tests.mutation.plan import Target, targets
from tests.mutation.report import Tally, page, reasons
from tests.mutation.trial import Trial, Verdict, tried, warm

IMPORTED = ("harness", "harness.gate", "harness.api", "harness.studies", "hypothesis", "pyarrow")
IMPORTED_ENGINES = (
    *(f"harness.engines.{name}.engine" for name in our_names() if name not in not_installed()),
    "scipy.integrate",
)

PATIENCE = 4.0
"""Times the processor time of the unchanged module's tests after which a mutant hangs."""

LEAST = 5.0
"""s: the same where the tests take next to nothing."""


class Kept:
    """Verdicts of earlier runs: tests that were only added kill no fewer mutants."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._known: dict[str, str] = {}
        if path is not None and path.is_file():
            self._known = json.loads(path.read_text(encoding="utf-8"))

    def killed(self, mutant: Mutant) -> Verdict | None:
        """Return how a mutant was killed, if it was."""
        known = self._known.get(_digest(mutant))
        return None if known in {None, Verdict.SURVIVED.value} else Verdict(known)

    def keep(self, mutant: Mutant, verdict: Verdict) -> None:
        """Remember a verdict."""
        self._known[_digest(mutant)] = verdict.value
        if self._path is not None:
            self._path.write_text(json.dumps(self._known), encoding="utf-8")


def _digest(mutant: Mutant) -> str:
    return hashlib.sha256(f"{mutant.path}\n{mutant.source}".encode()).hexdigest()[:24]


def main() -> int:
    """Read the command line, try module by module, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    reader.add_argument("--module", default="", help="only paths that contain this")
    reader.add_argument("--share", type=float, default=1.0, help="of each module's mutants, drawn")
    reader.add_argument("--seed", type=int, default=0, help="of the draw")
    reader.add_argument("--kept", type=Path, help="keep verdicts here; what was killed is not run")
    reader.add_argument("--out", type=Path, help="write the report here")
    asked = reader.parse_args()
    warm((*IMPORTED, *IMPORTED_ENGINES))
    kept, tallies, text = Kept(asked.kept), [], ""
    for target in (one for one in targets() if asked.module in str(one.path)):
        every = list(sources(target.path))
        random.Random(asked.seed).shuffle(every)  # noqa: S311 - a larger share holds the smaller one
        chosen = [mutant(target.path, one) for one in every[: ceil(asked.share * len(every))]]
        tallies.append(_tally(target, len(every), chosen, kept))
        text = page(tallies, reasons(), module=asked.module, share=asked.share, seed=asked.seed)
        if asked.out is not None:  # module by module: a run takes long
            asked.out.write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    return 0 if all(reasons().of(one) for tally in tallies for one in tally.survived) else 1


def _tally(target: Target, every: int, chosen: list[Mutant], kept: Kept) -> Tally:
    """Return what became of a module's mutants."""
    tally = Tally(path=target.path, every=every)
    allowed = 0.0
    for one in sorted(chosen, key=lambda one: one.line):
        known = kept.killed(one)
        if known is None and not allowed:
            whole = tried(target, None, 600.0)
            if whole.verdict is not Verdict.SURVIVED:
                raise SystemExit(f"the tests of {target.module} fail as it stands: mend that first")
            allowed = max(LEAST, PATIENCE * whole.seconds)
        found = (
            tried(target, one.source, allowed)
            if known is None
            else Trial(verdict=known, seconds=0.0)
        )
        kept.keep(one, found.verdict)
        tally.add(one, found)
        if found.verdict is Verdict.SURVIVED:
            sys.stderr.write(f"{one.path}:{one.line}: {one.was} -> {one.becomes}\n")
    sys.stderr.write(f"{target.path}: {tally.killed} of {tally.tried}, {tally.seconds:.0f} s\n")
    return tally


if __name__ == "__main__":
    sys.exit(main())
