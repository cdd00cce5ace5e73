"""Fixtures of all tests, and two ways to draw examples for property tests.

``fixed`` is what `make test` takes: the same examples in every run, so that a change that fails is
the change's own fault. It finds what it found yesterday and nothing else.

``explore`` is what `make explore` takes: five times as many examples from fresh seeds, those that
failed kept in `.hypothesis` and tried first the next time. What it finds becomes part of `fixed`:

1. Hypothesis prints the smallest example that fails, and an `@reproduce_failure` line that brings
   it back in any checkout.
2. Find the mechanism, and write a test of it beside the code that is at fault.
3. Give the example to the property test as `@example(...)` above its `@given`, with a comment on
   what went wrong; it then runs in every `make test`.

A test that costs more than others per example takes a share of the profile's number of examples,
`@settings(max_examples=settings.default.max_examples // 4)`, and so grows with it.

Fixtures import what they need themselves: most tests need no browser, report or command line, whose
imports take seconds.
"""

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase

from models import Horizon, Scene, load

if TYPE_CHECKING:
    from harness.core.provenance import Provenance
    from harness.core.report_model import Artefact
    from harness.execution.cache import CacheFolder
    from harness.report.layout import Section
    from harness.sweep.plan import SweepPlan
    from tests.support.browser import Open
    from tests.support.command_line import Command

# a busy machine fails neither of them
settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=100)
settings.register_profile(
    "explore",
    derandomize=False,
    deadline=None,
    max_examples=500,
    database=DirectoryBasedExampleDatabase(".hypothesis/examples"),
    print_blob=True,
)
# `pytest --hypothesis-profile=explore` takes the other
settings.load_profile("fixed")


@pytest.fixture(scope="session", autouse=True)
def _own_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep what tests run in a store of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROCKINGCAN_STORE", str(tmp_path_factory.mktemp("store")))
        yield


@pytest.fixture(scope="session", autouse=True)
def _two_sentences() -> Iterator[None]:
    """Hold every figure that the harness makes in a test to two sentences on what is seen."""
    from harness.core.report_model import Figure

    made = Figure.__init__

    def held(self: Figure, *args: object, **fields: object) -> None:
        made(self, *args, **fields)
        if sys._getframe(1).f_globals["__name__"].startswith("harness.studies"):  # noqa: SLF001
            count = len(re.findall(r"[.!?](?=\s|$)", self.seen))
            assert count == 2, f"{self.name}: {count} sentences: {self.seen}"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "__init__", held)
        yield


# ---- scenes


@pytest.fixture(scope="session")
def gentle() -> Scene:
    """Return the gentle release, one bounce."""
    return load("gentle-rock")


@pytest.fixture(scope="session")
def brief(gentle: Scene) -> Scene:
    """Return the gentle release for 20 ms: long enough for contact, too short for a bounce."""
    return replace(gentle, horizon=Horizon(seconds=0.02))


# ---- the command line


@pytest.fixture
def rockingcan(capsys: pytest.CaptureFixture[str]) -> "Command":
    """Return a function that runs a command in this process."""
    from tests.support.command_line import run_here

    return lambda *words: run_here(capsys, *words)


@pytest.fixture
def rockingcan_process(tmp_path: Path) -> "Command":
    """Return a function that runs a command as a process of its own, in an empty folder."""
    from tests.support.command_line import run_as_process

    folder = tmp_path / "empty"
    folder.mkdir()
    return lambda *words: run_as_process(folder, *words)


@pytest.fixture
def scene_file(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the paper's release with some lines changed."""
    from tests.support.command_line import write_scene_file

    return lambda *changes: write_scene_file(tmp_path / "scene.toml", *changes)


# ---- results that are kept


@pytest.fixture
def store(tmp_path: Path) -> "CacheFolder":
    """Return an empty store."""
    from harness.execution.cache import CacheFolder

    return CacheFolder(folder=tmp_path / "store")


# ---- sweeps


@pytest.fixture
def small_partitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut sweeps small, so that a few rows are many partitions."""
    from harness.sweep import plan

    monkeypatch.setattr(plan, "EXACT_ROWS", 50)
    monkeypatch.setattr(plan, "ENGINE_ROWS", 3)


@pytest.fixture
def sweep_of_225() -> "SweepPlan":
    """Return a sweep of 225 releases."""
    from tests.support.sweeps import make_plan

    return make_plan("gentle-rock", "release.psi_dot=1:3:15", "release.theta_dot=-2:0:15")


# ---- reports


@pytest.fixture(scope="session")
def provenance() -> "Provenance":
    """Return where a report was made, as another machine would tell it."""
    from tests.support import reports

    return reports.provenance()


@pytest.fixture(scope="session")
def artefacts() -> "tuple[Artefact, ...]":
    """Return artefacts of all kinds."""
    from tests.support.reports import everything

    return everything(str)


@pytest.fixture(scope="session")
def hostile_artefacts() -> "tuple[Artefact, ...]":
    """Return artefacts of all kinds whose every text tries to break out."""
    from tests.support.reports import everything, hostile_words

    return everything(hostile_words)


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a small report with everything in it."""
    from tests.support.reports import write_small_report

    return write_small_report(tmp_path_factory.mktemp("written") / "report")


@pytest.fixture(scope="session")
def hostile_report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a small report whose every text tries to break out."""
    from tests.support.reports import hostile_words, write_small_report

    return write_small_report(tmp_path_factory.mktemp("hostile") / "report", hostile_words)


@pytest.fixture(scope="session")
def real_report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a report of both engines on one scene."""
    from tests.support.reports import write_real_report

    return write_real_report(tmp_path_factory.mktemp("real") / "report")


@pytest.fixture(scope="session")
def study_sections(artefacts: "tuple[Artefact, ...]", provenance: "Provenance") -> "list[Section]":
    """Return four studies, the comparison not the first."""
    from tests.support.joined_reports import CASES, chapters

    return chapters(artefacts, provenance, CASES, str)


@pytest.fixture(scope="session")
def joined_report(
    artefacts: "tuple[Artefact, ...]", tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """Return the folder of a report of four studies."""
    from tests.support.joined_reports import write_joined_report

    return write_joined_report(artefacts, tmp_path_factory.mktemp("joined") / "report")


@pytest.fixture(scope="session")
def hostile_joined_report(
    hostile_artefacts: "tuple[Artefact, ...]", tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """Return the same, of a scene file whose every text tries to break out."""
    from tests.support.joined_reports import hostile_words, write_joined_report

    out = tmp_path_factory.mktemp("hostile-joined") / "report"
    return write_joined_report(hostile_artefacts, out, hostile_words)


# ---- the page in a browser


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Give a browser, or say why the test is left out."""
    from tests.support.browser import running_chromium

    with running_chromium() as browser:
        yield browser


@pytest.fixture
def browse(chromium: Any) -> "Iterator[Open]":  # noqa: ANN401 - a browser of an optional package
    """Give a function that opens a report; at the end nothing may have been complained of."""
    from tests.support.browser import watched_pages

    with watched_pages(chromium) as open_page:
        yield open_page


@pytest.fixture(scope="session")
def axe() -> str:
    """Return the text of axe-core, or say why the test is left out."""
    from tests.support.browser import axe_core

    return axe_core()
