"""Running a command line, and turning errors into a message and a code.

0 done; 1 a fidelity gate failed; 2 wrong use or bad input, with one message; 130 and 143 stopped by
Ctrl-C and by SIGTERM, with what is done and how to go on. Standard output is for answers alone, and
may lead to a disk that is full.
"""

import io
import os
import shlex
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer
from typer.exceptions import TyperException

from harness.cli.commands import app
from harness.core.errors import CacheWarning, HarnessError, OutputError, ParityError
from harness.core.public_paths import RenamedValueWarning
from harness.execution.isolated_pool import end_background_worker
from harness.execution.signals import Interrupted, exit_on_signal, handle_signals
from models.errors import ModelError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


@dataclass(eq=False, kw_only=True)
class StandardOutputError(OutputError):
    """Standard output takes no more, such as into a file on a full disk."""

    reason: str

    def __str__(self) -> str:
        """Say why."""
        return f"cannot write to standard output: {self.reason}"


class _Answers(io.FileIO):
    """Standard output for answers. Raises once that it cannot write, and drops all that follows."""

    _failed = False

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write as much as fits.

        Raises
        ------
        BrokenPipeError
            If nobody reads any more.
        StandardOutputError
            If it cannot be written for another reason.
        """
        if self._failed:  # what is buffered comes again when the program leaves
            return memoryview(data).nbytes
        try:
            return super().write(data)
        except BrokenPipeError:
            raise
        except OSError as error:
            self._failed = True
            raise StandardOutputError(reason=error.strerror or str(error)) from error


def keep_for_answers() -> None:
    """Keep standard output for answers: what engines print from C goes to standard error."""
    sys.stdout.flush()
    answers = _Answers(os.dup(1), "w")
    os.dup2(2, 1)
    sys.stdout = io.TextIOWrapper(
        io.BufferedWriter(answers), encoding="utf-8", line_buffering=answers.isatty()
    )


GATE_FAILED = 1
WRONG_USE = 2
INTERRUPTED = 130


def main(program: typer.Typer = app, name: str = "rockingcan") -> None:
    """Run a command line and leave with its exit code.

    Parameters
    ----------
    program : typer.Typer
    name : str
        As it is typed.
    """
    arguments = sys.argv[1:]
    try:
        handle_signals()
        keep_for_answers()
        code = code_of(arguments, program, name)
        end_background_worker()
        exit_on_signal("")  # all is said and done
    except Interrupted as error:  # between the command and here
        code = _complain(_stopped(error, name, arguments), error.exit_code)
        end_background_worker()
    if code >= INTERRUPTED:
        # nothing is left to clean up, and a signal more would end the interpreter's own untidily
        with suppress(HarnessError, OSError):
            sys.stdout.flush()
        os._exit(code)
    sys.exit(code)


def code_of(arguments: list[str], program: typer.Typer = app, name: str = "rockingcan") -> int:
    """Run a command and return its exit code."""
    with warnings.catch_warnings():
        for own in (CacheWarning, RenamedValueWarning):
            warnings.simplefilter("always", own)
        warnings.showwarning = _shown(warnings.showwarning)
        try:
            code = program(arguments, prog_name=name, standalone_mode=False)
            sys.stdout.flush()  # what cannot be said is to be known before the code is
        except Interrupted as error:
            return _complain(_stopped(error, name, arguments), error.exit_code)
        except (HarnessError, ModelError, TyperException) as error:
            return _refused(error)
        except typer.Exit as left:
            return int(left.exit_code)
        except (KeyboardInterrupt, typer.Abort):
            code = INTERRUPTED
        except BrokenPipeError:  # whoever reads our output has seen enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
    if code == INTERRUPTED:
        return _complain("interrupted; nothing half-written is left behind", INTERRUPTED)
    return int(code or 0)


def _refused(error: Exception) -> int:
    """Print the message of a wrong use or a failed gate, and return the exit code."""
    if isinstance(error, TyperException):
        return _complain(f"{_own_message(error)} (see: rockingcan --help)")
    failed = isinstance(error, ParityError)
    # of which case it is, and what is done
    notes = " ".join(getattr(error, "__notes__", ()))
    message = f"{error}. {notes}" if notes else str(error)
    return _complain(message, GATE_FAILED if failed else WRONG_USE)


def _stopped(error: Interrupted, name: str, arguments: Sequence[str]) -> str:
    """Return how far a stopped run came, and the command that goes on with it."""
    # what --fresh was to replace is replaced as far as the run came
    again = shlex.join([*name.split(), *(word for word in arguments if word != "--fresh")])
    notes = getattr(error, "__notes__", ())
    sentences = ["interrupted; nothing half-written is left behind.", *notes]
    return " ".join([*sentences, f"To go on: {again}" if notes else f"To start again: {again}"])


def _shown(usual: Callable[..., None]) -> Callable[..., None]:
    """Return a function that shows warnings: our own in one line and once, others as usual."""
    shown: set[str] = set()

    def show(message: object, category: type[Warning], *place: object) -> None:
        if not issubclass(category, (CacheWarning, RenamedValueWarning)):
            usual(message, category, *place)
        elif str(message) not in shown:
            shown.add(str(message))
            sys.stderr.write(f"rockingcan: warning: {message}\n")

    return show


def _own_message(error: TyperException) -> str:
    """Return the message of an error of the command line's own."""
    message = getattr(error, "format_message", None)
    return (str(message()) if callable(message) else str(error)).rstrip(".")


def _complain(message: str, code: int = WRONG_USE) -> int:
    """Print a message on standard error, each line as ours, and return the exit code."""
    sys.stderr.writelines(f"rockingcan: {line}\n" for line in message.splitlines())
    return code
