"""Files that hold records: their dialects, their faults, and ten thousand broken ones."""

import gzip
import random
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from harness.core.errors import InvalidSettingError
from harness.records import columns as under_test
from harness.records.columns import RecordFileError, mapping, read_columns
from harness.records.export import exact_frame
from harness.records.score import Labels, score
from models import Scene

LINES = (
    "time_s,x_m,y_m,z_m,qw,qx,qy,qz,note",
    *(f"{0.1 * n:.1f},1,2,3,1,0,0,0,on its way" for n in range(5)),
)


def written(path: Path, *lines: str) -> Path:
    """Return the path of a text of these lines."""
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("separator", "decimal"), [(",", "."), (";", ","), ("\t", "."), (" ", ".")]
)
def test_dialects(tmp_path: Path, separator: str, decimal: str) -> None:
    lines = [line.replace("on its way", "n") for line in LINES]
    lines = [line.replace(".", decimal if decimal != "," else "\0") for line in lines]
    lines = [line.replace(",", separator).replace("\0", ",") for line in lines]
    found = read_columns(written(tmp_path / "a.csv", "# a comment", *lines))
    assert found.quantities["time"] == pytest.approx(np.arange(5) / 10.0, abs=0.0)
    assert found.left_out == ("note",)


def test_parquet_is_read_to_the_bit(gentle: Scene, tmp_path: Path) -> None:
    frame = exact_frame(gentle)
    frame.to_parquet(tmp_path / "a.parquet")
    frame.to_csv(tmp_path / "a.csv", index=False)
    for name in ("a.parquet", "a.csv"):
        found = read_columns(tmp_path / name)
        assert (found.quantities["x"] == frame["x_m"].to_numpy()).all()


def without(column: str) -> list[str]:
    """Return the lines with another name of a column."""
    return [LINES[0].replace(column, f"{column}_other"), *LINES[1:]]


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        (without("time_s"), "has no column time_s"),
        (without("qw"), "has neither of qw, qx, qy, qz and phi_rad, psi_rad, theta_rad"),
        ([f"{LINES[0]},vx_m_s", *(f"{line},1" for line in LINES[1:])], "but none vy_m_s, vz_m_s"),
        ([f"{LINES[0]},x_mm", *(f"{line},1" for line in LINES[1:])], "two columns of x"),
        ([f"{LINES[0]},note", *(f"{line},1" for line in LINES[1:])], "two columns of one name"),
        ([*LINES[:4], LINES[4].replace("1,2,3", "1,two,3"), LINES[5]], "'two' in sample 4"),
        ([*LINES[:4], LINES[4].replace("1,2,3", "1,nan,3"), LINES[5]], "no number"),
        ([*LINES[:4], LINES[4].replace("1,2,3", "1,1e300,3"), LINES[5]], "no number"),
        ([*LINES[:4], LINES[3], LINES[5]], "does not increase at its sample 4"),
        (LINES[:3], "2 samples"),
        (["hello"], "has no column time_s"),
        ([], "is no table"),
    ],
)
def test_what_is_wrong_with_a_file_is_one_sentence(
    tmp_path: Path, lines: list[str], why: str
) -> None:
    with pytest.raises(RecordFileError) as caught:
        read_columns(written(tmp_path / "a.csv", *lines))
    assert why in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "a.csv" in str(caught.value)


@pytest.mark.parametrize("name", ["none.csv", "folder.csv", "text.parquet"])
def test_what_is_no_file_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.csv").mkdir()
    written(tmp_path / "text.parquet", "hello")
    with pytest.raises(RecordFileError, match=r"cannot be read|is no table"):
        read_columns(tmp_path / name)


def test_sizes_are_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "a.csv", *LINES)
    for limit, why in (
        ("LARGEST_FILE", "bytes"),
        ("MOST_SAMPLES", "samples"),
        ("MOST_COLUMNS", "columns"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(under_test, limit, 3)
            with pytest.raises(RecordFileError, match=why):
                read_columns(path)


def repeated(word: str, samples: int) -> pa.DictionaryArray:
    """Return a column of one word, which takes little memory as long as it is packed."""
    return pa.DictionaryArray.from_arrays(pa.repeat(pa.scalar(0, pa.int8()), samples), [word])


@pytest.mark.parametrize(
    ("names", "word", "why"),
    [
        ([f"c{n}" for n in range(1001)], "word", "more than 1000 columns"),
        (["x_m", "note"], "no number" * 1000, "no number"),
    ],
)
def test_parquet_is_refused_in_little_memory(
    tmp_path: Path, names: list[str], word: str, why: str
) -> None:
    path, pool = tmp_path / "a.parquet", pa.default_memory_pool()
    pq.write_table(pa.table(dict.fromkeys(names, repeated(word, 20_000))), path, store_schema=False)
    before = pool.max_memory() or 0
    with pytest.raises(RecordFileError, match=why):
        read_columns(path)
    assert (pool.max_memory() or 0) - before < 1e7  # one column of the second takes 1.8e8 bytes


def test_numbers_as_texts_are_read_from_parquet(tmp_path: Path) -> None:
    frame = pd.DataFrame([line.split(",") for line in LINES[1:]], columns=LINES[0].split(","))
    frame.set_index("time_s").to_parquet(tmp_path / "a.parquet")
    found = read_columns(tmp_path / "a.parquet")
    assert found.quantities["time"] == pytest.approx(np.arange(5) / 10.0, abs=0.0)
    frame.loc[3, "x_m"] = None
    frame.to_parquet(tmp_path / "a.parquet")
    with pytest.raises(RecordFileError, match="'x_m' has nan in sample 4"):
        read_columns(tmp_path / "a.parquet")


def test_what_parquet_unpacks_to_is_limited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.parquet"
    pq.write_table(pa.table({name: np.zeros(5000) for name in ("time_s", "x_m", "y_m")}), path)
    monkeypatch.setattr(under_test, "LARGEST_FILE", 100_000)
    with pytest.raises(RecordFileError, match="more than 100000 bytes once it is unpacked"):
        read_columns(path)


def test_a_compressed_text_is_to_be_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "a.csv.gz"
    path.write_bytes(gzip.compress("\n".join(LINES).encode()))
    with pytest.raises(RecordFileError, match="is compressed: unpack it first"):
        read_columns(path)


@pytest.mark.parametrize("delimiter", [",", " ", ";"])
@pytest.mark.parametrize(
    "names", ["time_s,x_m,y_m,z_m,qw,qx,qy,qz", "Time,x_m,y_m,z_m,qw,qx,qy,qz"]
)
def test_names_in_a_comment_are_read_as_numpy_writes_them(
    tmp_path: Path, delimiter: str, names: str
) -> None:
    path, rows = tmp_path / "a.csv", np.tile((0.0, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0), (5, 1))
    rows[:, 0] = np.arange(5) / 10.0
    np.savetxt(path, rows, delimiter=delimiter, header=f"a run, made today\n{names}")
    found = read_columns(path, {"time_s": "Time"} if "Time" in names else None)
    assert (found.quantities["time"] == rows[:, 0]).all()
    assert found.left_out == ()
    np.savetxt(path, rows, delimiter=delimiter, header=names.removesuffix(",qz"))
    with pytest.raises(RecordFileError, match="names 7 columns in a comment, and has 8"):
        read_columns(path)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "utf-8"])
def test_encodings_are_known_by_their_mark(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text("\r\n".join(LINES), encoding=encoding, newline="")
    assert len(read_columns(path).quantities["time"]) == 5


@pytest.mark.parametrize("pair", ["time_s", "time_s=", "t_s=Time", "x_km=x"])
def test_a_mapping_that_is_none_is_refused(pair: str) -> None:
    with pytest.raises(InvalidSettingError, match="--column"):
        mapping([pair])


def test_a_mapped_column_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordFileError, match="has no column 'Time', did you mean"):
        read_columns(written(tmp_path / "a.csv", *LINES), {"time_ms": "Time"})


def damaged(text: bytes, chance: random.Random) -> bytes:
    """Return a file with a few of its bytes, cells or lines damaged."""
    data = bytearray(text)
    kind = chance.randrange(5)
    if kind == 0:
        for _ in range(chance.randrange(1, 20)):
            data[chance.randrange(len(data))] = chance.randrange(256)
    elif kind == 1:
        data = data[: chance.randrange(len(data))]
    elif kind == 2:
        lines = bytes(data).split(b"\n")
        chance.shuffle(lines)
        data = bytearray(b"\n".join(lines))
    elif kind == 3:
        cells = [line.split(b",") for line in bytes(data).split(b"\n")]
        words = (b"", b"nan", b"inf", b"1e999", b"-0", b"<script>", b'"', b"0x10", b"1,5", b"\xff")
        for _ in range(chance.randrange(1, 5)):
            line = chance.choice(cells)
            line[chance.randrange(len(line))] = chance.choice(words)
        data = bytearray(b"\n".join(b",".join(line) for line in cells))
    else:
        data = bytearray(chance.randbytes(chance.randrange(400)))
    return bytes(data)


@pytest.mark.slow(1)
def test_ten_thousand_damaged_files_are_scored_or_refused(gentle: Scene, tmp_path: Path) -> None:
    frame = exact_frame(gentle)
    few = frame.iloc[:: len(frame) // 12]
    text, path = few.to_csv(index=False).encode(), tmp_path / "a.csv"
    chance, refused = random.Random(7), list[str]()  # noqa: S311 - damage, no secrets
    for _ in range(10_000):
        path.write_bytes(damaged(text, chance))
        try:
            score(gentle, path, Labels(name="damaged"))
        except RecordFileError as error:
            refused.append(str(error))
    assert 1000 < len(refused) < 10_000
    assert not any("\n" in said for said in refused)
