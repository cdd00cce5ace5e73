"""The commands: one JSON object, a report that opens, and refusals before anything runs."""

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from harness.cli.studies import attribute, errors
from harness.core.errors import InvalidSettingError, UnknownEngineError, UnknownSettingError

app = typer.Typer()
app.command()(attribute)
app.command()(errors)


def answer(*words: str) -> dict[str, object]:
    result = CliRunner().invoke(app, [*words, "--jobs", "1", "--json"], catch_exceptions=False)
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert isinstance(found, dict)
    return found


@pytest.mark.slow
def test_attribute_answers_with_one_object_and_writes_a_report(tmp_path: Path) -> None:
    out = tmp_path / "report"
    words = ("--engine", "mujoco", "--figures", "--out", str(out))
    found = answer("attribute", "gentle-rock", *words)
    assert found["order"] == ["compliance", "friction regularisation", "solver", "timestep"]
    turn = found["quantities"]["turn_error_deg"]  # type: ignore[index]
    parts = sum(gap["in_order"] for gap in turn["gaps"])
    assert parts == pytest.approx(turn["as_shipped"] - turn["remains"], rel=1e-12)
    assert (out / "figures" / "gentle-rock-mujoco-waterfall.png").exists()
    assert (
        "rockingcan run gentle-rock" in (out / "tables" / "gentle-rock-mujoco-runs.csv").read_text()
    )


@pytest.mark.slow
def test_errors_answers_with_one_object_and_writes_a_report(tmp_path: Path) -> None:
    out = tmp_path / "report"
    words = ("--set", "solref=0.02,1", "--timestep", "1e-3", "--figures", "--out", str(out))
    found = answer("errors", "gentle-rock", "--engine", "mujoco", *words)
    ladder = found["ladder_s"]
    assert isinstance(ladder, list)
    assert ladder[0] == 1e-3
    assert {row["way"] for row in found["errors"]} == {"matched with solref 0.02, 1"}  # type: ignore[attr-defined]
    assert (out / "figures" / "gentle-rock-mujoco-matched-errors.svg").exists()
    assert (out / "tables" / "gentle-rock-mujoco-matched-split.parquet").exists()


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("attribute", "gentle-rock", "--engine", "nothing"), UnknownEngineError),
        (("attribute", "gentle-rock", "--engine", "reference"), InvalidSettingError),
        (("attribute", "gentle-rock", "--engine", "mujoco", "--first", "x"), InvalidSettingError),
        (
            ("attribute", "gentle-rock", "--engine", "mujoco", "--timestep", "-1"),
            InvalidSettingError,
        ),
        (("errors", "gentle-rock", "--engine", "mujoco", "--set", "x=1"), UnknownSettingError),
        (("errors", "gentle-rock", "--engine", "mujoco", "--profile", "x"), InvalidSettingError),
    ],
)
def test_wrong_use_is_refused(words: tuple[str, ...], error: type[Exception]) -> None:
    with pytest.raises(error):
        CliRunner().invoke(app, list(words), catch_exceptions=False)
