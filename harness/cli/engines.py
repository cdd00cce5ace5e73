"""Whether an engine's adapter keeps its contract, and what the engine adds of its own accord.

What there is to choose from: engines and their settings.
"""

from dataclasses import asdict
from typing import Annotated, Any

import typer

from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.core.errors import MissingPackageError
from harness.engines.base import Setting
from harness.engines.conformance import ClauseResult, ClauseStatus, conform
from harness.engines.probes import Measurement, design, measure
from harness.engines.registry import engine, names

_STYLES = {
    ClauseStatus.PASSED: "green",
    ClauseStatus.FAILED: "bold red",
    ClauseStatus.NOT_APPLICABLE: "dim",
}


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
            typer.echo(to_json(capabilities_answer(measurement)))
        else:
            _print_measurement(measurement)
        return
    chosen = engine(name)
    verdicts = conform(chosen)
    if json:
        typer.echo(to_json(conformance_answer(name, chosen.version, verdicts)))
    else:
        _print_verdicts(name, verdicts)
    if any(verdict.result is ClauseStatus.FAILED for verdict in verdicts):
        raise typer.Exit(1)


def conformance_answer(
    name: str, version: str, verdicts: tuple[ClauseResult, ...]
) -> dict[str, Any]:
    """Return the answer of `check --json`."""
    return {
        "engine": name,
        "version": version,
        "conforms": all(verdict.result is not ClauseStatus.FAILED for verdict in verdicts),
        "checks": [asdict(verdict) | {"result": verdict.result.value} for verdict in verdicts],
    }


def capabilities_answer(measurement: Measurement) -> dict[str, Any]:
    """Return the answer of `check --capabilities --json`."""
    return {
        "engine": measurement.case.engine,
        "version": measurement.engine_version,
        "profile": measurement.case.profile,
        "timestep_s": measurement.timestep,
        "findings": [asdict(finding) for finding in measurement.findings],
    }


def _print_verdicts(name: str, verdicts: tuple[ClauseResult, ...]) -> None:
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
    console = terminal.stdout_console()
    console.print(terminal.table(f"The contract of '{name}'", columns, rows))
    counts = [f"{sum(v.result is r for v in verdicts)} {r.value}" for r in ClauseStatus]
    console.print(", ".join(counts))


def _print_measurement(measurement: Measurement) -> None:
    """Print a row for each finding."""
    case = measurement.case
    title = f"What '{case.engine}' adds, profile {case.profile}, {measurement.timestep:g} s"
    columns = ("effect", "quantity", "value", "expected", "unit", "how")
    rows = [[getattr(f, column) for column in columns] for f in measurement.findings]
    terminal.stdout_console().print(terminal.table(title, columns, rows))


def engines_answer(name: str | None) -> dict[str, Any]:
    """Return all engines, or one, as `--json` says them."""
    return {"engines": [_told(each) for each in ([name] if name else names())]}


def _told(name: str) -> dict[str, Any]:
    """Return what there is to know of an engine; if it is missing, how to install it."""
    try:
        found = engine(name)
    except MissingPackageError as error:
        return {"name": name, "installed": False, "message": str(error)}
    return {
        "name": name,
        "installed": True,
        "version": found.version,
        "honours": sorted(found.capabilities.honours),
        "imposes": dict(found.capabilities.imposes),
        "settings": [
            {
                "name": setting.name,
                "default": setting.default,
                "matched": _matched(setting),
                "choices": list(setting.choices),
                "meaning": setting.meaning,
            }
            for setting in found.settings
        ],
    }


def print_engines() -> None:
    """Print a row for each engine."""
    rows = []
    for name in names():
        told = _told(name)
        if told["installed"]:
            imposes = "; ".join(f"{k}: {v}" for k, v in told["imposes"].items()) or "nothing"
            honours = ", ".join(told["honours"]) or "the ideal can only"
            rows.append((name, told["version"], honours, imposes))
        else:
            rows.append((name, "not installed", told["message"], ""))
    columns = ("engine", "version", "honours", "imposes on every scene")
    terminal.stdout_console().print(terminal.table("Engines", columns, rows))


def print_engine(name: str) -> None:
    """Print the settings of an engine: what it ships with, and what `matched` takes instead."""
    rows = [
        (name, setting.name, _spell(setting.default), _spell(_matched(setting)), setting.meaning)
        for setting in engine(name).settings
    ]
    columns = ("engine", "setting", "default", "matched", "meaning")
    terminal.stdout_console().print(terminal.table(f"Settings of {name}, for --set", columns, rows))


def _matched(setting: Setting) -> object:
    """Return the matched value; where it goes with the timestep, its value for one second."""
    if not callable(setting.matched):
        return setting.matched
    return f"for a timestep of 1 s: {_spell(setting.matched(1.0))}, in proportion"


def _spell(value: object) -> str:
    """Return a value as `--set` reads it."""
    if value is None:
        return "as shipped"
    if isinstance(value, tuple):
        return ",".join(f"{number:g}" for number in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
