"""Results on disk: all of them or none, and one message for what is none."""

import errno
import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.writing import WriteError
from harness.gate.baseline import write_baseline
from harness.results.errors import FILE, Fault, ResultsError
from harness.results.files import _rounded_up, check_place, read_baseline, result_name
from harness.results.result import Result
from tests.support.gate_scores import make_score, make_scores


@pytest.fixture
def some() -> Result:
    first = make_score(
        {"phi_rms_rad": 0.1 + 0.2, "steps": 100.0},
        spread={"phi_rms_rad": 1.2345e-9, "steps": 0.0, "angle_of_turn_error_deg": None},
        endings={"FINISHED": 5},
    )
    return make_scores(first, make_score(scene="petals", outcome="FLAT"), platform="there")


def test_what_is_read_is_what_was_written(some: Result, tmp_path: Path) -> None:
    (tmp_path / "beside.csv").write_text("stays", encoding="utf-8")
    write_baseline(some, tmp_path)
    write_baseline(some, tmp_path)
    found = read_baseline(tmp_path)
    assert (found.suite, found.versions, found.machine) == (some.suite, some.versions, some.machine)
    assert list(found.scores) == list(some.scores)
    for name, one in some.scores.items():
        back = found.scores[name]
        assert back.values == one.values  # every bit
        assert (back.outcome, back.endings, back.digest) == (one.outcome, one.endings, one.digest)
    spread = next(iter(found.scores.values())).spread
    assert spread == {"phi_rms_rad": 1.24e-9, "steps": 0.0, "angle_of_turn_error_deg": None}
    assert sorted(path.name for path in tmp_path.iterdir()) == [FILE, "beside.csv"]


@given(st.floats(0.0, 1e9))
def test_a_spread_is_never_rounded_down(value: float) -> None:
    rounded = _rounded_up(value)
    assert rounded is not None
    # an ulp, since the unit in the last digit is no binary number
    assert rounded >= value * (1.0 - 1e-15)
    assert rounded <= max(1.01 * value, 1e-299) or value == 0.0
    assert _rounded_up(rounded) == rounded


def test_the_file_is_for_everyone_to_read_and_of_version_2(some: Result, tmp_path: Path) -> None:
    path = write_baseline(some, tmp_path / "new" / "folder")
    assert path.stat().st_mode & 0o777 == 0o644
    told = json.loads(path.read_text(encoding="utf-8"))
    assert (told["format"], told["version"]) == ("rockingcan-result", 2)
    path.write_text(json.dumps(told | {"version": 1}), encoding="utf-8")
    with pytest.raises(ResultsError) as caught:
        read_baseline(path.parent)
    assert (caught.value.place, caught.value.fault) == (path, Fault.VERSION)


def test_what_is_no_number_is_not_written_and_letters_are_as_they_are(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="finite number"):
        write_baseline(make_scores(make_score({"phi_rms_rad": math.nan})), tmp_path)
    path = write_baseline(make_scores(make_score(), platform="Zürich"), tmp_path)
    assert "Zürich" in path.read_text(encoding="utf-8")


def test_a_line_a_case(some: Result, tmp_path: Path) -> None:
    lines = write_baseline(some, tmp_path).read_text(encoding="utf-8").splitlines()
    assert sum('"scene"' in line for line in lines) == len(some.scores)


def test_what_cannot_be_written_leaves_what_was_there(
    some: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_baseline(some, tmp_path)
    before = path.read_bytes()

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(WriteError) as caught:
        write_baseline(some, tmp_path)
    assert caught.value.path == path
    assert isinstance(caught.value.__cause__, OSError)
    assert caught.value.__cause__.errno == errno.ENOSPC
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == [FILE]


def test_a_place_that_is_a_file_is_refused_at_once(tmp_path: Path) -> None:
    check_place(tmp_path / "new" / "folder", "")
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(WriteError) as caught:
            check_place(place, "")
        assert caught.value.path == place
        assert str(tmp_path / "file") in caught.value.reason


def test_a_folder_without_accepted_results_holds_none(tmp_path: Path) -> None:
    with pytest.raises(ResultsError) as caught:
        read_baseline(tmp_path)
    assert (caught.value.place, caught.value.fault) == (tmp_path, Fault.MISSING)


@pytest.mark.parametrize(
    "text",
    ["", "no JSON", "[]", "{}", '{"format": "another"}', "null", '{"format": 1, "version": 1}'],
)
def test_what_is_none_is_refused_in_one_sentence(text: str, tmp_path: Path) -> None:
    (tmp_path / FILE).write_text(text, encoding="utf-8")
    with pytest.raises(ResultsError) as caught:
        read_baseline(tmp_path)
    assert caught.value.place == tmp_path / FILE
    assert caught.value.fault in {Fault.UNREADABLE, Fault.DAMAGED, Fault.VERSION}
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "key", ["suite", "engines", "machine", "made", "program", "inputs", "cases"]
)
def test_what_lacks_a_part_is_damaged(some: Result, key: str, tmp_path: Path) -> None:
    path = write_baseline(some, tmp_path)
    told = json.loads(path.read_text(encoding="utf-8"))
    del told[key]
    path.write_text(json.dumps(told), encoding="utf-8")
    with pytest.raises(ResultsError) as caught:
        read_baseline(tmp_path)
    assert (caught.value.fault, caught.value.reason) == (Fault.DAMAGED, f"{key}: Field required")


@pytest.mark.parametrize(
    ("engine", "settings", "name"),
    [
        ("mujoco", {}, "mujoco-4.0.0-quick.json"),
        ("mujoco-4.0.0", {}, "mujoco-4.0.0-quick.json"),
        ("mujoco", {"mujoco.cone": "elliptic"}, "mujoco-4.0.0-quick-cone-elliptic.json"),
        ("mujoco", {"mujoco.x": "../../a b"}, "mujoco-4.0.0-quick-x-..-..-a-b.json"),
    ],
)
def test_settings_on_top_have_a_file_of_their_own(
    engine: str, settings: dict[str, str], name: str
) -> None:
    assert result_name(engine, "4.0.0", "quick", settings) == name
