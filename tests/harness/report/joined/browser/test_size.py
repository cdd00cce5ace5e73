"""A page as large as that of the full suite may be answers within three seconds."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from harness.artefact import Figure, Panel, Series
from harness.provenance import Provenance
from harness.report import write_report

Open = Callable[..., Any]

LARGEST = 12e6  # bytes
PATIENCE = 3.0  # s


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


def test_a_large_page_answers_soon(browse: Open, made: Provenance, tmp_path: Path) -> None:
    one = write_report((noisy(0),), tmp_path / "one", title="t", cases=(), provenance=made)
    two = write_report((noisy(0), noisy(1)), tmp_path / "two", title="t", cases=(), provenance=made)
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
    entry = page.locator(".entry").first
    entry.click()
    assert entry.get_attribute("aria-pressed") == "false"
    assert busy(session) - before < PATIENCE


def busy(session: Any) -> float:  # noqa: ANN401
    """Return how long the page's thread has worked, s, whatever else this machine does."""
    told = session.send("Performance.getMetrics")["metrics"]
    return next(float(metric["value"]) for metric in told if metric["name"] == "TaskDuration")
