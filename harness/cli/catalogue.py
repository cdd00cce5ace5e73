"""Commands that list scenes, engines with their settings and checks, and stored results.

Of an engine, whether its adapter keeps its contract and what it adds of its own accord; of the
store, what is in it, whether it is sound, and how to remove what no run will read again.
"""

import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness.cli import terminal
from harness.cli.options import STORE, Json
from harness.cli.run_options import store_folder
from harness.core.case import Case
from harness.core.errors import (
    BrokenEngineError,
    CacheWarning,
    InvalidSettingError,
    MissingPackageError,
)
from harness.core.report_model import Column, rows_of, table_of
from harness.engines.base import Setting
from harness.engines.conformance import CLAUSES, ClauseStatus, conform
from harness.engines.probes import measure
from harness.engines.probes.rim_survey import why_no_contacts
from harness.engines.registry import description_of, engine, names, outside_range
from harness.engines.remote import RemoteEngine
from harness.evaluation.case_cache import is_current
from harness.evaluation.evaluate import check_case
from harness.execution.cache import (
    CacheFolder,
    EntryState,
    inspect_cache,
    prune_cache,
)
from harness.execution.isolated_pool import local_executor
from harness.progress import ItemBar, ProgressBar
from harness.studies.comparison.rim import RimStudy
from harness.studies.study import run_study
from models.catalogue import load

_CLAUSE = 1.0
"""s of processor for a clause, on average."""

_STYLES = {
    ClauseStatus.PASSED: "green",
    ClauseStatus.FAILED: "bold red",
    ClauseStatus.NOT_APPLICABLE: "dim",
}

_EFFECTS = ("effect", "quantity", "value", "expected", "unit", "how")


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
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """Whether an adapter keeps its contract, clause by clause.

    Below it, what the engine's colliders do under the rim that exact ones do not, which is no
    fault of the adapter. Or, with --capabilities, what the engine adds of its own accord.

    Leaves with code 1 if a check of the contract fails.

    For example: rockingcan check mujoco
    """
    if capabilities:
        _measure(name, profile, timestep, json=json)
        return
    if profile != "matched" or timestep is not None:
        allowed = "given with --capabilities alone: the contract is checked in every profile"
        raise InvalidSettingError("--profile or --timestep", timestep or profile, allowed)
    chosen = engine(name)
    with ItemBar(dict.fromkeys(CLAUSES, _CLAUSE), "clause") as bar:
        bar.label("the contract")
        verdicts = conform(chosen, bar.advance)
    failed = any(verdict.result is ClauseStatus.FAILED for verdict in verdicts)
    rim = RimStudy(engines=(name,))
    found = None
    if not failed and not why_no_contacts(chosen):
        # in another process: a crash of the engine does not end this one
        with ProgressBar() as progress, local_executor(1, spawned=True) as executor:
            found = rim.answer(run_study(rim, executor=executor, on_progress=progress.show))
    checks = [asdict(verdict) | {"result": verdict.result.value} for verdict in verdicts]
    if json:
        answer = {
            "engine": name,
            "version": chosen.version,
            "conforms": not failed,
            "checks": checks,
            "rim": found and found["findings"],
        }
        typer.echo(terminal.to_json(answer))
    else:
        rows = [
            (
                *(verdict.name, f"[{_STYLES[verdict.result]}]{verdict.result.value}[/]"),
                *(verdict.number, verdict.allowed, verdict.unit, verdict.detail),
            )
            for verdict in verdicts
        ]
        columns = ("check", "result", "number", "allowed", "unit", "detail")
        counts = [f"{sum(v.result is r for v in verdicts)} {r.value}" for r in ClauseStatus]
        table = terminal.table(f"The contract of '{name}'", columns, rows)
        console = terminal.stdout_console()
        console.print(table, ", ".join(counts), sep="\n")
        if found:
            said = [(each["variant"], escape(each["sentence"])) for each in found["findings"]]
            console.print(terminal.table("Under the rim", ("collider", "finding"), said))
    if failed:
        raise typer.Exit(1)


def _measure(name: str, profile: str, timestep: float | None, *, json: bool) -> None:
    """Print the effects that an engine adds of its own accord."""
    # the can and the gravity of this scene are probed; the release is each probe's own
    scene = load("gentle-rock")
    case = Case(scene=scene, engine=name, profile=profile, timestep=timestep)
    check_case(case)
    measured = measure(case)
    findings = [asdict(finding) for finding in measured.findings]
    if json:
        answer = {
            "engine": name,
            "version": measured.engine_version,
            "profile": profile,
            "timestep_s": measured.timestep,
            "findings": findings,
        }
        typer.echo(terminal.to_json(answer))
    else:
        step = "its own steps" if measured.timestep is None else f"{measured.timestep:g} s"
        title = f"What '{name}' adds, profile {profile}, {step}"
        rows = [[finding[column] for column in _EFFECTS] for finding in findings]
        terminal.stdout_console().print(terminal.table(title, _EFFECTS, rows))


def engines(
    name: Annotated[
        str | None, typer.Argument(metavar="[ENGINE]", help="Show the settings of this engine.")
    ] = None,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """The engines, or the settings of one in each profile.

    What an engine ships with, and what `matched` takes.

    An engine can have an interpreter of its own, for another version of it or of Python:
    rockingcan engines add, rockingcan engines list, rockingcan engines remove; each has its --help.
    """
    if json:
        typer.echo(terminal.to_json(engines_answer(name)))
        return
    if name is None:
        title = "Engines"
        columns = ["engine", "version", "method", "honours", "imposes on every scene"]
        rows = [_row(each) for each in engines_answer(None)["engines"]]
    else:
        title = f"Settings of {name}, for --set"
        columns = ["engine", "setting", "default", "matched", "meaning"]
        rows = [
            (name, s.name, _spell(s.default), _spell(_matched(s)), s.meaning)
            for s in engine(name).settings
        ]
    terminal.stdout_console().print(terminal.table(title, columns, rows))


def engines_answer(name: str | None) -> dict[str, Any]:
    """Return all engines, or one, as `--json` says them."""
    return {"engines": [_engine_answer(each) for each in ([name] if name else names())]}


def _engine_answer(name: str) -> dict[str, Any]:
    """Return version, capabilities and settings of an engine; if missing, how to install it."""
    said = description_of(name)
    description = {
        "label": said.label or name,
        "method": said.method.value,
        "precision": said.precision.value,
        "tells_forces": said.tells_forces,
        "by_default": said.by_default,
    }
    try:
        adapter = engine(name)
    except MissingPackageError as error:
        state = {"broken": isinstance(error, BrokenEngineError)}
        return {"name": name, "installed": False, **state, **description, "message": str(error)}
    return {
        "name": name,
        "installed": True,
        "version": adapter.version,
        "unsupported": outside_range(name),
        "environment": dict(adapter.environment.versions())
        if isinstance(adapter, RemoteEngine)
        else None,
        **description,
        "honours": sorted(adapter.capabilities.honours),
        "imposes": dict(adapter.capabilities.imposes),
        "settings": [
            {
                "name": setting.name,
                "default": setting.default,
                "matched": _matched(setting),
                "choices": list(setting.choices),
                "meaning": setting.meaning,
            }
            for setting in adapter.settings
        ],
    }


def _row(answer: dict[str, Any]) -> tuple[str, ...]:
    """Return the row of an engine."""
    if not answer["installed"]:
        state = "broken" if answer["broken"] else "not installed"
        return answer["name"], state, "", escape(answer["message"]), ""
    imposes = "; ".join(f"{effect}: {what}" for effect, what in answer["imposes"].items())
    honours = ", ".join(answer["honours"])
    method = f"{answer['method']}, {answer['precision']}"
    version = answer["version"]
    if answer["environment"]:
        version += f", in Python {answer['environment']['python']}"
    if answer["unsupported"]:
        version += f"; not supported: {answer['unsupported']}"
    return (
        *(answer["name"], version, method),
        *(honours or "the ideal can only", imposes or "nothing"),
    )


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


store = typer.Typer(
    no_args_is_help=True, help="What is kept of runs: list it, verify it, prune it."
)

Folder = Annotated[Path | None, typer.Option("--store", help=f"The folder; {STORE} if left out.")]
_STORED = (
    Column("kind", "What is stored."),
    Column("key", "Names it.", shown=False),
    Column("state", "Whether it is whole.", "state.value"),
    Column("case", "What it is of.", "metadata.label"),
    Column("bytes", "Its size.", "size"),
    Column("kept", "Since when.", "metadata.kept"),
    Column("command", "Runs it again.", "metadata.command", shown=False),
)


@store.command("list")
def list_(folder: Folder = None, json: Json = False) -> None:  # noqa: FBT002 - a switch
    """List what is kept."""
    cache = _opened(folder)
    entries = list(inspect_cache(cache, thoroughly=False))
    if json:
        answer = {"store": str(cache.folder), "entries": rows_of(_STORED, entries)}
        typer.echo(terminal.to_json(answer))
        return
    listed = table_of("store", f"The store '{cache.folder}'", _STORED, entries)
    terminal.stdout_console().print(terminal.table_artefact(listed))
    size = sum(entry.size for entry in entries)
    typer.echo(f"{len(entries)} entries, {size / 1e6:.1f} MB")


@store.command()
def verify(folder: Folder = None) -> None:
    """Read everything that is kept and check it; set aside what is broken. Leaves with 1 then."""
    cache = _opened(folder)
    count, broken = 0, []
    for entry in inspect_cache(cache, thoroughly=True):
        count += 1
        if entry.state is EntryState.BROKEN:
            broken.append(entry)
            typer.echo(f"broken: {entry.kind} {entry.key}: {entry.reason}")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", CacheWarning)  # said already
                cache.reject(entry.kind, entry.key, entry.reason)
    typer.echo(f"{count - len(broken)} of {count} entries are whole")
    if broken:
        typer.echo("What is broken is set aside; it is run again when it is next asked for.")
        raise typer.Exit(1)


@store.command("prune")
def prune_(
    folder: Folder = None,
    everything: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--all", help="Remove everything, not what is out of date alone.")
    ] = False,
) -> None:
    """Remove what no run will read again: of other versions of the program, broken, left over."""
    cache = _opened(folder)
    removed, freed = prune_cache(cache, (lambda _: False) if everything else is_current)
    typer.echo(f"removed {removed} entries from '{cache.folder}', {freed / 1e6:.1f} MB")


def _opened(chosen: Path | None) -> CacheFolder:
    """Return the store, which must be one: to find nothing in another folder would tell nothing."""
    opened = CacheFolder(folder=store_folder(chosen))
    opened.check()
    return opened
