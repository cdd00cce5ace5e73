"""What was measured, kept on disk: a small JSON file a case, there whole or not at all.

A run that is interrupted finds on the next start what it had measured, and does only the rest.
"""

import json
import os
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.errors import OutputError

Record = dict[str, Any]
"""What JSON can hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """A folder of records of one kind.

    Parameters
    ----------
    folder : Path
        Is made when the first record is kept.
    """

    folder: Path

    def get(self, key: str) -> Record | None:
        """Return a record, or None if there is none that can be read."""
        try:
            found = json.loads(self._path(key).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found if isinstance(found, dict) else None

    def put(self, key: str, record: Mapping[str, Any]) -> None:
        """Keep a record.

        Raises
        ------
        OutputError
            If the folder cannot be written to.
        """
        path = self._path(key)
        draft = path.with_name(f".{path.name}.{os.getpid()}-{uuid.uuid4().hex[:8]}")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            draft.write_text(json.dumps(record, allow_nan=False, indent=1), encoding="utf-8")
            draft.replace(path)
        except OSError as error:
            raise OutputError(f"cannot write to '{self.folder}': {error.strerror}") from error
        finally:
            draft.unlink(missing_ok=True)

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.json"
