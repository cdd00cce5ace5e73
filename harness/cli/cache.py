"""What is kept: list it, verify it, remove what no run will read again."""

import warnings
from pathlib import Path
from typing import Annotated

import typer

from harness.cli import terminal
from harness.cli.run_options import STORE, Json, store_folder
from harness.core.report_model import Column, rows_of, table_of
from harness.evaluation.case_cache import is_current
from harness.execution.cache import (
    CacheFolder,
    CacheWarning,
    EntryState,
    inspect_cache,
    prune_cache,
)

app = typer.Typer(no_args_is_help=True, help="What is kept of runs: list it, verify it, prune it.")

Folder = Annotated[Path | None, typer.Option("--store", help=f"The folder; {STORE} if left out.")]
_COLUMNS = (
    Column("kind", "What is stored."),
    Column("key", "Names it.", shown=False),
    Column("state", "Whether it is whole.", "state.value"),
    Column("case", "What it is of.", "metadata.label"),
    Column("bytes", "Its size.", "size"),
    Column("kept", "Since when.", "metadata.kept"),
    Column("command", "Runs it again.", "metadata.command", shown=False),
)


@app.command("list")
def list_(store: Folder = None, json: Json = False) -> None:  # noqa: FBT002 - a switch
    """List what is kept."""
    kept = _opened(store)
    entries = list(inspect_cache(kept, thoroughly=False))
    if json:
        told = {"store": str(kept.folder), "entries": rows_of(_COLUMNS, entries)}
        typer.echo(terminal.to_json(told))
        return
    listed = table_of("store", f"The store '{kept.folder}'", _COLUMNS, entries)
    terminal.stdout_console().print(terminal.table_artefact(listed, listed.shown))
    size = sum(entry.size for entry in entries)
    typer.echo(f"{len(entries)} entries, {size / 1e6:.1f} MB")


@app.command()
def verify(store: Folder = None) -> None:
    """Read everything that is kept and check it; set aside what is broken. Leaves with 1 then."""
    kept = _opened(store)
    count, broken = 0, []
    for found in inspect_cache(kept, thoroughly=True):
        count += 1
        if found.state is EntryState.BROKEN:
            broken.append(found)
            typer.echo(f"broken: {found.kind} {found.key}: {found.reason}")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", CacheWarning)  # said already
                kept.reject(found.kind, found.key, found.reason)
    typer.echo(f"{count - len(broken)} of {count} entries are whole")
    if broken:
        typer.echo("What is broken is set aside; it is run again when it is next asked for.")
        raise typer.Exit(1)


@app.command("prune")
def prune_(
    store: Folder = None,
    everything: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--all", help="Remove everything, not what is out of date alone.")
    ] = False,
) -> None:
    """Remove what no run will read again: of other versions of the program, broken, left over."""
    kept = _opened(store)
    removed, freed = prune_cache(kept, (lambda _: False) if everything else is_current)
    typer.echo(f"removed {removed} entries from '{kept.folder}', {freed / 1e6:.1f} MB")


def _opened(chosen: Path | None) -> CacheFolder:
    """Return the store, which must be one: to find nothing in another folder would tell nothing."""
    store = CacheFolder(folder=store_folder(chosen))
    store.check()
    return store
