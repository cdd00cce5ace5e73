"""A browser without a network that opens reports from disk, and fails on whatever it complains of.

It is the Chromium that is installed, driven by Playwright; nothing is downloaded.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

DESK, PHONE = 1400, 375

Open = Callable[..., Any]
"""Opens the page of a report's folder."""


@contextmanager
def running_chromium(program: str) -> Iterator[Any]:
    """Give a browser."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


_PATIENCE_MS = 120_000.0
"""For what a machine that is busy does in a second."""


@contextmanager
def watched_pages(chromium: Any) -> Iterator[Open]:
    """Give a function that opens a report; at the end nothing may have been complained of."""
    said: list[str] = []
    fetched: list[str] = []
    with ExitStack() as stack:

        def open_(folder: Path, width: int = DESK, *, whole: bool = True, **options: object) -> Any:
            context = chromium.new_context(
                viewport={"width": width, "height": 900}, offline=True, **options
            )
            stack.callback(context.close)
            page = context.new_page()
            page.set_default_timeout(_PATIENCE_MS)
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


def see_all(page: Any) -> None:
    """Go past every figure, as they are drawn when a reader comes near, and back to the top."""
    for figure in page.locator(".figure").all():
        figure.scroll_into_view_if_needed()
        figure.and_(page.locator(".drawn, .failed")).wait_for()
    page.evaluate("scrollTo(0, 0)")


def pass_frames(page: Any, count: int) -> None:
    """Let a page draw so many frames: whatever moves in it moves in one of them."""
    page.evaluate(
        "async (count) => { while (count--) await new Promise(requestAnimationFrame); }", count
    )


def until(page: Any, done: Callable[[], bool]) -> None:
    """Let a page go on until it shows what it should, a minute at the most."""
    end = time.monotonic() + 60.0
    while not done():
        assert time.monotonic() < end
        pass_frames(page, 1)
