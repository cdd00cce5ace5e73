"""The page in a browser, from disk and without a network: it draws, answers and fits."""

from pathlib import Path
from typing import Any

import pytest

from tests.support.browser import Open, until

PHONE = 375
MINUS, NOTHING = "\N{MINUS SIGN}", "\N{EN DASH}"

SPAN = "graph => { const [low, high] = graph._fullLayout.xaxis.range; return high - low; }"
SIZE = """text => {
  const { a, b } = text.getScreenCTM();
  return Math.hypot(a, b) * parseFloat(getComputedStyle(text).fontSize);
}"""
IN_SIGHT = "one => { const at = one.getBoundingClientRect(); return 0 <= at.top && at.top < 900; }"
TRACES = "graphs => graphs.map((graph) => graph.querySelectorAll('.trace').length)"


def spans(page: Any) -> list[float]:
    graphs = page.locator(".figure").first.locator(".graph")
    return [graphs.nth(n).evaluate(SPAN) for n in range(graphs.count())]


def column(page: Any, number: int) -> list[str]:
    cells = page.locator(f"#table-scorecard tbody tr > :nth-child({number})")
    return [text.strip() for text in cells.all_text_contents()]


def test_every_figure_draws_without_a_network(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    assert page.locator(".graph").evaluate_all(TRACES) == [3, 3, 3, 1, 1]
    assert page.locator(".figure.drawn").count() == 3
    assert not page.locator(".still").first.is_visible()  # the pictures are for paper
    assert page.locator(".modebar-btn").count() == 0  # none that sends anything away


@pytest.mark.slow
def test_a_link_in_the_contents_leads_there_and_draws(browse: Open, real_report: Path) -> None:
    page = browse(real_report, whole=False)
    assert page.locator(".figure.drawn").count() == 0  # none is near the top of the page
    page.locator("nav a[href^='#figure-']").last.click()
    last = page.locator(".figure").last
    last.and_(page.locator(".drawn")).wait_for()
    assert last.locator("h3").evaluate(IN_SIGHT)
    assert page.locator(".figure.drawn").count() < page.locator(".figure").count()


@pytest.mark.slow
def test_every_figure_of_a_real_report_draws(browse: Open, real_report: Path) -> None:
    page = browse(real_report)
    drawn = page.locator(".graph").evaluate_all(TRACES)
    assert len(drawn) == 3 + 3 + 1 + 2 + 2  # angles in the bounce and all, locus, friction, errors
    assert min(drawn) >= 2
    assert page.locator(".replay canvas").count() == 5
    assert page.locator(".figure.failed").count() == 0


@pytest.mark.slow
def test_the_legend_hides_and_shows(browse: Open, joined_report: Path) -> None:
    figure = browse(joined_report).locator(".figure").first
    entry, graph = figure.locator(".entry").nth(1), figure.locator(".graph").first
    shown = graph.locator(".trace")
    entry.click()
    shown.nth(2).wait_for(state="detached")
    assert entry.get_attribute("aria-pressed") == "false"
    entry.press("Enter")
    shown.nth(2).wait_for(state="attached")
    assert entry.get_attribute("aria-pressed") == "true"


@pytest.mark.slow
def test_an_engine_is_shown_alone_and_again_with_all(browse: Open, joined_report: Path) -> None:
    figure = browse(joined_report).locator(".figure").first
    entry, shown = figure.locator(".entry").nth(1), figure.locator(".graph").first.locator(".trace")
    pressed = figure.locator(".entry[aria-pressed=true]")
    entry.click(modifiers=["Shift"])
    shown.nth(1).wait_for(state="detached")
    assert pressed.evaluate_all("all => all.map((one) => one.dataset.kind)") == ["mujoco"]
    entry.click(modifiers=["Shift"])
    shown.nth(2).wait_for(state="attached")
    assert pressed.count() == 3


@pytest.mark.slow
def test_a_drag_zooms_panels_over_the_same_times_together(
    browse: Open, joined_report: Path
) -> None:
    page = browse(joined_report)
    graph = page.locator(".figure").first.locator(".graph").first
    graph.scroll_into_view_if_needed()
    box = graph.locator(".nsewdrag").bounding_box()
    before = spans(page)
    left, middle = box["x"] + 0.25 * box["width"], box["y"] + box["height"] / 2
    page.mouse.move(left, middle)
    page.mouse.down()
    page.mouse.move(left + 0.25 * box["width"], middle, steps=5)
    page.mouse.up()
    until(page, lambda: spans(page)[0] != before[0] and spans(page)[1] == spans(page)[0])
    zoomed = [now / old for now, old in zip(spans(page), before, strict=True)]
    # a quarter of the width, by whole pixels of a panel of some 500
    assert zoomed[0] == pytest.approx(0.25, abs=0.01)
    assert zoomed[1] == zoomed[0]
    assert zoomed[2] == 1.0
    page.locator(".figure").first.locator(".reset").click()
    until(page, lambda: spans(page) == before)


@pytest.mark.slow
def test_the_keyboard_zooms_moves_and_goes_back(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    graph = page.locator(".figure").first.locator(".graph").first
    before = spans(page)[0]
    graph.press("+")
    until(page, lambda: spans(page)[0] != before)
    # a press of plus shows 70 % of what was seen; the rest is rounding in the browser
    assert spans(page)[0] == pytest.approx(0.7 * before, rel=1e-9)
    low = graph.evaluate("graph => graph._fullLayout.xaxis.range[0]")
    graph.press("ArrowRight")
    until(page, lambda: graph.evaluate("graph => graph._fullLayout.xaxis.range[0]") > low)
    graph.press("0")
    until(page, lambda: spans(page)[0] == before)


@pytest.mark.slow
def test_tables_sort_numbers_by_value_and_put_nothing_last(
    browse: Open, joined_report: Path
) -> None:
    page = browse(joined_report)
    head = page.locator("#table-scorecard thead th").nth(1)
    head.locator("button").click()
    assert head.get_attribute("aria-sort") == "ascending"
    assert column(page, 2) == [f"{MINUS}0.1304", "0.0019", NOTHING]
    head.locator("button").press("Enter")
    assert head.get_attribute("aria-sort") == "descending"
    assert column(page, 2) == ["0.0019", f"{MINUS}0.1304", NOTHING]
    page.locator("#table-scorecard thead button").first.press(" ")
    assert head.get_attribute("aria-sort") is None
    assert column(page, 1) == ["late", "mujoco", "pybullet"]


@pytest.mark.slow
def test_a_number_leads_to_its_case(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    place = page.locator("#case-0123456789abcdef")
    assert not place.is_visible()
    page.locator("#table-engines a.case").first.click()
    place.wait_for(state="visible")
    assert "rockingcan run gentle-rock" in place.inner_text()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["joined_report", "hostile_joined_report", "real_report"])
def test_no_sideways_scroll_on_a_phone(
    name: str, browse: Open, request: pytest.FixtureRequest
) -> None:
    page = browse(request.getfixturevalue(name), PHONE)
    page.add_style_tag(content="article { content-visibility: visible !important; }")
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE


@pytest.mark.slow
def test_hostile_texts_do_not_run(
    browse: Open, joined_report: Path, hostile_joined_report: Path
) -> None:
    page, plain = browse(hostile_joined_report), browse(joined_report)
    assert page.title().startswith("=1+1</script><script>")
    assert page.locator(".graph").evaluate_all(TRACES) == [3, 3, 3, 1, 1]
    assert page.locator("script").count() == plain.locator("script").count()
    assert page.locator("img[onerror]").count() == 0


@pytest.mark.slow
def test_on_paper_pictures_take_the_place_of_graphs(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    page.emulate_media(media="print")
    for still in page.locator(".still").all():
        still.wait_for(state="visible")  # with the next frame
    for hidden in (".graph", ".hint", ".replay", "nav"):
        assert not page.locator(hidden).first.is_visible(), hidden


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_without_scripts_pictures_and_tables_are_there(
    scheme: str, browse: Open, joined_report: Path
) -> None:
    page = browse(joined_report, whole=False, java_script_enabled=False, color_scheme=scheme)
    for figure in page.locator(".figure").all():
        stills = figure.locator(".still")
        assert stills.count() == figure.locator(".panel").count() > 0
        assert all(one.is_visible() for one in stills.all())
        assert all(one.locator("svg path[style]").count() for one in stills.all())
        legend = figure.locator(".entry")
        assert legend.first.is_visible()
        assert all(one.is_disabled() for one in legend.all())  # nothing would answer
    assert not page.locator(".graph").first.is_visible()
    assert not page.locator(".hint").first.is_visible()
    assert not page.locator(".replay").first.is_visible()
    assert page.locator("#table-engines tbody tr").count() == 2


@pytest.mark.slow
@pytest.mark.parametrize("width", [PHONE, 1400])
def test_no_text_of_a_picture_leaves_it_or_is_too_small(
    width: int, browse: Open, real_report: Path
) -> None:
    page = browse(real_report, width, whole=False, java_script_enabled=False)
    for still in page.locator(".still").all():
        outer = still.bounding_box()
        assert outer["width"] <= width
        for text in still.locator("text").all():
            box = text.bounding_box()
            assert text.evaluate(SIZE) > 9.0
            assert box["x"] > outer["x"] - 1.0
            assert box["x"] + box["width"] < outer["x"] + outer["width"] + 1.0
            assert box["y"] > outer["y"] - 1.0
            assert box["y"] + box["height"] < outer["y"] + outer["height"] + 1.0
