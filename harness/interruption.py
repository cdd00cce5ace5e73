"""Signals that end a run: they wait until what is being written is whole.

A program that installs `listen` is stopped by Ctrl-C and by SIGTERM alike, with an exception that
passes through everything and says which it was. Inside `finishing` a signal is only noted, and
acts at the end of the block.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupted(BaseException):
    """The program was asked to stop.

    Parameters
    ----------
    signum : int
        Which signal asked.
    """

    def __init__(self, signum: int) -> None:
        super().__init__(signum)
        self.signum = signum

    @property
    def exit_code(self) -> int:
        """The code to leave with, as shells have it: 130 for Ctrl-C, 143 for SIGTERM."""
        return 128 + self.signum


_waiting: list[int] = []
_depth = 0


def listen() -> None:
    """Turn the signals into `Interrupted` from now on; to be called in the main thread."""
    for number in SIGNALS:
        signal.signal(number, _received)


@contextmanager
def finishing() -> Iterator[None]:
    """Let signals that `listen` hears wait until the block is done."""
    global _depth  # noqa: PLW0603 - there is one main thread, and signals are heard there
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1
        if _depth == 0 and _waiting:
            first = _waiting[0]
            _waiting.clear()
            raise Interrupted(first)


def _received(signum: int, frame: FrameType | None) -> None:
    """Stop now, or note it while something is being written."""
    del frame
    if _depth:
        _waiting.append(signum)
        return
    raise Interrupted(signum)
