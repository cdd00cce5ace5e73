"""Tests of an engine that is not installed are skipped, all of them in one line of the summary."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from functools import cache
from typing import NoReturn

import pytest

from harness.core.errors import MissingPackageError
from harness.engines.registry import left_out

absent_engines = cache(left_out)
"""The engines that this environment does without, whatever a test registers."""


def engines_of(item: pytest.Item) -> set[str]:
    """Return what may be names of engines: arguments of the mark `engine`, and parameters."""
    parameters = getattr(item, "callspec", None)
    marks = [mark.args for mark in item.iter_markers("engine")]
    return set(_words([marks, parameters.params if parameters else ()]))


def _words(value: object) -> Iterator[str]:
    """Yield the words in parameters, and the engines of cases."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        yield from _words(list(value.values()))
    elif isinstance(value, (list, tuple)):
        for part in value:
            yield from _words(part)
    elif hasattr(value, "engine"):
        yield from _words(value.engine)


@contextmanager
def skipping_absent(named: Collection[str] = ()) -> Iterator[None]:
    """Skip for an absent engine among those named, and for one that is asked for within."""
    for name in absent_engines():
        if name in named:
            _skip(name)
    try:
        yield
    except MissingPackageError as error:
        for name in absent_engines():
            if error.part == f"engine '{name}'":
                _skip(name)
        raise


def _skip(name: str) -> NoReturn:
    pytest.skip(f"{name} is not installed")  # from one place, for the summary
