"""The options of commands that run cases: where they run, within what limits, where results stay.

Declared once; `runs` gives them to a command, which receives them as one `Running`.
"""

import functools
import inspect
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from harness.errors import InvalidSettingError
from harness.executors import cluster, local
from harness.isolation import Limits
from harness.isolation.limits import sensible
from harness.store import Store

STORE = Path("reports/.store")
"""Where results are kept if nothing else is said, below where the command is run."""

VARIABLE = "ROCKINGCAN_STORE"
"""Environment variable that names another folder."""

_GIB = 2.0**30

_PANEL = "Running and resuming"

TimeLimit = Annotated[
    float | None,
    typer.Option(
        metavar="SECONDS",
        help="Stop a case that takes longer; half an hour if left out.",
        rich_help_panel=_PANEL,
    ),
]
"""An option for `limits_of`."""

MemoryLimit = Annotated[
    float | None,
    typer.Option(
        metavar="GIB",
        help="Stop a case that uses more memory; 4, or a share of the machine's, if left out.",
        rich_help_panel=_PANEL,
    ),
]
"""An option for `limits_of`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Running:
    """How a command runs its cases.

    Parameters
    ----------
    jobs : int
        Processes on this machine.
    on : str or None
        Address of a Dask scheduler to run on instead.
    limits : Limits
        Of each case.
    store : Store or None
        Where results are kept and found.
    """

    jobs: int
    on: str | None
    limits: Limits
    store: Store | None

    @contextmanager
    def executor(self) -> Iterator[Executor]:
        """Give what cases run on: never this process, which an engine could take along."""
        with (
            local(self.jobs, spawned=True, limits=self.limits)
            if self.on is None
            else cluster(self.on, self.limits)
        ) as executor:
            yield executor

    def kept(self, count: int, total: int) -> None:
        """Say how much does not have to be done."""
        if self.store is not None and count:
            typer.echo(f"{count} of {total} already in the store '{self.store.folder}'", err=True)


def store_folder(chosen: Path | None) -> Path:
    """Return the folder of the store: the one chosen, of the environment, or the usual one."""
    return chosen or Path(os.environ.get(VARIABLE) or STORE)


def limits_of(jobs: int, time_limit: float | None, memory_limit: float | None) -> Limits:
    """Return the limits of a case among so many at once, as options have them: in s and GiB."""
    usual = sensible(jobs)
    return Limits(
        seconds=usual.seconds if time_limit is None else time_limit,
        memory=usual.memory if memory_limit is None else memory_limit * _GIB,
    )


def runs(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of running; it receives them as its parameter `running`."""
    options = inspect.signature(_running).parameters
    own = inspect.signature(command).parameters

    @functools.wraps(command)
    def run(**words: object) -> None:
        chosen = _running(**{name: words.pop(name) for name in options})  # type: ignore[arg-type]
        command(**words, running=chosen)

    parameters = [*(p for name, p in own.items() if name != "running"), *options.values()]
    # typer reads the one or the other
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    return run


def _running(  # noqa: PLR0917 - a parameter an option
    jobs: Annotated[
        int | None,
        typer.Option(min=1, help="Processes; one a core if left out.", rich_help_panel=_PANEL),
    ] = None,
    on: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Run on a Dask cluster: its scheduler, such as tcp://host:8786.",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            help=f"Folder where results are kept and found; {STORE} if left out.",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    no_store: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option("--no-store", help="Neither keep nor find results.", rich_help_panel=_PANEL),
    ] = False,
    fresh: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--fresh", help="Run everything, and replace what is kept.", rich_help_panel=_PANEL
        ),
    ] = False,
    time_limit: TimeLimit = None,
    memory_limit: MemoryLimit = None,
) -> Running:
    """Read the options."""
    if jobs is not None and on is not None:
        raise InvalidSettingError("--jobs", jobs, "nothing beside --on: a cluster has its own")
    if no_store and (store is not None or fresh):
        raise InvalidSettingError("--no-store", no_store, "nothing beside --store or --fresh")
    count = jobs or len(os.sched_getaffinity(0))
    return Running(
        jobs=count,
        on=on,
        limits=limits_of(count, time_limit, memory_limit),
        store=None if no_store else Store(folder=store_folder(store), fresh=fresh),
    )
