"""The page as a parser sees it: landmarks, headings, anchors, nothing fetched, nothing run."""

import re
from collections import Counter
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import pandas as pd
import pytest

from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Table
from harness.report.write import write_report

VOID = {"meta", "img", "br", "link", "input", "hr"}


class Page(HTMLParser):
    """Elements with their attributes and text, in the order of the page."""

    def __init__(self, path: Path) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str], list[str]]] = []
        self.open: list[tuple[str, dict[str, str], list[str]]] = []
        self.feed(path.read_text(encoding="utf-8"))
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Open an element."""
        element = (tag, {name: value or "" for name, value in attrs}, list[str]())
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Open and close an element."""
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        """Close the innermost element, which must be this one."""
        assert self.open, f"</{tag}> closes nothing"
        assert self.open[-1][0] == tag, f"</{tag}> closes <{self.open[-1][0]}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        """Give a text to every open element."""
        for _, _, texts in self.open:
            texts.append(data)

    def all(self, *tags: str) -> list[tuple[str, dict[str, str], str]]:
        """Return the elements of some names: name, attributes, text."""
        return [(t, a, "".join(texts).strip()) for t, a, texts in self.elements if t in tags]


@pytest.fixture(scope="module")
def page(report: Path) -> Page:
    return Page(report / "index.html")


@pytest.fixture(scope="module")
def hostile_page(hostile_report: Path) -> Page:
    return Page(hostile_report / "index.html")


def test_every_element_is_closed(page: Page, hostile_page: Page) -> None:
    assert not page.open
    assert not hostile_page.open


def test_landmarks(page: Page) -> None:
    for tag in ("main", "nav", "footer", "h1", "title"):
        assert len(page.all(tag)) == 1, tag
    assert page.all("a")[0][1] == {"class": "skip", "href": "#content"}
    assert page.all("html")[0][1]["lang"] == "en"
    assert "width=device-width" in str(page.all("meta"))


def test_headings_make_a_table_of_contents(page: Page) -> None:
    headings = page.all("h1", "h2", "h3", "h4")
    levels = [int(tag[1]) for tag, _, _ in headings]
    assert levels[0] == 1
    assert all(later <= earlier + 1 for earlier, later in pairwise(levels))
    assert [text for tag, _, text in headings if tag == "h2"] == [
        "Summary",
        "gentle-rock",
        "Over all scenes",
        "Cases",
        "Provenance",
    ]


def test_figures_come_before_tables_and_words(page: Page) -> None:
    titles = [text for tag, _, text in page.all("h3")]
    assert titles == [
        "Scorecard",
        "Angles through the bounce",
        "Contact locus",
        "Model parity",
        "Why",
        "Error against timestep",
    ]


def test_anchors_are_unique_and_lead_somewhere(page: Page, hostile_page: Page) -> None:
    for one in (page, hostile_page):
        names = [attributes["id"] for _, attributes, _ in one.elements if "id" in attributes]
        assert len(names) == len(set(names))
        for _, attributes, _ in one.elements:
            for key in ("href", "aria-labelledby"):
                target = attributes.get(key, "")
                if key == "aria-labelledby" and target:
                    assert target in names
                elif target.startswith("#"):
                    assert target[1:] in names


def test_links_lead_to_files_of_the_report(report: Path, page: Page) -> None:
    links = [a["href"] for _, a, _ in page.all("a") if not a["href"].startswith("#")]
    assert len(links) == 2 * 2 + 5  # tables, and what stands beside the page
    for link in links:
        assert (report / link).is_file(), link


def test_a_digest_links_to_its_case(page: Page) -> None:
    links = {a["href"]: text for _, a, text in page.all("a") if a.get("class") == "case"}
    assert links == {
        "#case-0123456789abcdef": "0123456789abcdef",
        "#case-fedcba9876543210": "fedcba9876543210",
    }
    commands = [text for _, _, text in page.all("code")]
    assert "rockingcan run gentle-rock --engine mujoco --timestep 1e-05" in commands


def test_nothing_is_fetched(page: Page) -> None:
    for tag, attributes, _ in page.elements:
        assert tag not in {"link", "iframe", "object", "embed", "base", "form"}
        source = attributes.get("src", "data:")
        assert source.startswith("data:"), (tag, source[:80])
        if tag == "a":
            assert "//" not in attributes["href"]
    policy = next(
        a["content"]
        for _, a, _ in page.all("meta")
        if a.get("http-equiv", "").startswith("Content")
    )
    assert policy.startswith("default-src 'none';")
    assert "http" not in policy
    style = "".join(text for _, _, text in page.all("style"))
    assert not re.search(r"@import|url\(", style)


def test_every_panel_has_one_still_picture_with_words(page: Page, hostile_page: Page) -> None:
    for one in (page, hostile_page):
        panels = [a for _, a, _ in one.all("div") if a.get("class") == "panel"]
        stills = [a for _, a, _ in one.all("svg") if a.get("class") == "still"]
        assert len(stills) == len(panels) == 3 + 1 + 1
        graphs = [a for _, a, _ in one.all("div") if "graph" in a.get("class", "").split()]
        assert [a["aria-label"] for a in stills] == [a["aria-label"] for a in graphs]
        assert {a["role"] for a in stills} == {"img"}
    assert stills[0]["aria-label"].startswith("Nutation </script>")


@pytest.mark.slow
def test_files_for_paper_are_named_where_there_are_any(
    artefacts: tuple[Artefact, ...], provenance: Provenance, page: Page, tmp_path: Path
) -> None:
    def files(one: Page) -> list[str]:
        links = (a["href"] for _, a, _ in one.all("a"))
        return [link for link in links if link.startswith("figures/")]

    out = tmp_path / "report"
    write_report(artefacts, out, title="t", cases=(), provenance=provenance, figures=True)
    drawn = Page(out / "index.html")
    names = [f"figures/{n}.{form}" for n in ("angles", "locus", "order") for form in ("png", "svg")]
    assert files(drawn) == names
    assert all((out / name).stat().st_size > 1000 for name in names)
    assert files(page) == []
    assert "--figures" in page.all("footer")[0][2]
    assert "--figures" not in drawn.all("footer")[0][2]


def test_columns_can_be_sorted_by_keyboard(page: Page) -> None:
    heads = [a for _, a, _ in page.all("th") if a.get("scope") == "col"]
    buttons = [a for _, a, _ in page.all("button") if not a.get("class")]
    assert len(heads) == len(buttons) == 7
    assert all(button == {"type": "button"} for button in buttons)


def test_hostile_texts_stay_texts(page: Page, hostile_page: Page) -> None:
    # the hostile cells are no digests, so they are no links; all else is made of the same elements
    made = Counter(tag for tag, _, _ in page.elements if tag != "a")
    assert Counter(tag for tag, _, _ in hostile_page.elements if tag != "a") == made
    for _, attributes, _ in hostile_page.elements:
        assert not any(name.startswith("on") for name in attributes)
    assert "owned" in hostile_page.all("title")[0][2]
    assert hostile_page.all("h1")[0][2].startswith("Two engines </script>")


def test_a_long_table_says_how_much_of_it_is_in_its_files(
    provenance: Provenance, tmp_path: Path
) -> None:
    def written(count: int) -> str:
        frame = pd.DataFrame({"n": range(count)})
        table = Table(name="long", title="Long", frame=frame, columns={"n": "A number."})
        out = tmp_path / str(count)
        page = write_report([table], out, title="t", cases=(), provenance=provenance)
        assert len((out / "tables" / "long.csv").read_text(encoding="utf-8").splitlines()) > count
        return page.read_text(encoding="utf-8")

    assert "The first 400 of 401 rows. All of them" in written(401)
    assert "The first" not in written(400)
