"""Fuzz the command line with scene files: ``python -m tests.fuzz --count 10000 --seed 0``.

Leaves with code 1 if a file brought forth anything but an answer or a message; such files are kept.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.fuzz.campaign import MADE, Tally, campaign
from tests.fuzz.mutations import LEVELS


def table(tally: Tally, seconds: float) -> str:
    """Return what came of the files, as a Markdown table with a sentence."""
    lines = [
        "| level | scene files | answered (code 0) | refused (code 2) | faults |",
        "|---|---:|---:|---:|---:|",
    ]
    for level in (*LEVELS, MADE):
        good, bad = tally.answered[level], tally.refused[level]
        faults = sum(fault[0] == level for fault in tally.faults)
        lines.append(f"| {level} | {good + bad} | {good} | {bad} | {faults} |")
    lines.append("")
    lines.append(
        f"{tally.commands} commands in {seconds:.0f} s, the slowest {tally.slowest:.1f} s of the "
        f"processor; {len(tally.faults)} faults."
    )
    return "\n".join(lines) + "\n"


def main() -> int:
    """Read the command line, fuzz, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    reader.add_argument("--count", type=int, default=10_000, help="scene files")
    reader.add_argument("--seed", type=int, default=0)
    reader.add_argument("--out", type=Path, help="write the table here")
    reader.add_argument("--keep", type=Path, help="keep files that brought forth a fault here")
    asked = reader.parse_args()
    started = time.perf_counter()

    told = 0

    def show(tally: Tally) -> None:
        nonlocal told
        done = tally.answered.total() + tally.refused.total()
        for number, (level, command, fault, content) in enumerate(tally.faults[told:], told):
            sys.stderr.write(f"\r{level}, {command}: {fault}\n")
            if asked.keep is not None:
                asked.keep.mkdir(parents=True, exist_ok=True)
                (asked.keep / f"{number:04d}-{level}-{command}.toml").write_bytes(content)
        told = len(tally.faults)
        sys.stderr.write(f"\r{done} of {asked.count}, {told} faults")

    with tempfile.TemporaryDirectory() as folder:
        tally = campaign(asked.count, asked.seed, Path(folder), show)
    sys.stderr.write("\n")
    text = table(tally, time.perf_counter() - started)
    sys.stdout.write(text)
    if asked.out is not None:
        asked.out.write_text(text, encoding="utf-8")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
