"""The command line: the one place that prints."""

from harness.cli.main import main

__all__ = ["main"]
