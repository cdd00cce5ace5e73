"""Where cases run: anything with the interface of `concurrent.futures.Executor`."""

from harness.executors.clusters import check_address, cluster
from harness.executors.local import Serial, local

__all__ = ["Serial", "check_address", "cluster", "local"]
