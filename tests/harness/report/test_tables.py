"""Tables as files: nothing is lost, nothing runs."""

import csv
import io

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from harness.cli.terminal import table_artefact
from harness.core.report_model import Table
from harness.engines.description import APART
from harness.report.notebook import table_html
from harness.report.tables import csv_text, dictionary, grid, markdown, parquet_bytes
from tests.support.engines import CONSTRAINT


def table(columns: dict[str, list[object]]) -> Table:
    frame = pd.DataFrame(columns)
    return Table(
        name="t", title="T", frame=frame, columns={name: f"What {name} is." for name in columns}
    )


NUMBERS = [0.1 + 0.2, 1e-300, -4.21737156919165646e-05, 209.363400462452]


def test_csv_keeps_every_digit() -> None:
    text = csv_text(table({"x_m": list(NUMBERS), "n": [1, 2, 3, 4], "ok": [True, False] * 2}))
    assert text.startswith("x_m,n,ok\r\n")
    back = list(csv.DictReader(io.StringIO(text, newline="")))
    assert [float(row["x_m"]) for row in back] == NUMBERS
    assert [row["n"] for row in back] == ["1", "2", "3", "4"]
    assert [row["ok"] for row in back] == ["true", "false"] * 2
    assert pd.read_csv(io.StringIO(text)).dtypes.astype(str).tolist() == [
        "float64",
        "int64",
        "bool",
    ]


def test_csv_quotes_as_the_standard_says() -> None:
    cells = ['a "quoted" word', "a, comma", "two\nlines", "", "ünïcode"]
    back = list(csv.reader(io.StringIO(csv_text(table({"text": list(cells)})), newline="")))
    assert [row[0] if row else "" for row in back[1:]] == cells


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r"])
def test_no_cell_is_a_formula(start: str) -> None:
    evil = f'{start}HYPERLINK("http://example.org")'
    back = list(csv.reader(io.StringIO(csv_text(table({evil: [evil]})), newline="")))
    assert back == [["'" + evil], ["'" + evil]]


def test_negative_numbers_stay_numbers() -> None:
    assert csv_text(table({"x": [-1.5, -2.0]})) == "x\r\n-1.5\r\n-2.0\r\n"


def test_nothing_is_an_empty_cell() -> None:
    assert csv_text(table({"x": [1.0, np.nan], "y": ["a", None]})) == "x,y\r\n1.0,a\r\n,\r\n"


def test_parquet_round_trip() -> None:
    given = table({"x_m": list(NUMBERS), "text": ["=1", "b", None, "d"], "n": [1, 2, 3, 4]})
    back = pq.read_table(io.BytesIO(parquet_bytes(given)))
    assert back.column("x_m").to_pylist() == NUMBERS
    assert back.column("text").to_pylist() == ["=1", "b", None, "d"]
    assert back.column("n").to_pylist() == [1, 2, 3, 4]
    assert back.schema.field("x_m").metadata == {b"description": b"What x_m is."}


def test_parquet_takes_columns_of_mixed_types() -> None:
    given = table({"value": [1, "two", (3.0, 4.0), None], "number": [1, 2.5, None, np.float32(1)]})
    back = pq.read_table(io.BytesIO(parquet_bytes(given)))
    assert back.column("value").to_pylist() == ["1", "two", "(3.0, 4.0)", None]
    assert back.column("number").to_pylist() == [1.0, 2.5, None, 1.0]


def test_the_same_table_gives_the_same_bytes() -> None:
    given = table({"x": list(NUMBERS), "text": list("abcd")})
    assert parquet_bytes(given) == parquet_bytes(given)
    assert csv_text(given) == csv_text(given)


def test_markdown_shows_texts_as_they_are() -> None:
    text = markdown(table({"a_deg": [1.23456], "b": ["<b>|*x*\n[y](z)"]}))
    lines = text.splitlines()
    assert lines[0] == "| a (°) | b |"
    assert lines[1] == "| ---: | --- |"
    assert lines[2] == r"| 1.235 | \<b\>\|\*x\* \[y\](z) |"


def test_the_page_shows_the_chosen_columns_in_their_order() -> None:
    frame = pd.DataFrame({"a": [1], "b": [2], "c": [3]})
    given = Table(name="t", title="T", frame=frame, columns={}, shown=("c", "a"))
    assert markdown(given).splitlines()[2] == "| 3 | 1 |"
    assert csv_text(given).startswith("a,b,c\r\n")


def test_the_dictionary_tells_every_column() -> None:
    text = dictionary([table({"x_m": [1.0], "n": [2]})])
    assert "| x\\_m | What x\\_m is. |" in text
    assert "| n | What n is. |" in text


def test_a_table_without_rows_is_written_too() -> None:
    empty = table({"x_m": [], "text": []})
    assert csv_text(empty) == "x_m,text\r\n"
    assert pq.read_table(io.BytesIO(parquet_bytes(empty))).num_rows == 0
    assert len(markdown(empty).splitlines()) == 2


def test_engines_that_impose_rolling_stand_apart_with_one_sentence_why() -> None:
    names = [CONSTRAINT, "mujoco", CONSTRAINT, "pybullet"]
    mixed = table({"engine": [*names], "x": [1.0, 2.0, 3.0, 4.0]})
    shown = grid("t", mixed, ())
    assert [row[1]["text"] for row in shown["rows"]] == ["2", "4"]
    assert [row[1]["text"] for row in shown["apart"]] == ["1", "3"]
    for text in (markdown(mixed), table_html(mixed)):
        assert text.count(APART) == 1
        places = [text.index(name) for name in ("mujoco", "pybullet", APART, CONSTRAINT)]
        assert places == sorted(places)
    terminal = table_artefact(mixed)
    assert APART in str(terminal.caption)
    assert [*terminal.columns[0].cells] == ["mujoco", "pybullet", CONSTRAINT, CONSTRAINT]
    # a file has the rows as they are
    assert [row["engine"] for row in csv.DictReader(io.StringIO(csv_text(mixed)))] == names


@pytest.mark.parametrize("names", [["mujoco", "pybullet"], [CONSTRAINT, CONSTRAINT]])
def test_a_table_of_one_kind_of_engines_is_whole(names: list[object]) -> None:
    one = table({"engine": names, "x": [1.0, 2.0]})
    assert len(grid("t", one, ())["rows"]) == len(names)
    assert APART not in markdown(one) + table_html(one) + str(table_artefact(one).caption)
