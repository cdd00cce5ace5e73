"""The scorecard is filled from every study that is there, and says what is missing."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from harness.core.report_model import Prose, Table
from harness.core.verdict import Status
from harness.report.layout import Section
from harness.report.scorecard import derived


def tables(chapters: list[Section]) -> dict[str, Table]:
    return {table.name: table for table in derived(chapters) if isinstance(table, Table)}


def rows(table: Table) -> "dict[tuple[str, str], pd.Series[Any]]":
    return {(row["engine"], row["profile"]): row for _, row in table.frame.iterrows()}


def test_a_row_is_filled_from_three_studies(study_sections: list[Section]) -> None:
    row = rows(tables(study_sections)["engines"])["mujoco", "matched"]
    assert row["turn_error_deg"] == 0.3
    assert row["locus_error_mm"] == 1.0
    assert str(row["turn_error_deg_verdict"]) == "agrees"
    assert row["turn_error_deg_case"] == "0123456789abcdef"
    assert row["stability_percent"] == 100.0  # of each hard case the smallest timestep, no member
    assert str(row["stability_percent_verdict"]) == "agrees: all 2 hard cases stay sound"
    assert row["price_s_s"] == 2.5
    assert str(row["price_s_s_verdict"]) == "cheapest"


def test_what_was_not_measured_has_no_column_and_no_table(study_sections: list[Section]) -> None:
    alone = [chapter for chapter in study_sections if chapter.compares]
    made = derived(alone)
    assert [artefact.name for artefact in made] == [
        "engines",
        "gentle-rock-engines",
        "not-measured",
    ]
    columns = tables(alone)["engines"].columns
    assert not {name for name in columns if name.startswith(("stability", "price"))}
    assert "turn_error_deg" in columns


def test_one_sentence_names_the_commands_that_add_it(study_sections: list[Section]) -> None:
    def told(*left_out: str) -> str:
        chapters = [c for c in study_sections if not c.title.endswith(left_out)]
        (words,) = [a.text for a in derived(chapters) if isinstance(a, Prose)] or [""]
        assert words.count(".") == bool(words) + words.count("0.1")
        return words

    commands = {
        "stability": "(rockingcan stability)",
        "cost": "(rockingcan cost gentle-rock)",
        "Attribution": "(rockingcan attribute gentle-rock --engine mujoco)",
    }
    for missing, command in commands.items():
        assert command in told(missing)
        assert not any(other in told(missing) for other in commands.values() if other != command)
    assert all(command in told(*commands) for command in commands.values())
    assert told("nothing") == ""


def test_what_an_engine_was_not_measured_in_is_said_in_its_row(
    study_sections: list[Section],
) -> None:
    row = rows(tables(study_sections)["engines"])["mujoco", "default"]
    assert pd.isna(row["stability_percent"])
    verdict = row["stability_percent_verdict"]
    assert verdict.status is Status.NOT_MEASURED


def test_a_failure_in_a_hard_case_is_named(study_sections: list[Section]) -> None:
    def coarse(chapter: Section) -> Section:
        return replace(
            chapter,
            artefacts=tuple(
                replace(a, frame=a.frame[a.frame["timestep_s"] == 1e-3])
                if isinstance(a, Table) and a.name == "verdicts"
                else a
                for a in chapter.artefacts
            ),
        )

    row = rows(tables([coarse(chapter) for chapter in study_sections])["engines"])[
        "mujoco", "matched"
    ]
    assert row["stability_percent"] == 50.0
    words = "deviates: 1 of 2 hard cases fail"
    assert str(row["stability_percent_verdict"]) == words


def test_causes_are_ranked_by_size_with_their_experiment(study_sections: list[Section]) -> None:
    causes = tables(study_sections)["causes"].frame
    turn, locus = (rows for _, rows in causes.groupby("quantity", sort=False))
    assert turn["cause"].tolist() == ["timestep", "compliance"]
    assert turn["rank"].tolist() == [1, 2]
    assert turn["takes_away"].tolist() == [0.35, -0.05]
    assert turn["case"].tolist() == ["aaaabbbbccccdddd", "unlisted"]
    # it deviates too, but the attribution has no account of it
    assert locus["cause"].tolist() == ["not decidable: a run on the way has no such number"]
    assert causes["command"].tolist()[0] == "rockingcan run --close timestep"


def test_of_two_attributions_of_an_engine_the_last_counts(study_sections: list[Section]) -> None:
    once, twice = (
        tables(chapters)["causes"].frame for chapters in (study_sections, study_sections * 2)
    )
    turns = [f[f["quantity"] == once["quantity"][0]] for f in (once, twice)]
    assert turns[0]["cause"].tolist() == ["timestep", "compliance"]
    assert set(turns[1]["rank"]) == {1, 2}
    assert turns[1].drop_duplicates()["cause"].tolist() == turns[0]["cause"].tolist()


def test_a_scene_has_its_own_scorecard(study_sections: list[Section]) -> None:
    own = tables(study_sections)["gentle-rock-engines"]
    assert own.scene == "gentle-rock"
    assert len(own.frame) == 2
    assert "price_s_s" not in own.frame


def test_a_report_without_a_comparison_has_none(study_sections: list[Section]) -> None:
    assert derived([chapter for chapter in study_sections if not chapter.compares]) == ()


def test_every_column_is_told(study_sections: list[Section]) -> None:
    for table in tables(study_sections).values():
        assert list(table.columns) == list(table.frame.columns)
        assert all(meaning.endswith(".") for meaning in table.columns.values())


def test_the_summary_has_numbers_with_verdicts(joined_report: Path) -> None:
    text = (joined_report / "summary.md").read_text(encoding="utf-8")
    assert "0.3, deviates by a factor 3" in text
    assert "2.5, cheapest" in text
