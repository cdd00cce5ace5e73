"""A folder that appears whole or not at all.

A report is written into a hidden folder beside its place and moved there at the end. An earlier
report is moved aside first and comes back if the move fails; whatever happens, interruption
included, no half-written folder stays.
"""

import json
import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from harness.core.writing import ForeignFolderError, WriteError, writing

MANIFEST = "manifest.json"
FORMAT = "rockingcan-report"
_WHAT = "a report to"


def check_writable(out: Path) -> None:
    """Refuse a folder at once that `write_report` would refuse at the end of a long run.

    Parameters
    ----------
    out : Path
        Folder of a report to be.

    Raises
    ------
    OutputError
        If nothing can be written there, or something is there that is not a report of rockingcan.
    """
    out = out.absolute()
    with _writing(out):
        _refuse_foreign(out)
        place = next(folder for folder in out.parents if folder.exists())
        probe = place / _hidden(out, "probe")
        probe.mkdir()
        probe.rmdir()


@contextmanager
def replace_folder(out: Path) -> Iterator[Path]:
    """Give an empty folder to write into, which takes the place of `out` when all went well.

    Yields
    ------
    Path
        The folder to write into.

    Raises
    ------
    OutputError
        As for `check_writable`.
    """
    out = out.absolute()
    with _writing(out):
        _refuse_foreign(out)
        out = out.resolve()  # the folder behind a link is replaced, not the link
        draft = out.parent / _hidden(out, "draft")
        try:
            draft.mkdir(parents=True)
            yield draft
            _take_place(draft, out)
        finally:
            shutil.rmtree(draft, ignore_errors=True)


def _take_place(draft: Path, out: Path) -> None:
    aside = out.parent / _hidden(out, "aside")
    earlier = out.exists()
    try:
        if earlier:
            out.rename(aside)
        draft.rename(out)
    except BaseException:  # Ctrl-C between the two moves too
        if aside.exists() and not out.exists():
            aside.rename(out)
        raise
    finally:
        if out.exists():
            shutil.rmtree(aside, ignore_errors=True)


def _refuse_foreign(out: Path) -> None:
    """Refuse to replace a file, or a folder that is no report."""
    if not out.exists():
        if out.is_symlink():
            raise WriteError(path=out, reason="the link leads nowhere", what=_WHAT)
        return
    if not out.is_dir():
        raise WriteError(path=out, reason="it is a file, not a folder", what=_WHAT)
    if any(out.iterdir()) and not _is_report(out):
        raise ForeignFolderError(
            path=out,
            action="replace",
            thing="report",
            fix="choose another folder with --out, or empty it",
        )


def _is_report(folder: Path) -> bool:
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(manifest, dict) and manifest.get("format") == FORMAT


def _hidden(out: Path, purpose: str) -> str:
    return f".{out.name}.{purpose}-{os.getpid()}-{uuid.uuid4().hex[:8]}"


def _writing(out: Path) -> AbstractContextManager[None]:
    return writing(out, _WHAT, "choose a folder that you may write to with --out")
