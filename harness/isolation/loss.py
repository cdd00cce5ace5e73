"""What is said of a task whose process did not come back."""

import signal
from concurrent.futures import BrokenExecutor
from enum import Enum


class Loss(Enum):
    """Why a task has no result."""

    CRASHED = "its process died"
    HUNG = "it took longer than it may"
    OUT_OF_MEMORY = "it used more memory than it may"
    STOPPED = "its process was stopped from outside"


class LostTaskError(BrokenExecutor):
    """A task has no result, because its process died or had to be stopped.

    Parameters
    ----------
    loss : Loss
    reason : str
        What happened, in a sentence.
    """

    def __init__(self, loss: Loss, reason: str) -> None:
        super().__init__(loss, reason)
        self.loss = loss
        self.reason = reason

    def __str__(self) -> str:
        """Return the sentence."""
        return self.reason


_WORDS = {
    signal.SIGSEGV: "segmentation fault",
    signal.SIGBUS: "bus error",
    signal.SIGABRT: "abort",
    signal.SIGILL: "illegal instruction",
    signal.SIGFPE: "arithmetic fault",
}


def of_exit(code: int) -> LostTaskError:
    """Return what the exit code of a worker says that died by itself, as `subprocess` has it."""
    if code >= 0:
        return LostTaskError(Loss.CRASHED, f"killed: the engine left its process with code {code}")
    number = -code
    name = signal.Signals(number).name if number in set(signal.Signals) else f"signal {number}"
    if number in _WORDS:
        return LostTaskError(Loss.CRASHED, f"killed: {name}, {_WORDS[signal.Signals(number)]}")
    if number == signal.SIGKILL:
        return LostTaskError(
            Loss.STOPPED,
            "killed: SIGKILL from outside, as the system does when its memory runs out",
        )
    return LostTaskError(Loss.STOPPED, f"killed: {name} from outside")


def of_silence() -> LostTaskError:
    """Return that a worker was ended because it could not answer any more."""
    return LostTaskError(
        Loss.CRASHED, "killed: the engine closed its process's connection to the run"
    )


def of_stop() -> LostTaskError:
    """Return that a worker was ended because the run was."""
    return LostTaskError(Loss.STOPPED, "killed: the run was stopped")


def of_want(error: OSError) -> LostTaskError:
    """Return that the system has no process, memory or file left to begin with."""
    return LostTaskError(Loss.STOPPED, f"never begun: no process can be started: {error}")


def of_time(seconds: float) -> LostTaskError:
    """Return that a task was stopped for its time."""
    return LostTaskError(Loss.HUNG, f"killed: it ran longer than the {seconds:g} s allowed")


def of_memory(most: float) -> LostTaskError:
    """Return that a task was stopped for its memory."""
    return LostTaskError(
        Loss.OUT_OF_MEMORY, f"killed: it used more than the {most / 2**30:.3g} GiB allowed"
    )
