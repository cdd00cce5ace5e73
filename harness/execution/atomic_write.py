"""Atomic writing of a file: written as a draft, flushed to the disk, renamed."""

import os
import uuid
from contextlib import suppress
from pathlib import Path

DRAFT_SUFFIX = ".draft"


def write_atomically(path: Path, content: bytes, *, draft: Path | None = None) -> None:
    """Write a file completely or not at all, also if the power is cut.

    Parameters
    ----------
    path : Path
        In a folder that exists; an existing file is replaced.
    content : bytes
    draft : Path, optional
        Name of the file while it is written, on the same file system; a hidden name in its folder,
        with the suffix ``.draft``, if left out. A program that is killed leaves it.

    Raises
    ------
    OSError
        If it cannot be written. The earlier file is then unchanged, and the draft is removed.
    """
    name = f".{path.name}.{os.getpid()}-{uuid.uuid4().hex[:8]}{DRAFT_SUFFIX}"
    place = path.with_name(name) if draft is None else draft
    try:
        with place.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        place.replace(path)
    except BaseException:
        with suppress(OSError):
            place.unlink(missing_ok=True)
        raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
