"""A page as large as that of the full suite may be answers within three seconds."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from harness.core.provenance import Provenance
from harness.core.report_model import Figure, Panel, Series, Table
from harness.report.write import write_report
from tests.support.browser import Open

LARGEST = 12e6  # bytes
PATIENCE = 12.0
"""Most time to read and sort a page, in that which the same browser takes for 3e8 steps of a loop.
Found are 5 to 7; seconds would depend on the machine."""


def noisy(number: int) -> Figure:
    """Return a figure that thinning can do little about."""
    rng = np.random.default_rng(number)
    x = np.linspace(0.0, 1.0, 2_000)
    series = tuple(
        Series(label=kind, kind=kind, x=x, y=rng.normal(size=x.size).cumsum())
        for kind in ("reference", "mujoco", "pybullet")
    )
    panel = Panel(title="p", x_label="x [s]", y_label="y [m]", series=series)
    return Figure(name=f"f-{number}", title=f"Figure {number}", seen="", panels=(panel, panel))


def table(number: int, rows: int) -> Table:
    values = np.random.default_rng(number).normal(size=(rows, 10))
    frame = pd.DataFrame(values, columns=[f"value_{n}_m" for n in range(10)])
    told = dict.fromkeys(map(str, frame.columns), "A number.")
    return Table(name=f"t-{number}", title=f"Table {number}", frame=frame, columns=told)


def tables() -> list[Table]:
    """Return as many cells as all tables of the full suite have together, a short table first."""
    return [table(0, 10), *(table(number, 400) for number in range(1, 9))]


@pytest.mark.slow
def test_a_large_page_answers_soon(browse: Open, provenance: Provenance, tmp_path: Path) -> None:
    def write(name: str, *figures: Figure) -> Path:
        artefacts: list[Figure | Table] = [*figures, *tables()]
        return write_report(artefacts, tmp_path / name, title="t", cases=(), provenance=provenance)

    one, two = write("one", noisy(0)), write("two", noisy(0), noisy(1))
    each = two.stat().st_size - one.stat().st_size
    # the same few drawings many times over: what a browser has to read, not what is drawn, counts
    text = two.read_text(encoding="utf-8")
    begin = text.index('<article class="figure"')
    end = text.index("</article>", begin) + len("</article>")
    article = text[begin:end]
    copies = int((0.95 * LARGEST - one.stat().st_size) / each)
    more = "".join(article.replace("figure-f-0", f"figure-g-{n}") for n in range(copies))
    two.write_text(text[:end] + more + text[end:], encoding="utf-8")
    assert 0.9 * LARGEST < two.stat().st_size < LARGEST

    page = browse(one.parent, whole=False)
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    before = busy(session)
    page.goto(two.as_uri(), wait_until="domcontentloaded")
    head = page.locator("thead button").first
    head.click()
    assert head.locator("..").get_attribute("aria-sort") == "ascending"
    spent, before = busy(session) - before, busy(session)
    page.evaluate("() => { let s = 0; for (let i = 0; i < 3e8; i++) s += i % 7; return s; }")
    counting = busy(session) - before
    assert spent < PATIENCE * counting
    page.locator(".figure").last.scroll_into_view_if_needed()
    page.locator(".figure.drawn").last.wait_for()
    assert page.locator(".figure.drawn").count() < copies  # none that no one has come near


def busy(session: Any) -> float:
    """Return how long the page's thread has worked, s, whatever else this machine does."""
    told = session.send("Performance.getMetrics")["metrics"]
    return next(float(metric["value"]) for metric in told if metric["name"] == "TaskDuration")
