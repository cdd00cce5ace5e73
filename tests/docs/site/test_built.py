"""The site as it was built: it opens from disk, links lead somewhere, pages fit and can be read."""

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

from docs.site.engine_pages import engine_names
from docs.site.sources import SITE

MOST = 3_000_000
"""Bytes of a page with its own text; pictures come beside it."""

WIDTHS = (390, 1400)

SHOWN = (
    *("index", "start", "leaderboard", "engines/index", "engines/mujoco", "engines/reference"),
    *("gallery/index", "gallery/plot_1_exact_motion", "theory/models", "theory/exact-bounce"),
    *("theory/integrators", "results/accuracy", "results/cost", "field-guide/index"),
    *("how-to/gate", "score-a-trajectory", "settings", "api", "audit", "search"),
)
"""Pages that are looked at in a browser: of each kind at least one."""

RULES = {
    "runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
    "preload": False,  # a page from disk may not fetch its own style sheets
}


class Links(HTMLParser):
    """What a page refers to, and the anchors that it has.

    Parameters
    ----------
    text : str
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep addresses and anchors."""
        own = {name: value or "" for name, value in attrs}
        self.anchors |= {own[name] for name in ("id", "name") if name in own}
        if tag == "a" and "href" in own:
            self.links.append(own["href"])
        elif tag == "link" and own.get("rel") not in {"index", "search", "next", "prev", "author"}:
            self.loaded.append(own.get("href", ""))
        elif "src" in own:
            self.loaded.append(own["src"])


@pytest.fixture(scope="module")
def site() -> Path:
    """Return the site that `make docs` built."""
    assert SITE.is_dir(), "run `make docs`: the site is required"
    return SITE


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Links]:
    return {path: Links(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}


def test_every_link_leads_somewhere(site: Path, pages: dict[Path, Links]) -> None:
    lost = []
    for page, own in pages.items():
        for link in own.links:
            parts = urlsplit(link)
            if parts.scheme:
                assert parts.scheme in {"https", "http", "mailto"}, link
                assert parts.netloc or parts.scheme == "mailto", link
                continue
            target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            known = target.is_file() and (
                target.suffix != ".html" or unquote(parts.fragment) in pages[target].anchors
            )
            if not known:
                lost.append((page.relative_to(site).as_posix(), link))
    assert len(pages) > 100
    assert lost == []


def test_nothing_is_fetched_from_elsewhere(site: Path, pages: dict[Path, Links]) -> None:
    for page, own in pages.items():
        for address in own.loaded:
            parts = urlsplit(address)
            assert parts.scheme in {"", "data"}, (page, address)
            assert parts.scheme or (page.parent / unquote(parts.path)).is_file(), (page, address)
    for style in site.rglob("*.css"):
        text = style.read_text(encoding="utf-8")
        assert re.findall(r"(?:url\(|@import )[\"']?(?:https?:)?//", text) == []


def test_no_page_is_large(pages: dict[Path, Links]) -> None:
    assert [page for page in pages if page.stat().st_size > MOST] == []


def test_no_mark_of_a_number_is_left(pages: dict[Path, Links]) -> None:
    assert [page for page in pages if "<!-- = " in page.read_text(encoding="utf-8")] == []


def test_each_engine_has_a_page(site: Path) -> None:
    for name in engine_names():
        assert (site / "engines" / f"{name}.html").is_file()


def opened(browse: Any, site: Path, name: str, width: int, scheme: str = "light") -> Any:
    page = browse(site, width, whole=False, color_scheme=scheme)
    page.goto((site / f"{name}.html").as_uri())
    return page


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_a_page_fits_its_width_and_says_nothing(browse: Any, site: Path, name: str) -> None:
    for width in WIDTHS:
        page = opened(browse, site, name, width)
        assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_axe_finds_nothing(browse: Any, axe: str, site: Path, name: str) -> None:
    for width, scheme in ((1400, "light"), (390, "dark")):
        page = opened(browse, site, name, width, scheme)
        page.evaluate(axe)
        found = page.evaluate("rules => axe.run(document, rules)", RULES)
        assert [
            (rule["id"], node["target"], node["failureSummary"])
            for rule in found["violations"]
            for node in rule["nodes"][:3]
        ] == []


@pytest.mark.slow
def test_a_column_sorts_and_a_cell_opens_its_case(browse: Any, site: Path) -> None:
    page = opened(browse, site, "leaderboard", 1400)
    table = page.locator("table.sortable").first
    head = table.locator("thead th").nth(2)
    order = """table => [...table.tBodies[0].rows].map((row) => row.cells[2].dataset.order)"""
    for direction in ("ascending", "descending"):
        head.locator("button").click()
        assert head.get_attribute("aria-sort") == direction
        shown = [float(text) for text in table.evaluate(order)]
        assert shown == sorted(shown, reverse=direction == "descending")
    table.locator("td a").first.click()
    page.wait_for_function("location.hash.startsWith('#case-')")
    case = page.locator("details.case[open]")
    case.wait_for()
    assert "rockingcan run" in case.inner_text()
