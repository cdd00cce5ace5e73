"""The page by the rules of axe-core: contrast, landmarks, names, order; light, dark and narrow."""

from pathlib import Path
from typing import Any

import pytest

from tests.support.browser import Open

EVERYTHING = "article { content-visibility: visible !important; }"
"""Lays out what is far from the reader, too, so that it can be looked at."""

RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}


@pytest.mark.slow
@pytest.mark.parametrize(("width", "scheme"), [(1400, "light"), (1400, "dark"), (375, "light")])
def test_axe_finds_nothing(
    width: int, scheme: str, browse: Open, axe: str, joined_report: Path
) -> None:
    page = browse(joined_report, width, color_scheme=scheme)
    assert complaints(page, axe) == []


@pytest.mark.slow
def test_axe_finds_nothing_in_a_real_report(browse: Open, axe: str, real_report: Path) -> None:
    assert complaints(browse(real_report, color_scheme="dark"), axe) == []


def complaints(page: Any, axe: str) -> list[tuple[str, object, str]]:
    """Return what axe-core says of a page with everything unfolded."""
    page.locator("details").evaluate_all("all => all.forEach((one) => { one.open = true; })")
    page.add_style_tag(content=EVERYTHING)
    page.evaluate(axe)
    found = page.evaluate("rules => axe.run(document, rules)", RULES)
    assert {rule["id"] for rule in found["passes"]} >= {"color-contrast", "landmark-one-main"}
    return [
        (rule["id"], node["target"], node["failureSummary"])
        for rule in found["violations"]
        for node in rule["nodes"]
    ]


@pytest.mark.slow
def test_everything_that_answers_can_be_reached_by_keyboard(
    browse: Open, joined_report: Path
) -> None:
    page = browse(joined_report)
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    reached = "button, a[href], input, select, summary, .graph, .scroll"
    unreachable = page.locator(reached).evaluate_all(
        "all => all.filter((one) => one.tabIndex < 0).length"
    )
    assert unreachable == 0
