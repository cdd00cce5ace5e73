"""Follow random onsets of slip: ``python -m tests.onsets --out reports/onsets.md``.

Leaves with code 1 if one crashed or was given up, the plane pulled, or what is held left its cone.
"""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from pathlib import Path

from harness.core.provenance import provenance
from reference.nonsmooth.slip_onset import BEYOND
from tests.onsets.campaign import DURATION, KINDS, PIECE, ULPS, Tally, campaign

ALL = list(range(20))
"""Pieces: ten thousand onsets."""

TOLD = (
    "Random cans (a, c and h over one and a half to two decades each), leaning by 0.02 to 1.4 rad "
    "and turning, on a plane with a friction of 0.01 to 5, each followed for "
    f"{DURATION:g} sqrt(R/g) if its rim slips at the release or later, or if it cannot stay where "
    "it is. *At rest*: the rim is released at rest; *slipping*: with a slip; *with arms*: at rest, "
    "with drilling and rolling friction too; *on the edge*: at rest, with the friction that it "
    f"needs there but for {ULPS} units of round-off at most, and every other one with phi' = 0, "
    "where what it needs is stationary."
)
DEMANDED = (
    "Demanded, at 25 instants of every step from the release to the end, also of the motions in "
    "which the rim never slips: no crash, no motion given up, a normal force that is nowhere "
    "negative by more than its round-off, and a friction that where it holds (and moments of the "
    "arms that where they hold) is nowhere beyond its cone by more than its round-off and the "
    f"share of {BEYOND:g} at which it lets go. What ends at the release has no motion to look at."
)
NAMED = (
    "Admissible directions of slip, of the rims released at rest that cannot be held so "
    "(`reference/nonsmooth/slip_onset.py`): N > 0, a positive normal mobility, an acceleration "
    "along the direction. A free rim that would rise has none, and lifts."
)


def page(tally: Tally, pieces: Sequence[int], seed: int) -> str:
    """Return the report of a campaign of these pieces."""
    origin = provenance()
    chosen = "" if list(pieces) == ALL else f" --pieces {' '.join(map(str, pieces))}"
    command = f"python -m tests.onsets --seed {seed}{chosen} --out reports/onsets.md"
    lines = [
        "# Random onsets of slip",
        "",
        f"Tried on {origin.platform}, Python {origin.python}. Written by `{command}`.",
        "",
        TOLD,
        "",
        DEMANDED,
        "",
        f"| outcome | {' | '.join(KINDS)} | all |",
        f"|---|{'---:|' * (len(KINDS) + 1)}",
    ]
    outcomes = sorted({outcome for _, outcome in tally.outcomes})
    rows = [(name, [tally.outcomes[kind, name] for kind in KINDS]) for name in outcomes]
    rows.append(("fault", [sum(f[0] == kind for f in tally.faults) for kind in KINDS]))
    rows.append(("all", [sum(column) for column in zip(*(r[1] for r in rows), strict=True)]))
    lines += [
        f"| {name} | {' | '.join(map(str, counts))} | {sum(counts)} |" for name, counts in rows
    ]
    told = (
        f"In {tally.held} more releases the rim sticks throughout: no onsets, but looked at. The "
        f"least normal force is {-tally.least:.2g} of its round-off below zero, where a motion "
        f"ends as lifted; what is held goes {max(tally.excess, 0.0):.2g} of its round-off beyond "
        "where it lets go."
    )
    lines += [
        "",
        told,
        "",
        NAMED,
        "",
        "| admissible directions | free, the rim would | onsets |",
        "|---:|---|---:|",
    ]
    lines += [
        f"| {number} | {'fall' if falls else 'rise'} | {found} |"
        for (number, falls), found in sorted(tally.directions.items())
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Read the command line, follow piece by piece, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.onsets", description=__doc__)
    reader.add_argument(
        "--pieces", type=int, nargs="+", default=ALL, help=f"which, of {PIECE} onsets each"
    )
    reader.add_argument("--seed", type=int, default=0)
    reader.add_argument("--processes", type=int, default=1, help="pieces at a time")
    reader.add_argument("--out", type=Path, help="write the report here")
    asked = reader.parse_args()
    whole = Tally()
    seeds = [(asked.seed, number) for number in asked.pieces]
    with ProcessPoolExecutor(asked.processes) as pool:
        for piece in pool.map(campaign, repeat(PIECE), seeds):
            whole.add(piece)
            told = f"{whole.onsets} of {PIECE * len(asked.pieces)}, {len(whole.faults)} faults"
            sys.stderr.write(f"{told}\n")
            for kind, fault, problem in piece.faults:
                sys.stderr.write(f"{kind}: {fault}: {problem}\n")
    text = page(whole, asked.pieces, asked.seed)
    sys.stdout.write(text)
    if asked.out is not None:
        asked.out.write_text(text, encoding="utf-8")
    return 1 if whole.faults else 0


if __name__ == "__main__":
    sys.exit(main())
