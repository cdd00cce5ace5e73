"""Hostile releases: ``python -m tests.reference.hostile --out reports/hostile.md``.

Leaves with code 1 if an answer is wrong, or a refusal has no reason.
"""

import argparse
import sys
from pathlib import Path

from harness.provenance import provenance
from tests.reference.hostile.campaign import AGREED, LONGEST, ROUNDINGS, Tally, campaign
from tests.reference.hostile.made import FAMILIES

HEAD = (
    "| family | releases | bounce | refused: batch | refused: single | held to sixty digits "
    "| worst error over what is allowed |"
)


def page(tally: Tally, count: int, seed: int) -> str:
    """Return the report of a campaign."""
    origin = provenance()
    told = (
        "Releases constructed inside upper wells of the effective potential, beside separatrices "
        "and beside steady motions, over random cans from disks to needles. Each is solved in a "
        "batch (`exact_bounces`) and by itself (`solve`), and held to the integration "
        f'(`model="rolling"`); where two part by more than {AGREED:g}, to sixty digits, and its '
        f"error to {ROUNDINGS:g} times what half an ulp of the numbers given does to the motion."
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
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for family in FAMILIES:
        counts = (
            tally.seen[family],
            tally.bounced[family],
            tally.batch_refused[family],
            tally.single_refused[family],
            tally.by_truth[family],
        )
        cells = " | ".join(str(count) for count in counts)
        lines.append(f"| {family} | {cells} | {tally.worst.get(family, 0.0):.2g} |")
    lines += [
        "",
        f"Slowest scene: {tally.slowest:.2f} s of the processor, {LONGEST:g} s are allowed.",
        "",
        f"{len(tally.faults)} faults.",
        *(f"- {fault}" for fault in tally.faults),
        "",
        "Refusals, each with the share of the least energy gap that half an ulp of the numbers "
        "given changes:"
        if tally.refusals
        else "No refusals.",
        *(f"- {refusal}" for refusal in tally.refusals),
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Read the command line, try the releases, and tell."""
    reader = argparse.ArgumentParser(prog="python -m tests.reference.hostile", description=__doc__)
    reader.add_argument("--count", type=int, default=10_000, help="releases")
    reader.add_argument("--seed", type=int, default=0)
    reader.add_argument("--out", type=Path, help="write the report here")
    asked = reader.parse_args()
    tally = campaign(asked.count, asked.seed)
    text = page(tally, asked.count, asked.seed)
    sys.stdout.write(text)
    if asked.out is not None:
        asked.out.write_text(text, encoding="utf-8")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
