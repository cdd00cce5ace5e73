"""How fast it is: the project's claims about speed, measured."""

from dataclasses import asdict
from typing import Annotated

import typer

from harness import face
from harness.benchmark import engine_ratios, reference_ratios
from harness.cli import printing
from harness.cli.answers import spell


def benchmark(
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to measure; repeat it. All if left out.")
    ] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """Measure what the project claims about speed, as ratios in one run; some two minutes.

    Leaves with code 1 if a claim does not hold on this machine.
    """
    ratios = []
    with printing.progress() as bar:
        task = bar.add_task("the reference", total=None)
        for part in (reference_ratios(), engine_ratios(face.stepping_engines(engine))):
            for ratio in part:
                ratios.append(ratio)
                bar.update(task, advance=1, description=ratio.what)
    if json:
        typer.echo(spell({"ratios": [asdict(ratio) for ratio in ratios]}))
    else:
        columns = ("what", "ratio", "claim", "holds", "first_s", "second_s", "note")
        rows = [[getattr(ratio, column) for column in columns] for ratio in ratios]
        printing.out().print(printing.table("Speed", columns, rows))
    if not all(ratio.holds for ratio in ratios):
        raise typer.Exit(1)
