"""Measure the project's claims about speed: ``rockingcan benchmark``."""

from dataclasses import asdict
from typing import Annotated

import typer

from harness import api
from harness.cli import terminal
from harness.cli.main import main
from harness.cli.terminal import to_json
from harness.engines import registry
from harness.progress import ItemBar
from tests.benchmarks.engines import engine_ratios
from tests.benchmarks.friction import friction_ratios
from tests.benchmarks.heyoka_rows import missing
from tests.benchmarks.lean import lean_ratios
from tests.benchmarks.reference import reference_ratios
from tests.benchmarks.start_up import start_up_ratios
from tests.benchmarks.whole_jobs import whole_job_ratios

app = typer.Typer(add_completion=False)

_RATIO = ("what", "ratio", "interval", "claim", "holds", "first_s", "second_s", "note")

_LEAN = (
    *("scene", "who", "model", "ratio", "claim", "holds"),
    *("quantity", "difference", "tolerance", "lean_s", "everything_s"),
)

_USUAL = {
    "the start": 10.0,
    "the reference": 60.0,
    "friction": 30.0,
    "whole jobs": 80.0,
    "an engine": 45.0,
    "lean": 60.0,
}
"""s of processor for each part of the claims."""


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
    parts = {
        "the start": start_up_ratios(),
        # first: the largest memory of a process counts that of the one that started it
        "whole jobs": whole_job_ratios(),
        "the reference": reference_ratios(),
        "friction": friction_ratios(),
        **{name: engine_ratios([name]) for name in chosen},
    }
    efforts = {part: _USUAL.get(part, _USUAL["an engine"]) for part in (*parts, "lean")}
    with ItemBar(efforts, "measurement") as bar:
        for part, claims in parts.items():
            bar.label(part)
            for ratio in claims:
                ratios.append(ratio)
                bar.label(ratio.what)
            bar.advance(part)
        lean = []
        for one in lean_ratios(chosen):
            lean.append(one)
            bar.label(f"{one.who}: {one.scene}, lean")
        bar.advance("lean")
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
    if left_out := missing():
        typer.echo(left_out, err=True)
    if not (all(ratio.holds for ratio in ratios) and all(one.holds for one in lean)):
        raise typer.Exit(1)


if __name__ == "__main__":
    main(app, "rockingcan benchmark")
