"""Signals that end a run: they wait until a file that is being written is complete.

A program that calls `handle_signals` is stopped by Ctrl-C and by SIGTERM alike, with an exception
that passes through everything and says which it was. Inside `delay_signals` a signal is only noted,
and acts at the end of the block. One signal is enough: those that follow are not to disturb the
clean-up, unless it takes so long that somebody has to ask again. Before there is anything to clean
up, `exit_on_signal` is what a signal is for.
"""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)

PATIENCE = 5.0
"""s after the first signal in which further signals are ignored; a later one ends the program."""

_STANDARD_ERROR = 2  # whatever stands in for it in Python may be in the middle of a line

_AGAIN = "rockingcan: left at once; what is kept is whole, and the same command goes on with it\n"


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
_asked: float | None = None


def handle_signals() -> None:
    """Turn the first signal into `Interrupted` from now on; to be called in the main thread."""
    global _asked  # noqa: PLW0603 - there is one main thread, and signals are heard there
    _asked = None
    for number in SIGNALS:
        signal.signal(number, _received)


def exit_on_signal(words: str) -> None:
    """Have a signal end the program where it stands, from now on, with a line and its code.

    Parameters
    ----------
    words : str
        The line; none if it is empty.
    """

    def leave(signum: int, frame: FrameType | None) -> None:
        del frame
        _leave(signum, f"rockingcan: {words}\n" if words else "")

    for number in SIGNALS:
        signal.signal(number, leave)


@contextmanager
def delay_signals() -> Iterator[None]:
    """Let signals that `handle_signals` hears wait until the block is done."""
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
            raise Interrupted(_waiting.pop())


def _received(signum: int, frame: FrameType | None) -> None:
    """Stop now, or note it while something is being written; once."""
    global _asked  # noqa: PLW0603 - there is one main thread, and signals are heard there
    del frame
    now = time.monotonic()
    if _asked is not None:
        if now - _asked > PATIENCE:
            _leave(signum, _AGAIN)
        return
    _asked = now
    if _depth:
        _waiting.append(signum)
        return
    raise Interrupted(signum)


def _leave(signum: int, words: str) -> None:
    """End the program as `kill -9` does, from which all is made to recover, but with its code."""
    try:
        os.write(_STANDARD_ERROR, words.encode())
    finally:
        os._exit(128 + signum)
