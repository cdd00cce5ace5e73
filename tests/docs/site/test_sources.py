"""The sources of the site: links lead within it, numbers lose their marks, code stays as it is."""

from pathlib import Path

import pytest

from docs.formatting import ROOT
from docs.site.engine_pages import engine_names, findings_of, guide_of
from docs.site.pages import pages
from docs.site.sources import gather, places, relinked, unmarked
from harness.core.errors import HarnessError

KNOWN = places()


def test_every_text_has_a_place_of_its_own() -> None:
    assert KNOWN["docs/findings/README.md"] == "findings/index.md"
    assert KNOWN["docs/start.md"] == "start.md"
    assert KNOWN["reports/README.md"] == "how-to/read-a-report.md"
    assert len(set(KNOWN.values())) == len(KNOWN) - 1  # README and docs/index.md share the first


def test_links_lead_from_where_a_text_stands_to_where_a_text_will_stand() -> None:
    text = "[a](../../README.md#b) [c](../findings/README.md) [d](https://x.org) [e](#f) "
    text += "[g](../findings)"
    answer, files = relinked(text, "docs/how-to", "how-to", KNOWN)
    assert answer == (
        "[a](../index.md#b) [c](../findings/index.md) [d](https://x.org) [e](#f) "
        "[g](../findings/index.md)"
    )
    assert files == set()


def test_what_is_no_page_comes_as_a_file() -> None:
    text = "![x](../../reports/baseline/rim-mujoco/rim.png)"
    answer, files = relinked(text, "docs/results", "results", KNOWN)
    assert files == {"reports/baseline/rim-mujoco/rim.png"}
    assert answer == "![x](../files/reports/baseline/rim-mujoco/rim.png)"


def test_links_in_code_are_no_links() -> None:
    text = "```python\na[0](b)\n```\n\n    c[1](d)\n\nand `e[2](f)`"
    assert relinked(text, "docs", "", KNOWN) == (text, set())


def test_a_link_to_nothing_is_an_error_that_names_it() -> None:
    with pytest.raises(HarnessError, match=r"none\.md"):
        relinked("[a](none.md)", "docs", "", KNOWN)


def test_numbers_lose_their_marks() -> None:
    assert unmarked("by <!-- = exact.turn -->209<!-- / --> degrees") == "by 209 degrees"


def test_what_was_gathered_before_and_is_no_more_is_gone(tmp_path: Path) -> None:
    made = pages()
    gather(tmp_path, {**made, "extra.md": "# Extra, of [the start](start.md)\n"})
    assert (tmp_path / "extra.md").is_file()
    written = (tmp_path / "start.md").stat().st_mtime_ns
    gather(tmp_path, made)
    assert not (tmp_path / "extra.md").exists()
    assert (tmp_path / "start.md").stat().st_mtime_ns == written  # Sphinx reads it once


def test_an_engine_has_the_findings_and_threads_that_name_it_and_no_others() -> None:
    titles = {name: [title for title, *_ in findings_of(name)] for name in engine_names()}
    assert any(title.startswith("MJX and MuJoCo Warp:") for title in titles["mjx"])
    assert any(title.startswith("MJX and MuJoCo Warp:") for title in titles["mujoco-warp"])
    assert not any(title.startswith("MJX") for title in titles["mujoco"])
    assert all(path.is_file() for path in (ROOT / "docs" / p for _, p in findings_of("dart")))
    assert {status for *_, status in guide_of("mujoco")} >= {"happens", "mended"}
    listed = {path for name in engine_names() for _, path in findings_of(name)}
    every = {f"findings/{path.name}" for path in (ROOT / "docs" / "findings").glob("*-*.md")}
    assert listed == every
