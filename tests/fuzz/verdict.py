"""What a command makes of a scene file: whether it answers as it must, in the time it may take."""

import contextlib
import io
import json
import signal
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from harness.cli.main import code_of

LONGEST = 20.0
"""s of the processor for one command: a scene takes a tenth of a second, the hardest ten."""

GOOD, WRONG_USE = 0, 2


@dataclass(frozen=True)
class Verdict:
    """How a command answered.

    Parameters
    ----------
    code : int
    seconds : float
        Of the processor.
    fault : str
        In what it did not answer as it must; empty if it did.
    """

    code: int
    seconds: float
    fault: str = ""


class _HangError(BaseException):
    """A command took too long."""


def judged(words: Sequence[str]) -> Verdict:
    """Run a command in this process and judge its answer.

    It must leave with 0 and an answer that can be read, or with 2, nothing on standard output and a
    message on standard error.
    """
    out, err = io.StringIO(), io.StringIO()
    started = time.process_time()
    code, fault = -1, ""
    try:
        with _watched(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = code_of(list(words))
    except _HangError:
        fault = f"it did not end within {LONGEST:g} s of the processor"
    except BaseException as error:  # noqa: BLE001 - whatever comes out is a traceback to a user
        fault = f"it raised {type(error).__name__}: {error}"
    seconds = time.process_time() - started
    return Verdict(code, seconds, fault or _fault(words, code, out.getvalue(), err.getvalue()))


def _fault(words: Sequence[str], code: int, out: str, err: str) -> str:
    """Return what is wrong with an answer."""
    if "Traceback" in err or "Traceback" in out:
        return "it printed a traceback"
    if code == GOOD:
        return f"it warned: {err[-200:]}" if "Warning" in err else _unreadable(words, out)
    if code != WRONG_USE:
        return f"it left with code {code}: {err[-200:]}"
    if not err.startswith("rockingcan: ") or not err.removeprefix("rockingcan: ").strip():
        return f"its message is none: {err[:200]!r}"
    return "it refused, and answered" if out else ""


def _unreadable(words: Sequence[str], out: str) -> str:
    """Return why an answer cannot be read; empty if it can."""
    try:
        if words[0] == "export":
            ET.fromstring(out)  # noqa: S314 - of our own making
        else:
            json.loads(out, parse_constant=_refuse)
    except (ValueError, ET.ParseError) as error:
        return f"its answer cannot be read: {error}"
    return ""


def _refuse(word: str) -> None:
    raise ValueError(f"{word} is not JSON")


@contextlib.contextmanager
def _watched() -> Iterator[None]:
    """End what takes too long."""

    def ring(signum: int, frame: FrameType | None) -> None:
        del signum, frame
        raise _HangError

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def commands(path: Path, number: int) -> list[list[str]]:
    """Return the commands that a scene file is given to: all of them once in ten files."""
    every = [["reference", str(path), "--json"]]
    if number % 10 == 0:
        every += [["export", str(path), "--format", form] for form in ("mjcf", "urdf")]
        every += [["run", str(path), "--engine", "mujoco", "--timestep", "1e-3", "--json"]]
    return every
