"""Running on a cluster of Dask: its scheduler places the tasks, and repeats those of lost workers.

A worker of the cluster runs each task in a process of its own, within limits. So an engine that
crashes or hangs is the outcome of its case here as on one machine, and when a worker of the cluster
is lost, that is the machine's doing and the task is done elsewhere.

Environment of a machine: machines with equal descriptions compute equal bits.

A version does not change when a checkout is edited, so sources are compared as text. A
processor of the same kind is taken to compute alike.
"""

import importlib
import platform
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from types import TracebackType
from typing import Any, ParamSpec, TypeVar

from harness.core.engine_packages import ENGINE_ENTRY_POINTS, engine_packages, install_command
from harness.core.environments import environments
from harness.core.errors import (
    ClusterError,
    InvalidSettingError,
    MissingPackageError,
    UnknownEngineError,
)
from harness.core.provenance import version_of
from harness.execution.isolated_pool import run_isolated
from harness.execution.limits import Limits
from harness.execution.source_fingerprint import fingerprint
from harness.execution.worker import Loss, LostTaskError

P = ParamSpec("P")
T = TypeVar("T")

_SOURCES = "sources of rockingcan"
_IN_SOURCES = ("numpy", "scipy")
"""Packages in a fingerprint of sources; where their versions differ, sources are not compared."""

_OURS = "harness"
_NONE = "none"

_REMEDY = "have the same there as here, and start the workers again"


@dataclass(eq=False, kw_only=True)
class NoSchedulerError(ClusterError):
    """No scheduler answers at the address."""

    address: str
    reason: str

    def __str__(self) -> str:
        """Say how a cluster is started."""
        return (
            f"no Dask scheduler answers at '{self.address}' ({self.reason}); start one with: dask "
            "scheduler, and workers with: dask worker ADDRESS"
        )


@dataclass(eq=False, kw_only=True)
class NoWorkersError(ClusterError):
    """The scheduler at the address has nobody to do its tasks."""

    address: str

    def __str__(self) -> str:
        """Say how a worker is started."""
        return f"the cluster at '{self.address}' has no workers; start: dask worker ADDRESS"


@dataclass(eq=False, kw_only=True)
class UnknownWorkersError(ClusterError):
    """The workers of a cluster cannot be asked for their environment."""

    address: str
    reason: str

    def __str__(self) -> str:
        """Say why, and what to do."""
        return (
            f"workers of the cluster at '{self.address}' cannot say what they compute with "
            f"({self.reason}); {_REMEDY}"
        )


@dataclass(eq=False, kw_only=True)
class UnfitWorkersError(ClusterError):
    """Workers of a cluster have another environment; for each by its place, in what it differs."""

    address: str
    workers: Mapping[str, str]

    def __str__(self) -> str:
        """Name the workers, and say what to do."""
        each = "; ".join(f"{place} {words}" for place, words in self.workers.items())
        return (
            f"workers of the cluster at '{self.address}' would not compute as it is done here: "
            f"{each}; {_REMEDY}"
        )


@dataclass(eq=False, kw_only=True)
class LateWorkerError(ClusterError):
    """A worker that was given a task has another environment than whoever gave it."""

    node: str
    differences: tuple[str, ...]

    def __str__(self) -> str:
        """Name the machine and the differences, and say what to do."""
        return (
            f"a worker on '{self.node}' would not compute as it is done here: it has "
            f"{', '.join(self.differences)}; {_REMEDY}"
        )


@dataclass(eq=False, kw_only=True)
class NoEnvironmentError(ClusterError):
    """A worker has no environment for an engine that has one on the machine of the run."""

    node: str
    engine: str

    def __str__(self) -> str:
        """Say how to add it."""
        return (
            f"a worker on '{self.node}' has no environment of engine '{self.engine}'; add it there "
            "as here (see: rockingcan engines list --json), or leave the engine out with --engine"
        )


@dataclass(eq=False, kw_only=True)
class LostSchedulerError(ClusterError):
    """The scheduler no longer answers; `reason` is what the network says, if it says something."""

    reason: str = ""

    def __str__(self) -> str:
        """Say to start again."""
        gone = "the scheduler let go of a task, or is gone; start again to go on"
        return f"{gone} ({self.reason})" if self.reason else gone


@cache
def environment_description() -> dict[str, str]:
    """Return the environment of this process: versions and fingerprints by name."""
    return {
        "rockingcan": version_of("rockingcan", _NONE),
        _SOURCES: fingerprint(_OURS),
        "Python": f"{sys.version_info.major}.{sys.version_info.minor}",
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: version_of(name, _NONE) for name in (*_IN_SOURCES, *engine_packages())},
        **dict(_engines()),
        **{
            f"engine {name}": f"{place}, files {place.fingerprint()}"
            for name, place in environments().items()
        },
    }


def _engines() -> Iterator[tuple[str, str]]:
    """Yield the version and sources of each engine of another package, without creating it."""
    for entry in sorted(entry_points(group=ENGINE_ENTRY_POINTS), key=lambda entry: entry.name):
        package = entry.value.partition(":")[0].partition(".")[0]
        if package != _OURS:
            yield f"engine {entry.name}", f"{_origin(entry)} {fingerprint(package)}"


def _origin(entry: EntryPoint) -> str:
    return "unknown" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"


def environment_differences(there: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Return the differences in words; an engine that only one of both has is no difference."""
    both = [key for key in here if key in there and here[key] != there[key]]
    if set(_IN_SOURCES) & set(both):
        both = [key for key in both if key != _SOURCES and not key.startswith("engine ")]
    return [f"{key} {there[key]} (here {here[key]})" for key in both]


def check_same_environment(
    here: Mapping[str, str], fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs
) -> T:
    """Return the result of a function, if this process has the environment of the caller.

    Raises
    ------
    LateWorkerError
        If it has another: it joined after the check, or was started before an edit.
    """
    if other := environment_differences(environment_description(), here):
        raise LateWorkerError(node=platform.node(), differences=tuple(other))
    try:
        return fn(*args, **kwargs)
    except UnknownEngineError as error:
        if f"engine {error.name}" not in here:
            raise
        raise NoEnvironmentError(node=platform.node(), engine=error.name) from error


_PATIENCE = 10.0
"""s for a scheduler to answer."""

_ADDRESS = re.compile(
    r"((tcp|tls|ucx|ws|wss)://)?(\[[0-9a-fA-F:.]+(%\w+)?\]|[\w.-]+):(?P<port>[0-9]{1,5})/?",
    re.ASCII,
)
_LAST_PORT = 2**16 - 1
_FORM = "the address of a Dask scheduler, such as tcp://host:8786"

_TASKS_A_THREAD = 2
"""Tasks for each thread: one runs and one waits, so that the network causes no delay."""


def dask_executor(address: str, limits: Limits) -> "DaskExecutor":
    """Return an executor of the Dask cluster whose scheduler is at an address.

    Parameters
    ----------
    address : str
        Such as "tcp://host:8786".
    limits : Limits
        Of each task.

    Raises
    ------
    InvalidSettingError
        If it is no address.
    MissingPackageError
        If `distributed` is not installed.
    ClusterError
        If no scheduler answers, it has no workers, or they would not compute as this process.
    """
    check_cluster_address(address)
    try:
        dask: Any = importlib.import_module("distributed")  # an extra: most runs need no cluster
    except ImportError as error:
        install = install_command(["rockingcan[cluster]"])
        raise MissingPackageError("'--on'", "distributed", str(error), install) from error
    try:
        client = dask.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise NoSchedulerError(address=address, reason=str(error)) from error
    try:
        _check(client, address)
    except BaseException:
        client.close()
        raise
    return DaskExecutor(client, limits)


def check_cluster_address(address: str) -> None:
    """Refuse a malformed address, which Dask's own client would notice late and not release.

    Raises
    ------
    InvalidSettingError
    """
    parts = _ADDRESS.fullmatch(address)
    if parts is None or not 0 < int(parts["port"]) <= _LAST_PORT:
        raise InvalidSettingError("--on", address, _FORM)


def _check(client: Any, address: str) -> None:  # noqa: ANN401 - the package ships no types
    """Refuse a cluster that cannot run cases as they would run here."""
    workers: dict[str, dict[str, str] | Exception]
    try:
        workers = client.run(environment_description, on_error="return")
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise UnknownWorkersError(address=address, reason=reason) from error
    if not workers:
        raise NoWorkersError(address=address)
    here, others = environment_description(), {}
    for place, there in sorted(workers.items()):
        if isinstance(there, Exception):
            others[place] = f"cannot say ({type(there).__name__}: {there})"
        elif other := environment_differences(there, here):
            others[place] = f"has {', '.join(other)}"
    if others:
        raise UnfitWorkersError(address=address, workers=others)


@contextmanager
def _scheduler_errors() -> Iterator[None]:
    """Turn the errors of a scheduler that no longer answers into a `LostSchedulerError`."""
    try:
        yield
    except OSError as error:  # timeouts and closed connections of Dask are among these
        raise LostSchedulerError(reason=str(error)) from error


class DaskExecutor(Executor):
    """Runs tasks on the workers of a Dask cluster.

    Attributes
    ----------
    remote : bool
        The load of this machine says nothing of how fast they are.

    Parameters
    ----------
    client : distributed.Client
        Is closed with the executor.
    limits : Limits
        Of each task.
    """

    remote = True

    def __init__(self, client: Any, limits: Limits) -> None:  # noqa: ANN401 - it ships no types
        self._client = client
        self.limits = limits
        self._here = environment_description()
        self._futures: set[Any] = set()

    @property
    def workers(self) -> int:
        """Number of tasks that the cluster runs side by side."""
        with _scheduler_errors():
            threads: dict[str, int] = self._client.nthreads()
        return max(1, sum(threads.values()))

    @property
    def window(self) -> int:
        """Number of tasks that keep the executor busy."""
        return _TASKS_A_THREAD * self.workers

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Submit a task; its exception, if any, is in the future."""
        future: Future[T] = Future()
        future.set_running_or_notify_cancel()
        with _scheduler_errors():  # not pure: two tasks alike are two tasks
            theirs = self._client.submit(
                run_isolated,
                self.limits,
                check_same_environment,
                self._here,
                fn,
                *args,
                pure=False,
                **kwargs,
            )
        self._futures.add(theirs)
        theirs.add_done_callback(lambda done: self._settle(future, done))
        return future

    def _settle(self, future: "Future[T]", done: Any) -> None:  # noqa: ANN401 - it ships no types
        """Copy the result or error of the cluster into the future."""
        dask: Any = importlib.import_module("distributed")
        try:
            future.set_result(done.result())
        except dask.KilledWorker as error:
            future.set_exception(LostTaskError(Loss.STOPPED, f"killed: with its worker, {error}"))
        except CancelledError:
            future.set_exception(LostSchedulerError())
        except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
            future.set_exception(error)
        finally:
            self._futures.discard(done)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 - as in the interface
        """Disconnect from the cluster, which goes on."""
        if cancel_futures or not wait:
            self._client.cancel(list(self._futures))
        self._client.close()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Disconnect from the cluster; after an error, cancel its tasks too."""
        del error, trace
        self.shutdown(cancel_futures=kind is not None)
