"""Running on a cluster of Dask: its scheduler places the tasks, and repeats those of lost workers.

A worker of the cluster does each task in a process beside it, within limits. So an engine that
crashes or hangs is the outcome of its case here as on one machine, and when a worker of the cluster
is lost, that is the machine's doing and the task is done elsewhere.
"""

import importlib
import re
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from types import TracebackType
from typing import Any, ParamSpec, TypeVar

from harness.errors import ClusterError, InvalidSettingError, MissingPackageError
from harness.executors.likeness import REMEDY, alike, differences, likeness
from harness.executors.local import IMPORTS
from harness.isolation import Limits, Loss, LostTaskError, inside

P = ParamSpec("P")
T = TypeVar("T")

_PATIENCE = 10.0
"""s for a scheduler to answer."""

_ADDRESS = re.compile(
    r"((tcp|tls|ucx|ws|wss)://)?(\[[0-9a-fA-F:.]+(%\w+)?\]|[\w.-]+):(?P<port>[0-9]{1,5})/?",
    re.ASCII,
)
_LAST_PORT = 2**16 - 1
_FORM = "the address of a Dask scheduler, such as tcp://host:8786"

_GONE = "the scheduler let go of a task, or is gone; start again to go on"

_TASKS_A_THREAD = 2
"""One that runs and one that has arrived: the network's delay does not show."""


def cluster(address: str, limits: Limits, imports: tuple[str, ...] = IMPORTS) -> "Cluster":
    """Return an executor of the Dask cluster whose scheduler is at an address.

    Parameters
    ----------
    address : str
        Such as "tcp://host:8786".
    limits : Limits
        Of each task.
    imports : tuple of str
        What a process imports at its start, before the time of a task runs.

    Raises
    ------
    InvalidSettingError
        If it is no address.
    MissingPackageError
        If `distributed` is not installed.
    ClusterError
        If no scheduler answers, it has no workers, or they would not compute as this process.
    """
    check_address(address)
    try:
        dask: Any = importlib.import_module("distributed")  # an extra: most runs need no cluster
    except ImportError as error:
        raise MissingPackageError("--on", "rockingcan[cluster]", str(error)) from error
    try:
        client = dask.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at '{address}' ({error}); start one with: dask scheduler, "
            "and workers with: dask worker ADDRESS"
        ) from error
    try:
        _check(client, address)
    except BaseException:
        client.close()
        raise
    return Cluster(client, limits, imports)


def check_address(address: str) -> None:
    """Refuse what is no address; Dask's own client would find out late, and not let go.

    Raises
    ------
    InvalidSettingError
    """
    found = _ADDRESS.fullmatch(address)
    if found is None or not 0 < int(found["port"]) <= _LAST_PORT:
        raise InvalidSettingError("--on", address, _FORM)


def _check(client: Any, address: str) -> None:  # noqa: ANN401 - the package ships no types
    """Refuse a cluster that cannot run cases as they would run here."""
    found: dict[str, dict[str, str] | Exception]
    try:
        found = client.run(likeness, on_error="return")
    except Exception as error:
        raise ClusterError(
            f"workers of the cluster at '{address}' cannot say what they compute with "
            f"({type(error).__name__}: {error}); {REMEDY}"
        ) from error
    if not found:
        raise ClusterError(f"the cluster at '{address}' has no workers; start: dask worker ADDRESS")
    here, others = likeness(), []
    for place, there in sorted(found.items()):
        if isinstance(there, Exception):
            others.append(f"{place} cannot say ({type(there).__name__}: {there})")
        elif other := differences(there, here):
            others.append(f"{place} has {', '.join(other)}")
    if others:
        raise ClusterError(
            f"workers of the cluster at '{address}' would not compute as it is done here: "
            f"{'; '.join(others)}; {REMEDY}"
        )


@contextmanager
def _reached() -> Iterator[None]:
    """Say of a scheduler that no longer answers that it is gone."""
    try:
        yield
    except OSError as error:  # timeouts and closed connections of Dask are among these
        raise ClusterError(f"{_GONE} ({error})") from error


class Cluster(Executor):
    """Runs tasks on the workers of a Dask cluster.

    Parameters
    ----------
    client : distributed.Client
        Is closed with the executor.
    limits : Limits
        Of each task.
    imports : tuple of str
        What a process imports at its start, before the time of a task runs.
    """

    def __init__(
        self,
        client: Any,  # noqa: ANN401 - it ships no types
        limits: Limits,
        imports: tuple[str, ...] = IMPORTS,
    ) -> None:
        self._client = client
        self.limits = limits
        self._imports = imports
        self._here = likeness()
        self._futures: set[Any] = set()

    @property
    def window(self) -> int:
        """How many tasks keep it busy."""
        with _reached():
            threads: dict[str, int] = self._client.nthreads()
        return _TASKS_A_THREAD * max(1, sum(threads.values()))

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Have a task done; its exception, if any, is in the future."""
        future: Future[T] = Future()
        future.set_running_or_notify_cancel()
        with _reached():  # not pure: two tasks alike are two tasks
            theirs = self._client.submit(
                inside,
                self.limits,
                self._imports,
                alike,
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
        """Hand on what the cluster answered."""
        dask: Any = importlib.import_module("distributed")
        try:
            future.set_result(done.result())
        except dask.KilledWorker as error:
            future.set_exception(LostTaskError(Loss.STOPPED, f"killed: with its worker, {error}"))
        except CancelledError:
            future.set_exception(ClusterError(_GONE))
        except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
            future.set_exception(error)
        finally:
            self._futures.discard(done)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 - as in the interface
        """Let go of the cluster, which goes on."""
        if cancel_futures or not wait:
            self._client.cancel(list(self._futures))
        self._client.close()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Let go of the cluster; after an error, with what it was to do."""
        del error, trace
        self.shutdown(cancel_futures=kind is not None)
