"""The command line: refusals at once, and a price list of a real engine to paste from."""

from pathlib import Path

import pytest

from harness.engines.registry import variants
from harness.studies.cost import design, points
from tests.support.command_line import Command


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--suite", "tiny"), "quick or full"),
        (("--target", "-1"), "a positive number of degrees"),
        (("--engine", "nothing"), "unknown engine"),
        (("--tune", "gentle-rock"), "another scene than the one scored"),
    ],
)
def test_wrong_use_is_refused_before_anything_runs(
    rockingcan: Command, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    answer = rockingcan("cost", "gentle-rock", *words, "--out", str(tmp_path / "out"))
    assert answer.code == 2
    assert said in answer.err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_price_list_with_what_to_paste(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(points.RUNGS, "quick", (1.0, 0.3))
    monkeypatch.setitem(points.RUNGS, "tuning", (1.0, 0.3))
    monkeypatch.setitem(points.SHARES, "quick", (4.0, 2.0))
    monkeypatch.setitem(points.SHARES, "tuning", (4.0, 2.0))
    monkeypatch.setitem(design.DECADES, "quick", (-5,))
    monkeypatch.setattr(design, "variants", lambda name: variants(name)[:3])
    words = ("cost", "gentle-rock", "--engine", "mujoco", "--target", "40")
    out = tmp_path / "out"
    answer = rockingcan(*words, "--jobs", "1", "--out", str(out))
    assert answer.code == 0, answer.err
    assert "<option timestep=" in answer.out
    assert (out / "gentle-rock" / "index.html").exists()
    assert any((out / "scenes").glob("*.toml"))
    again = rockingcan(*words, "--jobs", "1", "--out", str(out), "--json").json()
    assert {row["target_deg"] for row in again["prices"]} == {40.0}
    assert any(row["paste"] for row in again["prices"])
