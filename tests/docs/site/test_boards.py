"""The leaderboard: divisions apart, and each cell leads to its case."""

import re
from pathlib import Path

import pytest

from docs.formatting import BASELINE
from docs.site import boards
from docs.site.boards import Row, anchor, cases_html, leaderboard_page, top
from harness.results.errors import ResultsError
from harness.results.files import read_baseline, write_result
from harness.results.leaderboard import leaderboard
from harness.results.result import Result
from harness.results.scores import Division


@pytest.fixture
def accepted(monkeypatch: pytest.MonkeyPatch) -> Result:
    """Return the accepted results, as the only ones."""
    result = read_baseline(BASELINE)
    monkeypatch.setattr(boards, "results", lambda: (result,))
    return result


def ranked(suite: str) -> list[Row]:
    own = [result for result in boards.results() if result.suite == suite]
    standings = leaderboard(own, Division.MATCHED)
    return boards.rows_of(standings, list(dict.fromkeys(s.scene for s in standings)))


def test_each_cell_leads_to_a_case_on_the_page_of_its_engine(accepted: Result) -> None:
    page = leaderboard_page()
    links = re.findall(r'href="engines/([\w-]+)\.html#([\w.-]+)"', page)
    assert len(links) > 20
    engines = {engine for engine, _ in links}
    cases = {engine: cases_html(engine) for engine in engines}
    assert engines == set(accepted.engines)
    assert all(f'id="{case}"' in cases[engine] for engine, case in links)


def test_every_case_stands_there_with_its_command(accepted: Result) -> None:
    page = cases_html("mujoco")
    own = [score for score in accepted.cases if score.engine == "mujoco"]
    assert page.count("<details") == len(own)
    assert all(f'id="{anchor(accepted.place, score.digest)}"' in page for score in own)
    assert page.count("rockingcan run ") == len(own)


def test_a_result_of_another_engine_says_nothing_of_this(accepted: Result) -> None:
    assert "drake" not in accepted.engines
    assert cases_html("drake") == ""


def test_divisions_have_tables_of_their_own(accepted: Result) -> None:
    page = leaderboard_page()
    heads = re.findall(r"^### (.*)$", page, flags=re.MULTILINE)
    assert heads == [f"{name} ({accepted.suite})" for name in ("As shipped", "Matched", "Open")]
    shipped, matched, opened = re.split(r"^### .*$", page, flags=re.MULTILINE)[1:]
    assert "(default, " in shipped
    assert "(default, " not in matched
    assert "No file of results" in opened


def test_a_constraint_is_ranked_with_no_contact() -> None:
    rows = [row for row in ranked("quick") if row.label in {"Exudyn", "MuJoCo"}]
    assert [row.label for row in rows] == ["MuJoCo", "Exudyn"]  # whatever their errors
    assert [row.apart for row in rows] == [False, True]


def theirs(accepted: Result, place: str) -> Result:
    """Return the cases of MuJoCo as if another engine had run them, which is not known here."""
    name = "their engine}#1%"
    cases = [score for score in accepted.cases if score.engine == "mujoco"]
    release = accepted.engines["mujoco"].model_copy(update={"label": name})
    other = accepted.of_cases(score.model_copy(update={"engine": name}) for score in cases)
    return other.model_copy(update={"engines": {name: release}}).read_from(place)


def test_an_engine_that_is_not_known_has_a_row_and_no_page(
    accepted: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = theirs(accepted, "theirs.json")
    monkeypatch.setattr(boards, "results", lambda: (result,))
    page = leaderboard_page()
    assert '<th scope="row">their engine}#1%' in page
    assert "href=" not in page.split("## Suite")[1]
    assert "--kind-their engine" not in page
    assert "--kind-their-engine--1--" in page
    assert top(1)


def test_an_anchor_is_an_address_and_each_file_has_its_own() -> None:
    names = ("a b", "a#b", "a%b", "a-b")
    anchors = [anchor(f"reports/results/{name}.json", "0" * 16) for name in names]
    assert all(re.fullmatch(r"[\w.-]+", one) for one in anchors)
    assert len(set(anchors)) == len(names)
    assert anchors[3] == "case-a-b-0000000000000000"


def test_a_file_that_cannot_be_is_named_and_nothing_is_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    accepted = read_baseline(BASELINE)
    monkeypatch.setattr(boards, "SUBMITTED", tmp_path)
    write_result(theirs(accepted, ""), tmp_path / "good.json")
    assert boards.results.__wrapped__()[0].place == str(tmp_path / "good.json")
    first, *others = accepted.cases
    forged = first.model_copy(update={"spread": dict.fromkeys(first.values, 1e9)})
    write_result(accepted.of_cases([forged, *others]), tmp_path / "forged.json")
    with pytest.raises(ResultsError, match=r"forged.json' does not hold \(not a spread that fits"):
        boards.results.__wrapped__()


def test_words_of_a_submitter_are_text(accepted: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    hostile = accepted.model_copy(update={"name": "<script>alert(1)</script>"})
    monkeypatch.setattr(boards, "results", lambda: (hostile,))
    for text in (leaderboard_page(), cases_html("mujoco"), top(3)):
        assert "<script>" not in text
        assert "&lt;script&gt;" in text
