"""A module that a worker imports for as long as the test wants."""

import os
from pathlib import Path

from harness.execution.worker_main import is_worker
from tests.support.clock import wait_for

if is_worker():
    folder = Path(os.environ["SLOW_TO_IMPORT"])
    (folder / "begun").touch()
    wait_for(folder / "go-on")


def answer() -> int:
    return 42
