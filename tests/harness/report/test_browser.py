"""The page in headless Chromium, from disk and without a network: it draws, answers and fits.

A copy of the page gets a script that acts as a reader would and writes what it saw to the console.
"""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")

pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason="chromium is not on the path: the page is not tried in a browser"
)

WATCH = """<script>
addEventListener("error", (event) => console.error("BROKEN " + event.message));
addEventListener("unhandledrejection", (event) => console.error("BROKEN " + event.reason));
addEventListener("securitypolicyviolation", (event) => console.error("BROKEN " + event.blockedURI));
</script>"""

ACT = """<script>
async function act() {
  const wait = (ms) => new Promise((go) => setTimeout(go, ms));
  const graphs = [...document.querySelectorAll(".graph")];
  const seen = { title: document.title, inner: innerWidth };
  seen.width = document.documentElement.scrollWidth;
  seen.drawn = graphs.map((graph) => graph.querySelectorAll(".trace").length);
  seen.buttons = document.querySelectorAll(".modebar-btn").length;
  seen.stills = [...document.querySelectorAll(".still")].map((one) => one.offsetHeight);
  seen.fetched = performance.getEntriesByType("resource").map((one) => one.name)
    .filter((name) => !name.startsWith("data:"));

  const figure = document.querySelector(".figure");
  const [first, second, third] = figure.querySelectorAll(".graph");
  const entry = figure.querySelectorAll(".entry")[1];
  entry.click(); await wait(300);
  seen.hidden = [entry.getAttribute("aria-pressed"), first.querySelectorAll(".trace").length];
  entry.click(); await wait(300);
  seen.shown = [entry.getAttribute("aria-pressed"), first.querySelectorAll(".trace").length];

  const isolate = () => entry.dispatchEvent(new MouseEvent("click", { shiftKey: true }));
  const pressed = () => [...figure.querySelectorAll(".entry")]
    .filter((one) => one.getAttribute("aria-pressed") === "true").map((one) => one.dataset.kind);
  isolate(); await wait(300);
  seen.alone = [entry.dataset.kind, pressed(), first.querySelectorAll(".trace").length];
  isolate(); await wait(300);
  seen.together = [pressed().length, first.querySelectorAll(".trace").length];

  const span = (graph) => { const [low, high] = graph._fullLayout.xaxis.range; return high - low; };
  const before = [first, second, third].map(span);
  await Plotly.relayout(first, { "xaxis.range[0]": 0.05, "xaxis.range[1]": 0.1 }); await wait(300);
  seen.zoomed = [first, second, third].map((graph, n) => span(graph) / before[n]);
  first.dispatchEvent(new KeyboardEvent("keydown", { key: "+" })); await wait(300);
  seen.closer = span(first) / before[0];
  figure.querySelector(".reset").click(); await wait(300);
  seen.back = [first, second, third].map((graph, n) => span(graph) / before[n]);

  const table = document.querySelector("table"), heads = table.tHead.rows[0].cells;
  const column = (n) => [...table.tBodies[0].rows].map((row) => row.cells[n].textContent);
  heads[1].querySelector("button").click();
  seen.up = [heads[1].getAttribute("aria-sort"), column(1)];
  heads[1].querySelector("button").click();
  seen.down = [heads[1].getAttribute("aria-sort"), column(1)];
  heads[0].querySelector("button").click();
  seen.words = [heads[1].getAttribute("aria-sort"), column(0).map((text) => text.slice(0, 6))];
  console.log("SEEN " + JSON.stringify(seen));
}
const waiting = setInterval(() => {
  if (document.documentElement.dataset.drawn !== "all") return;
  clearInterval(waiting);
  act();
}, 50);
</script>"""


def browse(page: Path, profile: Path, *options: str) -> list[str]:
    """Return what the console of a browser said about a page."""
    done = subprocess.run(  # noqa: S603 # words of this test
        [
            str(CHROMIUM),
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-background-networking",
            "--disable-dev-shm-usage",
            "--host-resolver-rules=MAP * ~NOTFOUND",  # no network
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            "--allow-file-access-from-files",
            f"--user-data-dir={profile}",
            *options,
            "--dump-dom",
            page.as_uri(),
        ],
        capture_output=True,
        check=True,
        text=True,
        timeout=120,
    )
    return [line.split("CONSOLE", 1)[1] for line in done.stderr.splitlines() if "CONSOLE" in line]


def try_out(report: Path, tmp_path: Path, *, width: int) -> dict[str, object]:
    """Return what a reader sees on a screen of some width, and fail on anything the console says.

    A window cannot be narrower than 500 pixels, a frame in it can.
    """
    text = (report / "index.html").read_text(encoding="utf-8")
    text = text.replace("<head>", f"<head>{WATCH}", 1).replace("</body>", f"{ACT}</body>")
    (tmp_path / "tried.html").write_text(text, encoding="utf-8")
    frame = tmp_path / "frame.html"
    frame.write_text(
        f'<!doctype html><body style="margin:0"><iframe src="tried.html" width="{width}" '
        'height="900" style="border:0"></iframe>',
        encoding="utf-8",
    )
    said = browse(frame, tmp_path / "profile", "--window-size=1500,1000")
    assert len(said) == 1, said
    found = re.search(r'"SEEN (\{.*\})", source', said[0])
    assert found, said
    seen = json.loads(found[1])
    assert isinstance(seen, dict)
    return seen


@pytest.fixture(scope="module")
def wide(report: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    return try_out(report, tmp_path_factory.mktemp("wide"), width=1400)


@pytest.fixture(scope="module")
def narrow(hostile_report: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    return try_out(hostile_report, tmp_path_factory.mktemp("narrow"), width=375)


def test_every_figure_draws_without_a_network(wide: dict[str, object]) -> None:
    assert wide["drawn"] == [3, 3, 3, 1, 1]
    assert wide["stills"] == [0, 0, 0]  # the pictures are for paper
    assert wide["fetched"] == []


def test_no_button_sends_anything_away(wide: dict[str, object]) -> None:
    assert wide["buttons"] == 0


def test_the_legend_hides_and_shows(wide: dict[str, object]) -> None:
    assert wide["hidden"] == ["false", 2]
    assert wide["shown"] == ["true", 3]


def test_an_engine_is_shown_alone_and_again_with_all(wide: dict[str, object]) -> None:
    alone, together = wide["alone"], wide["together"]
    assert isinstance(alone, list)
    assert isinstance(together, list)
    kind, kinds, traces = alone
    assert set(kinds) == {kind}
    assert traces < 3
    assert together == [len(kinds) + 2, 3]


def test_panels_over_the_same_times_zoom_together(wide: dict[str, object]) -> None:
    zoomed, back = wide["zoomed"], wide["back"]
    assert isinstance(zoomed, list)
    assert zoomed[0] == zoomed[1] < 0.3  # a quarter of the run, and the axis' margins
    assert zoomed[2] == 1
    assert back == [1, 1, 1]


def test_the_keyboard_zooms(wide: dict[str, object]) -> None:
    zoomed, closer = wide["zoomed"], wide["closer"]
    assert isinstance(zoomed, list)
    assert isinstance(closer, float)
    # a press of plus shows 70 % of what was seen; the rest is rounding in the browser
    assert closer == pytest.approx(0.7 * zoomed[0], rel=1e-9)


def test_tables_sort_numbers_by_value_and_put_nothing_last(wide: dict[str, object]) -> None:
    values = ["\N{MINUS SIGN}0.1304", "0.0019", "\N{EN DASH}"]
    assert wide["up"] == ["ascending", values]
    assert wide["down"] == ["descending", [values[1], values[0], values[2]]]
    assert wide["words"] == [None, ["late", "mujoco", "pybull"]]


def test_a_narrow_screen_does_not_scroll_sideways(narrow: dict[str, object]) -> None:
    assert narrow["inner"] == 375
    assert isinstance(narrow["width"], int)
    assert narrow["width"] <= 375


def test_hostile_texts_do_not_run(narrow: dict[str, object]) -> None:
    title = narrow["title"]
    assert isinstance(title, str)
    assert title.startswith("Two engines </script>")
    assert narrow["drawn"] == [3, 3, 3, 1, 1]
