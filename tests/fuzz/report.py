"""What came of fuzzing, as a page of Markdown."""

from harness.core.provenance import provenance
from tests.fuzz.campaign import MADE, Tally
from tests.fuzz.mutations import LEVELS
from tests.fuzz.verdict import LONGEST


def page(tally: Tally, count: int, seed: int) -> str:
    """Return the report of a campaign."""
    origin = provenance()
    told = (
        "Valid scene files (the catalogue, the hard cases, some with friction) changed by bytes, "
        "tokens or values, and files made from nothing by hypothesis, each given to `reference`, "
        "one in ten also to `export` in both formats and to `run` with MuJoCo."
    )
    demanded = (
        "Demanded: code 0 and an answer that can be read, or code 2, nothing on standard output "
        "and a message; never a traceback, a warning, a file that nobody asked for, or more than "
        f"{LONGEST:g} s of the processor."
    )
    command = f"python -m tests.fuzz --count {count} --seed {seed} --out reports/fuzz.md"
    lines = [
        "# Fuzzed scene files",
        "",
        f"Tried on {origin.platform}, Python {origin.python}. Written by `{command}`.",
        "",
        told,
        "",
        demanded,
        "",
        "| level | scene files | answered (code 0) | refused (code 2) | faults |",
        "|---|---:|---:|---:|---:|",
    ]
    for level in (*LEVELS, MADE):
        good, bad = tally.answered[level], tally.refused[level]
        faults = sum(fault[0] == level for fault in tally.faults)
        lines.append(f"| {level} | {good + bad} | {good} | {bad} | {faults} |")
    good, bad = tally.answered.total(), tally.refused.total()
    spent = f"{tally.commands} commands in {tally.seconds:.0f} s of the processor"
    lines += [
        f"| all | {good + bad} | {good} | {bad} | {len(tally.faults)} |",
        "",
        f"{spent}, the slowest {tally.slowest:.1f} s; {len(tally.faults)} faults.",
    ]
    for level, word, fault, _ in tally.faults:
        lines.append(f"- {level}, `{word}`: {fault}.")
    return "\n".join(lines) + "\n"
