"""Run a command, and turn what went wrong into a message and a code.

0 done; 1 a fidelity gate failed; 2 wrong use or bad input, with one message; 130 interrupted.
"""

import os
import sys

import typer
from typer.exceptions import TyperException

from harness.cli.commands import app
from harness.errors import HarnessError, ParityError
from models.errors import ModelError

GATE_FAILED = 1
WRONG_USE = 2
INTERRUPTED = 130


def main() -> None:
    """Run the command line and leave with its exit code."""
    _keep_standard_output()
    sys.exit(code_of(sys.argv[1:]))


def code_of(arguments: list[str]) -> int:
    """Run a command and return its exit code."""
    try:
        code = app(arguments, prog_name="rockingcan", standalone_mode=False)
    except (HarnessError, ModelError) as error:
        failed = isinstance(error, ParityError)
        return _complain(str(error), GATE_FAILED if failed else WRONG_USE)
    except TyperException as error:
        return _complain(f"{_told(error)} (see: rockingcan --help)")
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


def _told(error: TyperException) -> str:
    """Return what the command line's own error says."""
    message = getattr(error, "format_message", None)
    return (str(message()) if callable(message) else str(error)).rstrip(".")


def _complain(message: str, code: int = WRONG_USE) -> int:
    """Say on standard error what was wrong, and return the exit code."""
    sys.stderr.write(f"rockingcan: {message}\n")
    return code


def _keep_standard_output() -> None:
    """Keep standard output for answers: what engines print from C goes to standard error."""
    sys.stdout.flush()
    answers = os.dup(1)
    os.dup2(2, 1)
    sys.stdout = os.fdopen(answers, "w", encoding="utf-8")
