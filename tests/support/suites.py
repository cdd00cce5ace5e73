"""Short suites in the place of the real ones, for commands that run a whole suite."""

from importlib import import_module

import pytest

from harness.gate import spread

LADDERS = {"quick": {"gentle-rock": (1e-3,)}, "full": {"gentle-rock": (1e-3, 3e-4)}}


def shorten_suites(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the quick suite three runs, with few members each."""
    # by their full names: the package has a function of the same name as one
    names = ("studies.comparison.study", "studies.comparison.suite", "results.plausibility")
    # all are imported before one changes, for each takes the suites of another
    for module in [import_module(f"harness.{name}") for name in names]:
        monkeypatch.setattr(module, "SUITES", LADDERS)
    monkeypatch.setattr(spread, "MOST", 4)
