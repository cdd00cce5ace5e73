"""Examples in other languages: model in, trajectory out, score."""

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import mujoco
import pytest

from tests.support.command_line import Command

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def scored(rockingcan: Command, scene: str, motion: Path) -> dict[str, Any]:
    """Return the errors of the first bounce of a record."""
    answer = rockingcan("score", scene, str(motion), "--json")
    assert answer.code == 0, answer.err
    found: dict[str, Any] = answer.json()
    return found


@pytest.mark.parametrize(
    ("scene", "step", "error"), [("gentle-rock", "1e-3", 1.167e-4), ("gentle-rock", "1e-4", 1.2e-8)]
)
def test_javascript_is_scored(
    rockingcan: Command, tmp_path: Path, scene: str, step: str, error: float
) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("there is no node")
    model, motion = tmp_path / "scene.json", tmp_path / "motion.csv"
    assert rockingcan("export", scene, "--format", "json", "--out", str(model)).code == 0
    program = [node, str(EXAMPLES / "rolling_can.mjs"), str(model), str(motion), step]
    subprocess.run(program, check=True)  # noqa: S603 - our own
    found = scored(rockingcan, scene, motion)
    assert found["errors"]["angle_of_turn_deg"] == [pytest.approx(error, rel=0.05)]
    assert found["errors"]["peak_friction_ratio"] == [None]
    assert any("no forces" in sentence for sentence in found["unknown"])


def test_c_plus_plus_is_scored_as_the_engine_is(rockingcan: Command, tmp_path: Path) -> None:
    compiler, package = shutil.which("g++"), Path(mujoco.__file__).parent
    libraries = list(package.glob("libmujoco.so.*"))
    if compiler is None or not libraries or not (package / "include").is_dir():
        pytest.skip("there is no g++, or MuJoCo has no headers here")
    model, motion, program = (tmp_path / name for name in ("can.xml", "motion.csv", "mujoco_can"))
    assert rockingcan("export", "gentle-rock", "--format", "mjcf", "--out", str(model)).code == 0
    source = ["-std=c++17", f"-I{package / 'include'}", str(EXAMPLES / "mujoco_can.cc")]
    linked = [str(libraries[0]), f"-Wl,-rpath,{package}", "-o", str(program)]
    subprocess.run([compiler, *source, *linked], check=True)  # noqa: S603 - our own
    arguments = [str(program), str(model), str(motion), "1e-5", "0.34"]
    subprocess.run(arguments, check=True)  # noqa: S603
    own = scored(rockingcan, "gentle-rock", motion)["errors"]["angle_of_turn_deg"]
    run = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-5", "--json")
    assert own == [pytest.approx(run.json()["errors"]["angle_of_turn_deg"][0], abs=1e-4)]


@pytest.mark.parametrize("name", ["rolling_can.mjs", "mujoco_can.cc"])
def test_the_commands_of_an_example_are_those_that_are_tried(name: str) -> None:
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    assert re.search(
        r"^//   rockingcan export gentle-rock --format (json|mjcf) --out", text, re.MULTILINE
    )
    assert re.search(rf"^//   .*{Path(name).stem}", text, re.MULTILINE)
    assert re.search(r"^//   rockingcan score gentle-rock motion.csv", text, re.MULTILINE)
