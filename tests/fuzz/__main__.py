"""Fuzz the command line with scene files: ``python -m tests.fuzz --out reports/fuzz.md``.

Leaves with code 1 if a file brought forth anything but an answer or a message; such files are kept.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from tests.fuzz.campaign import Tally, campaign
from tests.fuzz.pieces import PIECE, kept, piece_seed
from tests.fuzz.report import page


def main() -> int:
    """Read the command line, fuzz piece by piece, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    reader.add_argument("--count", type=int, default=10_000, help="scene files")
    reader.add_argument("--seed", type=int, default=0)
    reader.add_argument("--out", type=Path, help="write the report here")
    reader.add_argument(
        "--pieces", type=Path, help="keep results here, piece by piece; what is here is not run"
    )
    reader.add_argument("--keep", type=Path, help="keep files that brought forth a fault here")
    asked = reader.parse_args()
    whole = Tally()
    with tempfile.TemporaryDirectory() as folder:
        for number, start in enumerate(range(0, asked.count, PIECE)):
            count = min(PIECE, asked.count - start)
            seed = piece_seed(asked.seed, number)

            def run(count: int = count, seed: int = seed) -> Tally:
                return campaign(count, seed, Path(folder))

            piece = kept(run, asked.pieces, count, seed)
            whole.add(piece)
            sys.stderr.write(f"{whole.files} of {asked.count}, {len(whole.faults)} faults\n")
            for fault in piece.faults:
                sys.stderr.write(f"seed {seed}, {fault[0]}, {fault[1]}: {fault[2]}\n")
    if asked.keep is not None and whole.faults:
        asked.keep.mkdir(parents=True, exist_ok=True)
        for number, (level, command, _, content) in enumerate(whole.faults):
            (asked.keep / f"{number:04d}-{level}-{command}.toml").write_bytes(content)
    text = page(whole, asked.count, asked.seed)
    sys.stdout.write(text)
    if asked.out is not None:
        asked.out.write_text(text, encoding="utf-8")
    return 1 if whole.faults else 0


if __name__ == "__main__":
    sys.exit(main())
