"""Measure the project's claims about speed: ``rockingcan benchmark``."""

from dataclasses import asdict
from typing import Annotated

import typer

from harness import api
from harness.cli import terminal
from harness.cli.main import main
from harness.cli.terminal import to_json
from harness.engines import registry
from harness.progress import progress_bar
from tests.benchmarks.engines import engine_ratios
from tests.benchmarks.lean import lean_ratios
from tests.benchmarks.reference import reference_ratios
from tests.benchmarks.start_up import start_up_ratios

app = typer.Typer(add_completion=False)

_RATIO = ("what", "ratio", "claim", "holds", "first_s", "second_s", "note")

_LEAN = (
    *("scene", "who", "model", "ratio", "claim", "holds"),
    *("quantity", "difference", "tolerance", "lean_s", "everything_s"),
)


@app.command()
def benchmark(
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to measure; repeat it. All if left out.")
    ] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """What the project claims about speed, measured.

    As ratios within one run of some three minutes.

    Leaves with code 1 if a claim does not hold on this machine.
    """
    ratios = []
    chosen = api.stepping_engines(engine)
    for name in chosen:
        registry.engine(name)  # an unknown one is refused before anything is measured
    with progress_bar() as bar:
        task = bar.add_task("the reference", total=None)
        for part in (start_up_ratios(), reference_ratios(), engine_ratios(chosen)):
            for ratio in part:
                ratios.append(ratio)
                bar.update(task, advance=1, description=ratio.what)
        lean = []
        for one in lean_ratios(chosen):
            lean.append(one)
            bar.update(task, advance=1, description=f"{one.who}: {one.scene}, lean")
    if json:
        told = {"ratios": [asdict(one) for one in ratios], "lean": [asdict(one) for one in lean]}
        typer.echo(to_json(told))
    else:
        for title, columns, measured in (
            ("Speed", _RATIO, ratios),
            ("Only the effects a scene calls for", _LEAN, lean),
        ):
            rows = [[getattr(one, column) for column in columns] for one in measured]
            terminal.stdout_console().print(terminal.table(title, columns, rows))
    if not (all(ratio.holds for ratio in ratios) and all(one.holds for one in lean)):
        raise typer.Exit(1)


if __name__ == "__main__":
    main(app, "rockingcan benchmark")
