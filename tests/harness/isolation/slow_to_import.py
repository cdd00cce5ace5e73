"""A module that a worker imports for longer than a test gives its task."""

import time

from harness.execution.worker_main import is_worker

if is_worker():
    time.sleep(3.0)


def answer() -> int:
    return 42
