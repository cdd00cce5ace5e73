"""Single files that a command writes: whole or not at all, and never over a folder."""

import os
import tempfile
from pathlib import Path

from harness.errors import OutputError
from harness.metrics.motion import Motion
from harness.metrics.motion_frame import motion_frame

_SUFFIXES = (".csv", ".parquet")


def write_motion(motion: Motion, out: Path) -> None:
    """Write a motion as a table in the format that the file's name asks for.

    Raises
    ------
    OutputError
        If the name ends otherwise, or the file cannot be written.
    """
    check_motion_file(out)
    frame = motion_frame(motion)
    if out.suffix == ".csv":
        write_bytes(frame.to_csv(index=False, lineterminator="\n").encode(), out)
    else:
        write_bytes(frame.to_parquet(index=False), out)


def check_motion_file(out: Path) -> None:
    """Refuse a file for a motion that could not be written later.

    Raises
    ------
    OutputError
        If its name ends otherwise than in a known suffix, or its folder cannot be written.
    """
    if out.suffix not in _SUFFIXES:
        raise OutputError(f"cannot write '{out}': its name must end in {' or '.join(_SUFFIXES)}")
    if out.is_dir() or not out.absolute().parent.is_dir():
        raise OutputError(f"cannot write '{out}': it must be a file in a folder that exists")
    if not os.access(out.absolute().parent, os.W_OK):
        raise OutputError(f"cannot write '{out}': its folder is not writable")


def write_text(text: str, out: Path) -> None:
    """Write a text as UTF-8, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    write_bytes(text.encode(), out)


def write_bytes(content: bytes, out: Path) -> None:
    """Write a file under another name and move it into place.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    draft = None
    try:
        with tempfile.NamedTemporaryFile(
            dir=out.absolute().parent, prefix=f".{out.name}.", delete=False
        ) as file:
            draft = Path(file.name)
            file.write(content)
        draft.chmod(0o644)  # a temporary file is for its owner only
        draft.replace(out)
    except OSError as error:
        raise OutputError(f"cannot write '{out}': {error.strerror or error}") from error
    finally:
        if draft is not None:
            draft.unlink(missing_ok=True)
