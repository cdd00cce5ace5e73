"""What is kept: list it, verify it, remove what no run will read again."""

import warnings
from pathlib import Path
from typing import Annotated

import typer

from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.cli.run_options import STORE, store_folder
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
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON object and nothing else on standard output.")
]

_COLUMNS = ("kind", "key", "state", "case", "bytes", "kept", "command")
_SHOWN = ("kind", "state", "case", "bytes", "kept")


@app.command("list")
def list_(store: Folder = None, json: Json = False) -> None:  # noqa: FBT002 - a switch
    """List what is kept."""
    kept = _opened(store)
    folder = kept.folder
    rows = _rows(kept, thoroughly=False)
    if json:
        entries = [dict(zip(_COLUMNS, row, strict=True)) for row in rows]
        typer.echo(to_json({"store": str(folder), "entries": entries}))
        return
    shown = [[row[_COLUMNS.index(name)] for name in _SHOWN] for row in rows]
    terminal.stdout_console().print(terminal.table(f"The store '{folder}'", _SHOWN, shown))
    size = sum(int(str(row[_COLUMNS.index("bytes")])) for row in rows)
    typer.echo(f"{len(rows)} entries, {size / 1e6:.1f} MB")


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


def _rows(store: CacheFolder, *, thoroughly: bool) -> list[tuple[object, ...]]:
    """Return a row for each entry, by the columns above."""
    return [
        (
            found.kind,
            found.key,
            found.state.value,
            None if found.metadata is None else found.metadata.label,
            found.size,
            None if found.metadata is None else found.metadata.kept,
            None if found.metadata is None else found.metadata.command,
        )
        for found in inspect_cache(store, thoroughly=thoroughly)
    ]
