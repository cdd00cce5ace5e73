"""Where cases run: anything with the interface of `concurrent.futures.Executor`."""

from harness.executors.clusters import cluster
from harness.executors.local import Serial, local

__all__ = ["Serial", "cluster", "local"]
