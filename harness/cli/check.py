"""Whether an engine's adapter keeps its contract, and what the engine adds of its own accord."""

from typing import Annotated, Any

import typer

from harness.cli import printing
from harness.cli.answers import spell
from harness.engines.conformance import Result, Verdict, conform
from harness.engines.probes import Measurement, measure
from harness.engines.registry import engine
from harness.studies.capabilities import design

_STYLES = {Result.PASSED: "green", Result.FAILED: "bold red", Result.NOT_APPLICABLE: "dim"}


def check(
    name: Annotated[
        str, typer.Argument(metavar="ENGINE", help="Any installed engine (see: engines).")
    ],
    capabilities: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option("--capabilities", help="Measure what the engine adds of its own accord."),
    ] = False,
    profile: Annotated[
        str, typer.Option(help="With --capabilities: default or matched settings.")
    ] = "matched",
    timestep: Annotated[
        float | None,
        typer.Option(help="With --capabilities: in seconds; the profile's own if left out."),
    ] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """Check an engine's adapter against its contract, or measure what the engine imposes.

    Leaves with code 1 if a check of the contract fails.
    """
    if capabilities:
        (case,) = design((name,), (profile,), timestep)
        measurement = measure(case)
        if json:
            typer.echo(spell(capabilities_answer(measurement)))
        else:
            _print_measurement(measurement)
        return
    chosen = engine(name)
    verdicts = conform(chosen)
    if json:
        typer.echo(spell(conformance_answer(name, chosen.version, verdicts)))
    else:
        _print_verdicts(name, verdicts)
    if any(verdict.result is Result.FAILED for verdict in verdicts):
        raise typer.Exit(1)


def conformance_answer(name: str, version: str, verdicts: tuple[Verdict, ...]) -> dict[str, Any]:
    """Return the answer of `check --json`."""
    return {
        "engine": name,
        "version": version,
        "conforms": all(verdict.result is not Result.FAILED for verdict in verdicts),
        "checks": [
            {
                "name": verdict.name,
                "sentence": verdict.sentence,
                "result": verdict.result.value,
                "number": verdict.number,
                "allowed": verdict.allowed,
                "unit": verdict.unit,
                "detail": verdict.detail,
            }
            for verdict in verdicts
        ],
    }


def capabilities_answer(measurement: Measurement) -> dict[str, Any]:
    """Return the answer of `check --capabilities --json`."""
    return {
        "engine": measurement.case.engine,
        "version": measurement.engine_version,
        "profile": measurement.case.profile,
        "timestep_s": measurement.timestep,
        "findings": [
            {name: getattr(finding, name) for name in finding.__slots__}
            for finding in measurement.findings
        ],
    }


def _print_verdicts(name: str, verdicts: tuple[Verdict, ...]) -> None:
    """Print a row for each check, and a count."""
    rows = [
        (
            verdict.name,
            f"[{_STYLES[verdict.result]}]{verdict.result.value}[/]",
            verdict.number,
            verdict.allowed,
            verdict.unit,
            verdict.detail,
        )
        for verdict in verdicts
    ]
    columns = ("check", "result", "number", "allowed", "unit", "detail")
    console = printing.out()
    console.print(printing.table(f"The contract of '{name}'", columns, rows))
    counts = [f"{sum(v.result is r for v in verdicts)} {r.value}" for r in Result]
    console.print(", ".join(counts))


def _print_measurement(measurement: Measurement) -> None:
    """Print a row for each finding."""
    case = measurement.case
    title = f"What '{case.engine}' adds, profile {case.profile}, {measurement.timestep:g} s"
    columns = ("effect", "quantity", "value", "expected", "unit", "how")
    rows = [[getattr(f, column) for column in columns] for f in measurement.findings]
    printing.out().print(printing.table(title, columns, rows))
