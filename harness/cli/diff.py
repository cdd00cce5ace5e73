"""Two reports held against each other: two versions of an engine, two machines, two settings."""

from pathlib import Path
from typing import Annotated, Any

import typer

from harness.cli import printing
from harness.cli.answers import spell
from harness.cli.gate import show_changes
from harness.gate import (
    SIDES,
    BaselineError,
    Difference,
    changed,
    differences,
    read,
    read_baseline,
    read_scores,
    regressions,
    sentences,
)


def diff(
    a: Annotated[
        Path, typer.Argument(metavar="A", help="Folder of a report, or of accepted results.")
    ],
    b: Annotated[Path, typer.Argument(metavar="B", help="The same, to hold against it.")],
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Accepted results whose measured spread tells what may differ: reports have none.",
        ),
    ] = None,
    gate: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--gate", help="Leave with code 1 if anything is better in A.")
    ] = False,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """Say what differs between two reports of validate, case by case, quantity by quantity.

    For example: rockingcan diff reports/before reports/after --baseline reports/baseline
    """
    first, second = read_scores(a), read_scores(b)
    spreads = None if baseline is None else read_baseline(baseline)
    if not set(first.scores) & set(second.scores):
        raise BaselineError(f"'{a}' and '{b}' have no case in common: there is nothing to compare")
    found = differences(first, second, spreads=spreads)
    if json:
        told = sentences(found, first, second, SIDES, spreads)
        typer.echo(
            spell({"differences": [_told(one) for one in changed(found)], "sentences": told})
        )
    else:
        show_changes(read(found, first, second, SIDES, spreads), printing.out(), _COLUMNS)
    if gate and regressions(found):
        raise typer.Exit(1)


_COLUMNS = ("a", "b", "tolerance", "factor", "verdict", "note")


def _told(one: Difference) -> dict[str, Any]:
    """Return a difference as `--json` says it."""
    return {
        **one.identity.to_dict(),
        "quantity": one.quantity,
        "a": one.first,
        "b": one.second,
        "spread": one.spread,
        "tolerance": one.tolerance,
        "factor": one.factor,
        "verdict": SIDES.verdict(one),
        "note": one.note,
    }
