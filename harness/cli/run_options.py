"""How a command runs its cases: where, within what limits, and where results stay.

`with_run_options` gives these options to a command, which receives them as one `RunOptions`.
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

from harness.cli.options import PANEL, STORE, VARIABLE, Cluster, Jobs, MemoryLimit, TimeLimit
from harness.core.errors import InvalidSettingError
from harness.execution.cache import CacheFolder
from harness.execution.dask_cluster import dask_executor
from harness.execution.isolated_pool import local_executor
from harness.execution.limits import Limits, default_limits

_GIB = 2.0**30


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How a command runs its cases.

    Parameters
    ----------
    jobs : int
        Processes on this machine.
    on : str or None
        Address of a Dask scheduler to run on instead.
    limits : Limits
        Of each case.
    store : CacheFolder or None
        Where results are kept and found.
    """

    jobs: int
    on: str | None
    limits: Limits
    store: CacheFolder | None

    @contextmanager
    def executor(self) -> Iterator[Executor]:
        """Give the executor of cases: never this process, which an engine could take along."""
        with (
            local_executor(self.jobs, spawned=True, limits=self.limits)
            if self.on is None
            else dask_executor(self.on, self.limits)
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
    usual = default_limits(jobs)
    return Limits(
        seconds=usual.seconds if time_limit is None else time_limit,
        memory=usual.memory if memory_limit is None else memory_limit * _GIB,
    )


def with_run_options(command: Callable[..., None]) -> Callable[..., None]:
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
    jobs: Jobs = None,
    on: Cluster = None,
    store: Annotated[
        Path | None,
        typer.Option(
            help=f"Folder where results are kept and found; {STORE} if left out.",
            rich_help_panel=PANEL,
        ),
    ] = None,
    no_store: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option("--no-store", help="Neither keep nor find results.", rich_help_panel=PANEL),
    ] = False,
    fresh: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--fresh", help="Run everything, and replace what is kept.", rich_help_panel=PANEL
        ),
    ] = False,
    time_limit: TimeLimit = None,
    memory_limit: MemoryLimit = None,
) -> RunOptions:
    """Read the options."""
    if jobs is not None and on is not None:
        raise InvalidSettingError("--jobs", jobs, "nothing beside --on: a cluster has its own")
    if no_store and (store is not None or fresh):
        raise InvalidSettingError("--no-store", no_store, "nothing beside --store or --fresh")
    count = jobs or len(os.sched_getaffinity(0))
    return RunOptions(
        jobs=count,
        on=on,
        limits=limits_of(count, time_limit, memory_limit),
        store=None if no_store else CacheFolder(folder=store_folder(store), fresh=fresh),
    )
