"""A browser without a network that opens reports from disk, and fails on whatever it complains of.

It is the Chromium that is installed, driven by Playwright; nothing is downloaded.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from harness.core.case import Case
from harness.core.provenance import Provenance
from harness.evaluation.evaluate import run_cases
from harness.report.write import write_report
from harness.studies.comparison.study import comparison_report
from models.catalogue import load

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DESK, PHONE = 1400, 375

Open = Callable[..., Any]


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Give a browser, or say why these tests are left out."""
    if CHROMIUM is None:
        pytest.skip("chromium is not on the path: the page is not tried in a browser")
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed: no test in a browser"
    )
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def browse(chromium: Any) -> Iterator[Open]:  # noqa: ANN401 - a browser of an optional package
    """Give a function that opens a report; at the end nothing may have been complained of."""
    said: list[str] = []
    fetched: list[str] = []
    with ExitStack() as stack:

        def open_(folder: Path, width: int = DESK, *, whole: bool = True, **options: object) -> Any:  # noqa: ANN401
            context = chromium.new_context(
                viewport={"width": width, "height": 900}, offline=True, **options
            )
            stack.callback(context.close)
            page = context.new_page()
            page.on("console", lambda message: said.append(message.text))
            page.on("pageerror", lambda error: said.append(str(error)))
            page.on("dialog", lambda dialog: said.append(f"dialog {dialog.message}"))
            page.on("request", lambda request: fetched.append(request.url))
            page.goto((folder / "index.html").as_uri())
            if whole:
                see_all(page)
            return page

        yield open_
    assert said == []
    assert all(url.startswith(("file:", "data:", "blob:")) for url in fetched), fetched


def see_all(page: Any) -> None:  # noqa: ANN401
    """Go past every figure, as they are drawn when a reader comes near, and back to the top."""
    for figure in page.locator(".figure").all():
        figure.scroll_into_view_if_needed()
        figure.and_(page.locator(".drawn, .failed")).wait_for()
    page.evaluate("scrollTo(0, 0)")


@pytest.fixture(scope="session")
def real(made: Provenance, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a report of both engines on one scene, as `validate` writes it."""
    scene, out = load("gentle-rock"), tmp_path_factory.mktemp("real") / "report"
    cases = [
        Case(scene=scene, engine=engine, profile=profile, timestep=step)
        for engine in ("mujoco", "pybullet")
        for profile, step in (("default", None), ("adaptive", None), ("matched", 1e-3))
    ]
    evaluations = run_cases(cases)
    told = [
        {
            "digest": e.simulation.case.digest(e.simulation.engine_version),
            "label": e.simulation.case.label(),
            "command": e.simulation.case.command(),
        }
        for e in evaluations
    ]
    write_report(
        comparison_report(evaluations), out, title="Two engines", cases=told, provenance=made
    )
    return out


@pytest.fixture(scope="session")
def axe() -> str:
    """Return the text of axe-core, or say why these tests are left out."""
    root = Path(__file__).parents[5]
    packed = root / ".cache" / "axe" / "node_modules" / "axe-core" / "axe.min.js"
    path = Path(os.environ.get("AXE_CORE") or packed)
    if not path.is_file():
        pytest.skip(
            "axe-core is not there: accessibility is not checked; get it with: "
            "npm install --no-save --prefix .cache/axe axe-core"
        )
    return path.read_text(encoding="utf-8")
