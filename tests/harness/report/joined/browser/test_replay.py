"""The replay in a browser: it plays, stops, goes where it is told, and stands still if asked to."""

from pathlib import Path
from typing import Any

import pytest

from tests.support.browser import Open, pass_frames, until

PAINTED = "canvases => canvases.map((canvas) => canvas.toDataURL())"

LAST, BOUNCE = 99, 50


def replay(page: Any) -> Any:
    element = page.locator(".replay").first
    element.scroll_into_view_if_needed()
    element.locator(".clock", has_text="ms").wait_for()  # it is opened as it comes near
    return element


def frame(element: Any) -> int:
    return int(element.locator("input").input_value())


def pictures(element: Any) -> list[str]:
    return [str(one) for one in element.locator("canvas").evaluate_all(PAINTED)]


@pytest.mark.slow
def test_reference_and_engine_are_drawn_side_by_side(browse: Open, joined_report: Path) -> None:
    element = replay(browse(joined_report))
    exact, engine = pictures(element)
    assert exact != engine  # which is late, and has its own colour
    names = [name.strip() for name in element.locator("figcaption").all_text_contents()]
    assert names == ["exact", "MuJoCo"]


@pytest.mark.slow
def test_it_plays_to_its_end_and_again(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    element = replay(page)
    play = element.locator(".play")
    assert play.inner_text() == "Play"
    before = pictures(element)
    play.click()
    assert play.inner_text() == "Pause"
    until(page, lambda: frame(element) == LAST)
    until(page, lambda: play.inner_text() == "Play")  # a frame later at most
    assert pictures(element) != before
    play.click()
    until(page, lambda: 0 < frame(element) < LAST)


@pytest.mark.slow
def test_a_pause_holds_it(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    element = replay(page)
    element.locator("select").select_option("0.0625")
    element.locator(".play").press("Enter")
    until(page, lambda: frame(element) > 1)
    element.locator(".play").press("Enter")
    held = frame(element)
    pass_frames(page, 30)  # at this pace two of the replay
    assert frame(element) == held < LAST


@pytest.mark.slow
def test_the_slider_answers_to_the_keyboard(browse: Open, joined_report: Path) -> None:
    element = replay(browse(joined_report))
    slider = element.locator("input")
    before = pictures(element)
    slider.press("ArrowRight")
    assert frame(element) == 1
    slider.press("End")
    assert frame(element) == LAST
    assert pictures(element) != before
    assert slider.get_attribute("aria-valuetext") == "990.000 milliseconds"


@pytest.mark.slow
def test_it_goes_to_the_bounce(browse: Open, joined_report: Path) -> None:
    element = replay(browse(joined_report))
    element.locator(".to-bounce").press("Enter")
    assert frame(element) == BOUNCE
    assert element.locator(".clock").inner_text().startswith("500.0000 ms; a second of watching")


@pytest.mark.slow
def test_who_wants_no_motion_gets_steps(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report, reduced_motion="reduce")
    element = replay(page)
    button = element.locator(".play")
    assert button.inner_text() == "Step"
    button.click()
    stepped = frame(element)
    pass_frames(page, 20)
    assert frame(element) == stepped > 0


@pytest.mark.slow
def test_nothing_moves_by_itself(browse: Open, joined_report: Path) -> None:
    page = browse(joined_report)
    element = replay(page)
    pass_frames(page, 20)
    assert frame(element) == 0


@pytest.mark.slow
def test_a_real_can_rolls(browse: Open, real_report: Path) -> None:
    element = replay(browse(real_report, whole=False))
    before = pictures(element)
    element.locator(".to-bounce").click()
    for early, now in zip(before, pictures(element), strict=True):
        assert now != early
