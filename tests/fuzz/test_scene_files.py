"""Some scene files gone wrong in each run of the tests; `python -m tests.fuzz` tries thousands."""

from pathlib import Path

import pytest

from models import load, write_scene
from tests.fuzz.campaign import Tally, campaign
from tests.fuzz.mutations import LEVELS, NAMES, NUMBERS, mutations, valid
from tests.fuzz.verdict import WRONG_USE, judged

FEW = 60
"""Scene files: some seconds."""


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # a warning is a fault that the campaign itself finds
def test_no_file_brings_forth_anything_but_an_answer_or_a_message(tmp_path: Path) -> None:
    tally: Tally = campaign(FEW, 1, tmp_path)
    assert tally.answered.total() + tally.refused.total() == FEW
    # both are tried: a campaign that is refused throughout would show nothing of the commands
    assert tally.answered.total() > FEW // 50
    assert tally.refused.total() > FEW // 4
    assert [fault[:3] for fault in tally.faults] == []


@pytest.mark.parametrize("level", LEVELS)
def test_mutations_are_the_same_again_and_others_with_another_seed(level: str) -> None:
    first, again, other = (list(mutations(level, 20, seed)) for seed in (3, 3, 4))
    assert first == again != other
    # a change may fall on nothing, or undo another; rarely
    unchanged = set(first) & {text.encode() for text in valid()}
    assert len(unchanged) <= 3


def written(tmp_path: Path, key: str, value: str) -> Path:
    """Write a valid scene with one value replaced by what TOML is given."""
    lines = write_scene(load("gentle-rock")).splitlines()
    place = next(n for n, line in enumerate(lines) if line.startswith(f"{key} = "))
    lines[place] = f"{key} = {value}"
    path = tmp_path / "scene.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", [name for name in NAMES if name != "con"])
def test_a_name_that_means_harm_is_refused(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, "name", f'"{name}"')
    for words in (
        ["reference", str(path), "--json"],
        ["export", str(path), "--format", "mjcf"],
        ["run", str(path), "--engine", "mujoco", "--json"],
        ["sweep", str(path), "--over", "can.h=1:2:2", "--out", str(tmp_path / "out")],
    ):
        verdict = judged(words)
        assert (verdict.code, verdict.fault) == (WRONG_USE, ""), words
    assert [p.name for p in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.slow
@pytest.mark.parametrize("number", NUMBERS)
def test_a_number_at_an_edge_is_answered_or_refused(tmp_path: Path, number: str) -> None:
    for key in ("radius", "phi", "psi_dot"):
        path = written(tmp_path, key, number)
        verdict = judged(["reference", str(path), "--json"])
        assert verdict.fault == "", (key, verdict)
