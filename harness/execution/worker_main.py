"""The program of a worker process: take a task, do it, send the result; end with the owner.

Started as a program of its own, not as a fork: engines hold threads and global state.
"""

import copyreg
import ctypes
import importlib
import os
import pickle
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType, MappingProxyType

from harness.core.environments import Environment, work_for
from harness.core.errors import HarnessError
from harness.core.public_paths import RenamedValueWarning
from harness.execution.signals import SIGNALS
from harness.execution.source_fingerprint import sources_fingerprint

READY = b"ready"
"""First word of a worker; in an environment the fingerprint of its sources follows."""

COMPILING, COMPILED = b"compiling ", b"compiled"
"""What a worker says within a task: an engine compiles itself, its name, and that it has."""

_PR_SET_PDEATHSIG = 1  # of prctl(2)
_SHED_FIRST = "500"  # of 1000: short of memory, the system takes a worker and not the run


def _read_only(content: dict[object, object]) -> MappingProxyType[object, object]:
    """Return a mapping that cannot be changed."""
    return MappingProxyType(content)


# what an engine declares is read-only, and is sent to whoever asks: pickle does not know how
copyreg.pickle(MappingProxyType, lambda mapping: (_read_only, (dict(mapping),)))

_serving = False
_owner: Connection | None = None


def is_worker() -> bool:
    """Whether this process is one that serves tasks."""
    return _serving


@contextmanager
def compiling(engine: str) -> Iterator[None]:
    """Tell the owner of this process, if it has one, that an engine compiles itself meanwhile."""
    if _owner is not None:
        _owner.send_bytes(COMPILING + engine.encode())
    try:
        yield
    finally:
        if _owner is not None:
            _owner.send_bytes(COMPILED)


def serve(handle: int, owner: int, imports: tuple[str, ...], environment: str = "") -> None:
    """Serve tasks from a connection until it is closed.

    Parameters
    ----------
    handle : int
        File descriptor of the connection.
    owner : int
        Process that started this one.
    imports : tuple of str
        Modules to import before the first task, so that no task's time is theirs.
    environment : str
        The environment, as JSON, of which this is a worker; empty if it is of none.
    """
    global _serving, _owner  # noqa: PLW0603 - what this process is, from its first moment to its last
    _serving = True
    _die_with(owner)
    _ignore_signals()
    # its group is in the background of a terminal, where it may still write errors
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    # of an old name in the options the owner has warned
    warnings.simplefilter("ignore", RenamedValueWarning)
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text(_SHED_FIRST, encoding="ascii")
    if environment:
        work_for(Environment.from_json(environment))
    for name in imports:
        with suppress(Exception):  # the task meets the same error, and answers with it
            importlib.import_module(name)
    connection = _owner = Connection(handle)
    sources = sources_fingerprint().encode() if environment else b""
    connection.send_bytes(READY + b" " + sources)
    while True:
        try:
            task = connection.recv_bytes()
        except EOFError:
            return
        connection.send_bytes(_done(task))


def _die_with(owner: int) -> None:
    """Have the system end this process when the thread that started it ends, on Linux."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != owner:  # it ended before that
        os._exit(1)


def _ignore_signals() -> None:
    """Do nothing at the signals that end a run: the owner handles them, and ends this process.

    The signals are blocked at the start, and blocked or ignored signals would stay so in processes
    that a task starts and may want to end. A handler is not inherited by a program that is started,
    and is reset after a fork.
    """
    for number in SIGNALS:
        signal.signal(number, _do_nothing)
    os.register_at_fork(after_in_child=_restore_default_handlers)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def _do_nothing(signum: int, frame: FrameType | None) -> None:
    """Return, so that the process goes on."""
    del signum, frame


def _restore_default_handlers() -> None:
    """Reset the handlers of these signals, unless a task has set its own."""
    for number in SIGNALS:
        if signal.getsignal(number) is _do_nothing:
            signal.signal(number, signal.SIG_DFL)


def _done(task: bytes) -> bytes:
    """Return the pickled pair of a result and an error, one of them None."""
    try:
        fn, args, kwargs = pickle.loads(task)  # noqa: S301 - from the owner of this process
        return pickle.dumps((fn(*args, **kwargs), None), pickle.HIGHEST_PROTOCOL)
    except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
        sent = _portable(error)
        if not isinstance(error, HarnessError):  # its message is complete
            sent.add_note(f"in a worker:\n{traceback.format_exc()}")
        return pickle.dumps((None, sent), pickle.HIGHEST_PROTOCOL)


def _portable(error: Exception) -> Exception:
    """Return an error that another process can be sent, of the same kind where possible."""
    with suppress(Exception):
        copy = pickle.loads(pickle.dumps(error))  # noqa: S301 - just made
        if isinstance(copy, type(error)) and str(copy) == str(error):
            return error
    message = ""
    with suppress(Exception):  # the error of another package may raise in `__str__`
        message = str(error)
    # an ancestor whose only argument is the message: for `HarnessError`s the root class
    simple = next((kind for kind in type(error).__mro__ if "__init__" not in vars(kind)), None)
    with suppress(Exception):
        sent = simple(message) if simple is not None else None
        if isinstance(sent, Exception):
            return sent
    return RuntimeError(f"{type(error).__name__}: {message}")
