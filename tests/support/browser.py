"""A browser without a network that opens reports from disk, and fails on whatever it complains of.

It is the Chromium that is installed, driven by Playwright; nothing is downloaded.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
_ROOT = Path(__file__).parents[2]

DESK, PHONE = 1400, 375

Open = Callable[..., Any]
"""Opens the page of a report's folder."""


@contextmanager
def running_chromium() -> Iterator[Any]:
    """Give a browser, or skip the test that asks for it."""
    if CHROMIUM is None:
        pytest.skip("chromium is not on the path: the page is not tried in a browser")
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed: no test in a browser"
    )
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def watched_pages(chromium: Any) -> Iterator[Open]:  # noqa: ANN401 - of an optional package
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


def axe_core() -> str:
    """Return the text of axe-core, or skip the test that asks for it."""
    packed = _ROOT / ".cache" / "axe" / "node_modules" / "axe-core" / "axe.min.js"
    path = Path(os.environ.get("AXE_CORE") or packed)
    if not path.is_file():
        pytest.skip(
            "axe-core is not there: accessibility is not checked; get it with: "
            "npm install --no-save --prefix .cache/axe axe-core"
        )
    return path.read_text(encoding="utf-8")
