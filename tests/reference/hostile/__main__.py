"""Hostile releases: ``python -m tests.reference.hostile --out reports/hostile.md``.

Leaves with code 1 if an answer is wrong, or a refusal has no reason.
"""

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from harness.core.provenance import provenance
from tests.reference.hostile.campaign import (
    AGREED,
    DECIDING,
    LONGEST,
    PIECE,
    ROUNDINGS,
    Tally,
    kept_piece,
)
from tests.reference.hostile.made import CLOSEST, DECADES, RARE

HEAD = (
    "| family | releases | bounce | refused: batch | refused: single | states fewer digits "
    "| held to neighbours | held to sixty digits | worst error over what is allowed | slowest, s |"
)


def page(tally: Tally, count: int, seed: int) -> str:
    """Return the report of a campaign."""
    origin = provenance()
    told = (
        "Releases constructed inside upper wells of the effective potential, beside separatrices "
        f"(relative energies from 1e-{DECADES['separatrix'][0]:g} down to "
        f"1e-{DECADES['separatrix'][1]:g}) and beside steady motions, over random cans from disks "
        f"to needles; one in {RARE} is nearer to a separatrix, down to 1e-{DECADES[CLOSEST][1]:g}, "
        "where doubles can hardly tell. Each is solved in a batch (`exact_bounces`) and by itself "
        f'(`solve`), and held to the integration (`model="rolling"`). Two that part by more than '
        f"{AGREED:g} are held to what {ROUNDINGS:g} half ulps of the numbers given do to the "
        "integration, and what parts by more, every steady motion, every ending that not all three "
        "find, and every refusal, to sixty digits; where `solve` states itself that fewer digits "
        "are known, its answer may be off by what it states. An ending that these refute is a "
        f"fault, unless it is decided by {DECIDING} ulps of everything: of the numbers given, the "
        "first integrals and the energy, each moved so that the gap of the energy closes, or of "
        "one number by itself. So is a refusal, unless these decide the ending or the third digit "
        "of a measure: of the period, phi_min, the turn or the rotation."
    )
    command = f"python -m tests.reference.hostile --count {count} --seed {seed}"
    lines = [
        "# Hostile releases",
        "",
        f"Tried on {origin.platform}, Python {origin.python}. Written by `{command}`.",
        "",
        told,
        "",
        HEAD,
        "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for name, one in tally.families.items():
        counts = (one.seen, one.bounced, one.batch_refused, one.single_refused)
        cells = " | ".join(
            str(number) for number in (*counts, one.stated, one.conditioned, one.by_truth)
        )
        lines.append(f"| {name} | {cells} | {one.worst:.2g} | {one.slowest:.2g} |")
    seen = sum(one.seen for one in tally.families.values())
    slowest = max(one.slowest for one in tally.families.values())
    refused = sum(max(one.batch_refused, one.single_refused) for one in tally.families.values())
    lines += [
        "",
        f"A scene takes {slowest:.2f} s of the processor at most, {LONGEST:g} s are allowed.",
        "",
        f"{len(tally.faults)} faults.",
        *(f"- {fault}" for fault in tally.faults),
        "",
        f"Refused: {refused / seen:.2%}" + (", each with its reason:" if tally.refusals else "."),
        *(f"- {refusal}" for refusal in tally.refusals),
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Read the command line, try the releases, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.reference.hostile", description=__doc__)
    reader.add_argument("--count", type=int, default=10_000, help="releases")
    reader.add_argument("--seed", type=int, default=0)
    reader.add_argument("--out", type=Path, help="write the report here")
    reader.add_argument("--jobs", type=int, default=1, help="processes")
    reader.add_argument("--pieces", type=Path, help="keep what is done here, and go on from it")
    asked = reader.parse_args()
    tally = Tally()
    pieces = [
        range(start, min(start + PIECE, asked.count)) for start in range(0, asked.count, PIECE)
    ]
    solved = partial(kept_piece, seed=asked.seed, folder=asked.pieces)
    with ProcessPoolExecutor(asked.jobs) as workers:
        for numbers, part in zip(pieces, workers.map(solved, pieces), strict=True):
            tally.add(part)
            sys.stderr.write(f"{numbers.stop} of {asked.count}, {len(tally.faults)} faults\n")
    text = page(tally, asked.count, asked.seed)
    sys.stdout.write(text)
    if asked.out is not None:
        asked.out.write_text(text, encoding="utf-8")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
