"""Tests of an engine that is not installed are skipped, all of them in one line of the summary."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import entry_points
from typing import NoReturn

import pytest

from harness.core.engine_packages import ENGINE_ENTRY_POINTS, packages_of
from harness.core.errors import MissingLibraryError, MissingPackageError
from harness.engines.registry import engine, not_installed


@cache
def absent_engines() -> tuple[str, ...]:
    """Return the engines that this environment does without, whatever a test registers.

    They are not installed, or need a library of the operating system that is not there.
    """
    return (*not_installed(), *filter(_without_library, optional_engines() - {*not_installed()}))


def _without_library(name: str) -> bool:
    try:
        engine(name)
    except MissingLibraryError:
        return True
    except MissingPackageError:  # which is no reason to skip its tests
        return False
    return False


@cache
def optional_engines() -> frozenset[str]:
    """Return the engines whose packages an installation has only if they were asked for."""
    entries = entry_points(group=ENGINE_ENTRY_POINTS)
    return frozenset(entry.name for entry in entries if packages_of(entry).optional)


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
