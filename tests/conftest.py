"""Fixtures of all tests, what is quick, and two ways to draw examples for property tests.

``fixed`` is what `make test-all` takes: the same examples in every run, so that a change that fails
is the change's own fault. It finds what it found yesterday and nothing else. ``quick``, of `make
test`, is a tenth of it.

``explore`` is what `make explore` takes: five times as many examples from fresh seeds, those that
failed kept in `.hypothesis` and tried first the next time. What it finds becomes part of `fixed`:

1. Hypothesis prints the smallest example that fails, and an `@reproduce_failure` line that brings
   it back in any checkout.
2. Find the mechanism, and write a test of it beside the code that is at fault.
3. Give the example to the property test as `@example(...)` above its `@given`, with a comment on
   what went wrong; it then runs in every `make test`.

A test that costs more than others per example takes a share of the profile's number of examples,
`@settings(max_examples=examples(1 / 4))`, and so grows with it.

Fixtures import what they need themselves: most tests need no browser, report or command line, whose
imports take seconds.
"""

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from filelock import FileLock
from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase
from hypothesis.internal.conjecture import providers
from hypothesis.internal.constants_ast import Constants

from models import Horizon, Scene, load
from tests.support.sampling import sampled

if TYPE_CHECKING:
    from harness.core.provenance import Provenance
    from harness.core.report_model import Artefact
    from harness.core.trajectory import Trajectory
    from harness.execution.cache import CacheFolder
    from harness.report.layout import Section
    from harness.sweep.plan import SweepPlan
    from tests.support.browser import Open
    from tests.support.command_line import Command

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
AXE = Path(
    os.environ.get("AXE_CORE")
    or Path(__file__).parents[1] / ".cache/axe/node_modules/axe-core/axe.min.js"
)

MakeOnce = Callable[[str, Callable[[Path], Path]], Path]

# a busy machine fails neither of them
settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=100)
settings.register_profile("quick", derandomize=True, deadline=None, max_examples=10)
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


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of `make test` and `make test-engines`."""
    parser.addoption(
        "--quick",
        action="store_true",
        help="No slow tests, a sample of the parameters of a test, a tenth of the examples.",
    )
    parser.addoption(
        "--optional-engines",
        action="store_true",
        help="Only the tests of an optional engine, of those that are installed.",
    )


@pytest.hookimpl(trylast=True)  # hypothesis has loaded its profile
def pytest_configure(config: pytest.Config) -> None:
    """Draw the same examples whatever else runs in this process, and fewer in a quick run."""
    os.environ["ROCKINGCAN_ENGINES"] = "no-engines"  # also where a module lists the engines
    if config.option.quick:
        settings.load_profile("quick")
    if settings().derandomize:
        # else a number that stands in any module that some test has imported may be an example
        vars(providers)["_get_local_constants"] = Constants


def _left_out() -> dict[str, str]:
    """Return why a fixture is not to be had here, unless a browser is required."""
    if os.environ.get("ROCKINGCAN_BROWSER") == "required":
        return {}
    reasons = {}
    if CHROMIUM is None:
        reasons["chromium"] = "no chromium is on the path: no test in a browser"
    if not AXE.is_file():
        get = "npm install --no-save --prefix .cache/axe axe-core"
        reasons["axe"] = f"no axe-core is there: no test of accessibility; to get it: {get}"
    if not (Path(__file__).parents[1] / "docs/_build/site").is_dir():
        reasons["site"] = "no site is built: no test of its pages; make docs"
    return reasons


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Say what a run leaves out, and how long it takes."""
    said = "all tests, twenty minutes on two cores; `make test` runs the quick ones"
    if config.option.quick:
        said = (
            "quick tests, three minutes on two cores; left out: what is marked `slow` (campaigns, "
            "whole studies), most combinations of parameters, nine tenths of the drawn "
            "examples; `make test-all` runs everything, in twenty minutes"
        )
    return [said, *_left_out().values()]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not quick; put the files with slow tests first, so that none comes last.

    One that says its minutes comes before the others: `pytest.mark.slow(minutes=5)`.
    """
    slow = dict[Path, float]()
    for item in items:
        if mark := item.get_closest_marker("slow"):
            slow[item.path] = max(slow.get(item.path, 0.0), mark.kwargs.get("minutes", 0.0))
    left_out = _left_out()
    chosen = [
        item
        for item in sorted(items, key=lambda item: -slow.get(item.path, -1))
        if left_out.keys().isdisjoint(getattr(item, "fixturenames", ()))
    ]
    if config.option.optional_engines:
        from tests.support.absent_engines import engines_of, optional_engines

        chosen = [item for item in chosen if engines_of(item) & optional_engines()]
    if config.option.quick:
        chosen = sampled([item for item in chosen if not item.get_closest_marker("slow")])
    if others := set(items).difference(chosen):
        config.hook.pytest_deselected(items=list(others))
    items[:] = chosen


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Skip a test that has an engine as a mark or a parameter, or in a fixture, that is absent."""
    from tests.support.absent_engines import engines_of, skipping_absent

    with skipping_absent(engines_of(item)):
        yield


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_call() -> Iterator[None]:
    """Skip a test that asks for an engine that is absent."""
    from tests.support.absent_engines import skipping_absent

    with skipping_absent():
        yield


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder that the processes of this run of the tests share."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session")
def make_once(shared_folder: Path) -> MakeOnce:
    """Return a function that makes what a name says, once for all processes."""

    def make(name: str, write: Callable[[Path], Path]) -> Path:
        with FileLock(shared_folder / f"{name}.lock"):
            done, out = shared_folder / f"{name}.done", shared_folder / name / "report"
            if not done.exists():
                write(out)
                done.touch()
        return out

    return make


@pytest.fixture(scope="session", autouse=True)
def _of_its_own(shared_folder: Path) -> Iterator[None]:
    """Keep what tests run in a store of their own, and wait for no other program that times.

    The lock of timing is in the folder for temporary files; its path is short, as are those of
    sockets.
    """
    with (
        pytest.MonkeyPatch.context() as patch,
        tempfile.TemporaryDirectory(prefix="can-", ignore_cleanup_errors=True) as folder,
    ):
        patch.setenv("ROCKINGCAN_STORE", str(shared_folder / "store"))
        patch.setenv("ROCKINGCAN_ENGINES", str(shared_folder / "engines"))
        patch.setenv("TMPDIR", folder)
        patch.setattr(tempfile, "tempdir", folder)
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


@pytest.fixture(scope="session")
def exact() -> "Trajectory":
    """Return the exact motion of `changed_motions.SCENE`, a bounce and a little more."""
    from tests.support.changed_motions import SCENE, exact_trajectory

    return exact_trajectory(SCENE)


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
    monkeypatch.setattr(plan, "REDUCED_ROWS", 50)


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
def report(make_once: MakeOnce) -> Path:
    """Return the folder of a small report with everything in it."""
    from tests.support.reports import write_small_report

    return make_once("report", write_small_report)


@pytest.fixture(scope="session")
def hostile_report(make_once: MakeOnce) -> Path:
    """Return the folder of a small report whose every text tries to break out."""
    from tests.support.reports import hostile_words, write_small_report

    return make_once("hostile-report", lambda out: write_small_report(out, hostile_words))


@pytest.fixture(scope="session")
def real_report(make_once: MakeOnce) -> Path:
    """Return the folder of a report of both engines on one scene."""
    from tests.support.reports import write_real_report

    return make_once("real-report", write_real_report)


@pytest.fixture(scope="session")
def study_sections(artefacts: "tuple[Artefact, ...]", provenance: "Provenance") -> "list[Section]":
    """Return four studies, the comparison not the first."""
    from tests.support.joined_reports import CASES, chapters

    return chapters(artefacts, provenance, CASES, str)


@pytest.fixture(scope="session")
def joined_report(artefacts: "tuple[Artefact, ...]", make_once: MakeOnce) -> Path:
    """Return the folder of a report of four studies."""
    from tests.support.joined_reports import write_joined_report

    return make_once("joined-report", lambda out: write_joined_report(artefacts, out))


@pytest.fixture(scope="session")
def hostile_joined_report(hostile_artefacts: "tuple[Artefact, ...]", make_once: MakeOnce) -> Path:
    """Return the same, of a scene file whose every text tries to break out."""
    from tests.support.joined_reports import hostile_words, write_joined_report

    return make_once(
        "hostile-joined-report",
        lambda out: write_joined_report(hostile_artefacts, out, hostile_words),
    )


# ---- the page in a browser


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Give a browser."""
    from tests.support.browser import running_chromium

    if CHROMIUM is None:
        pytest.fail("a browser is required, and no chromium is on the path", pytrace=False)
    with running_chromium(CHROMIUM) as browser:
        yield browser


@pytest.fixture
def browse(chromium: Any) -> "Iterator[Open]":
    """Give a function that opens a report; at the end nothing may have been complained of."""
    from tests.support.browser import watched_pages

    with watched_pages(chromium) as open_page:
        yield open_page


@pytest.fixture(scope="session")
def axe() -> str:
    """Return the text of axe-core."""
    return AXE.read_text(encoding="utf-8")
