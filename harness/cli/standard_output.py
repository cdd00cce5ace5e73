"""Standard output, which is for answers alone, and may lead to a disk that is full."""

import io
import os
import sys
from typing import TYPE_CHECKING

from harness.errors import OutputError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class _Answers(io.FileIO):
    """Where answers go. Says once that it cannot write; what comes after that goes nowhere."""

    _failed = False

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write what fits.

        Raises
        ------
        BrokenPipeError
            If nobody reads any more.
        OutputError
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
            told = f"cannot write to standard output: {error.strerror or error}"
            raise OutputError(told) from error


def keep_for_answers() -> None:
    """Keep standard output for answers: what engines print from C goes to standard error."""
    sys.stdout.flush()
    answers = _Answers(os.dup(1), "w")
    os.dup2(2, 1)
    sys.stdout = io.TextIOWrapper(
        io.BufferedWriter(answers), encoding="utf-8", line_buffering=answers.isatty()
    )
