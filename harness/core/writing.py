"""What cannot be written, and why: errors of files and folders."""

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from harness.core.errors import HarnessError, OutputError


@dataclass(eq=False, kw_only=True)
class WriteError(OutputError):
    """A file or folder cannot be written.

    Parameters
    ----------
    path : Path
    reason : str
    what : str
        What is written there, with its preposition: ``a report to``; nothing for the file itself.
    fix : str
        What to do about it.
    """

    path: Path
    reason: str
    what: str = ""
    fix: str = ""

    def __str__(self) -> str:
        """Say what cannot be written where, why, and what to do."""
        what, fix = self.what and f"{self.what} ", self.fix and f"; {self.fix}"
        return f"cannot write {what}'{self.path}': {self.reason}{fix}"


@dataclass(eq=False, kw_only=True)
class ForeignFolderError(OutputError):
    """A folder holds something else than what is to be written there, and is left as it is.

    Parameters
    ----------
    path : Path
    action : str
        What is refused: ``replace``, ``write a sweep to``.
    thing : str
        What the folder does not hold.
    fix : str
        What to do about it.
    """

    path: Path
    action: str
    thing: str
    fix: str

    def __str__(self) -> str:
        """Say what the folder does not hold."""
        return (
            f"will not {self.action} '{self.path}': the folder is not empty and holds no "
            f"{self.thing} of rockingcan; {self.fix}"
        )


@dataclass(eq=False, kw_only=True)
class UndrawnFiguresError(OutputError):
    """A report is written, but the processes that drew some of its figures for paper have died.

    Parameters
    ----------
    folder : Path
        Of the report.
    titles : tuple of str
        Of these figures.
    reason : str
        What happened to the first.
    """

    folder: Path
    titles: tuple[str, ...]
    reason: str

    def __str__(self) -> str:
        """Name the figures and how they are drawn again."""
        titles = ", ".join(f"'{title}'" for title in self.titles)
        return (
            f"the report in '{self.folder}' is written without the figures for paper of {titles} "
            f"({self.reason}); to draw them again: rockingcan report "
            f"{shlex.quote(str(self.folder))} --figures"
        )


@contextmanager
def writing(path: Path, what: str = "", fix: str = "") -> Iterator[None]:
    """Turn an `OSError` within into a `WriteError`.

    Parameters
    ----------
    path : Path
    what, fix : str
        As in `WriteError`.

    Raises
    ------
    WriteError
        For an `OSError` within; a `HarnessError` within is raised as it is.
    """
    try:
        yield
    except HarnessError:
        raise
    except OSError as error:
        reason = error.strerror or str(error)
        raise WriteError(path=path, reason=reason, what=what, fix=fix) from error
