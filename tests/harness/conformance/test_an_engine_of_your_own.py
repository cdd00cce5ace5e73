"""The engine that docs/how-to shows: taken from there, built, installed, run all the way."""

import importlib.util
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow  # it builds a package and runs seven cases of it

DOCUMENT = Path(__file__).parents[3] / "docs" / "how-to" / "engine-of-your-own.md"

SCRIPT = """
import json, math, sys
from importlib.metadata import entry_points
from harness import simulate
from harness.core.case import Case
from harness.engines.conformance import conform
from harness.engines.probes import measure
from harness.core.engine_packages import ENGINE_ENTRY_POINTS
from harness.engines.registry import engine, names
from harness.evaluation.run_cases import run_cases
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.studies.comparison.study import comparison_report
from models import load

if __name__ == "__main__":
    scene = load("gentle-rock")
    entries = entry_points(group=ENGINE_ENTRY_POINTS)
    found = {"entry": [e.value for e in entries if e.name == "strict"]}
    found["names"] = names()
    found["file"] = sys.modules[type(engine("strict")).__module__].__file__
    found["checks"] = {v.name: [v.result.value, v.detail] for v in conform(engine("strict"))}
    evaluation = simulate("gentle-rock", "strict")
    found["turn_error_deg"] = math.degrees(evaluation.errors.angle_of_turn[0])
    cases = [
        Case(scene=scene, engine=name, profile=profile, timestep=timestep)
        for name in ("strict", "mujoco")
        for profile, timestep in (("default", None), ("matched", 1e-3), ("matched", 5e-4))
    ]
    with IsolatedProcessPool(2) as executor:
        evaluations = run_cases(cases, executor)
    found["outcomes"] = [e.simulation.outcome.name for e in evaluations]
    found["artefacts"] = {a.name: getattr(a, "text", "") for a in comparison_report(evaluations)}
    # at the greatest timestep, since what is asked here is whether it can be probed at all
    probed = measure(Case(scene=scene, engine="strict", timestep=1e-3))
    found["probed"] = {f.quantity: f.value for f in probed.findings}
    json.dump(found, sys.stdout)
"""


def block(language: str) -> str:
    """Return the first block of a language in the document."""
    text = DOCUMENT.read_text(encoding="utf-8")
    found = re.search(rf"```{language}\n(.*?)```", text, re.DOTALL)
    assert found is not None
    return found.group(1)


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder into which the package of the document is installed."""
    project = tmp_path_factory.mktemp("project")
    package = project / "src" / "strict_engine"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(block("python"), encoding="utf-8")
    (project / "pyproject.toml").write_text(block("toml"), encoding="utf-8")
    into = tmp_path_factory.mktemp("installed")
    if importlib.util.find_spec("pip") and importlib.util.find_spec("hatchling"):
        words = ["install", "--quiet", "--no-deps", "--no-index", "--no-build-isolation"]
        words += ["--disable-pip-version-check", "--root-user-action=ignore"]
        subprocess.run(  # noqa: S603 - our own words
            [sys.executable, "-m", "pip", *words, "--target", str(into), str(project)],
            check=True,
            capture_output=True,
            timeout=300,
        )
        return into
    # without a build tool, the folders that one would have written
    (package).rename(into / "strict_engine")
    metadata = into / "strict_engine-1.0.dist-info"
    metadata.mkdir()
    told = tomllib.loads(block("toml"))["project"]
    entries = [
        f"{name} = {value}" for name, value in told["entry-points"]["rockingcan.engines"].items()
    ]
    (metadata / "entry_points.txt").write_text(
        "\n".join(["[rockingcan.engines]", *entries, ""]), encoding="utf-8"
    )
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {told['name']}\nVersion: {told['version']}\n",
        encoding="utf-8",
    )
    return into


def script_environment(target: Path) -> dict[str, str]:
    """Return the environment of a process that sees what is installed there."""
    paths = [str(target), *(path for path in sys.path if path)]
    return os.environ | {"PYTHONPATH": os.pathsep.join(paths)}


@pytest.fixture(scope="module")
def found(target: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return what a process that sees the installed package makes of it."""
    script = tmp_path_factory.mktemp("script") / "whole_path.py"
    script.write_text(SCRIPT, encoding="utf-8")
    done = subprocess.run(  # noqa: S603 - our own script
        [sys.executable, str(script)],
        env=script_environment(target),
        capture_output=True,
        check=False,
        encoding="utf-8",
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_it_is_short() -> None:
    assert len(block("python").splitlines()) < 80


def test_it_is_found_by_its_entry_point(found: dict[str, Any], target: Path) -> None:
    assert found["entry"] == ["strict_engine:StrictEngine"]
    assert set(found["names"]) >= {"mujoco", "pybullet", "reference", "strict"}
    assert Path(found["file"]).is_relative_to(target)


def test_it_keeps_the_contract(found: dict[str, Any]) -> None:
    results = {name: result for name, (result, _) in found["checks"].items()}
    assert {name for name, result in results.items() if result == "failed"} == set()
    # it honours every effect; everything else applies, a fresh process as well
    assert {name for name, result in results.items() if result == "not applicable"} <= {
        "unsupported effect",
        "repeats in a batch",
    }


def test_it_turns_as_exactly_as_the_document_says(found: dict[str, Any]) -> None:
    assert 0.001 < abs(found["turn_error_deg"]) < 0.02


def test_it_goes_through_the_comparison(found: dict[str, Any]) -> None:
    assert found["outcomes"] == ["FINISHED"] * 6
    assert "strict matched to the scene misses the angle" in found["artefacts"]["summary"]
    assert {"results", "orders", "bounces", "parity"} <= found["artefacts"].keys()


def test_it_can_be_probed(found: dict[str, Any]) -> None:
    probed = found["probed"]
    assert probed["static penetration under its weight"] == 0.0
    # what is solved to round-off is held to round-off, of a velocity of a tenth of a metre a second
    assert probed["creep of the rim"] < 1e-15
    assert probed["rebound over impact"] < 1e-12
    # its gyroscopic term is explicit, which gains
    assert probed["energy gained"] > 0.0


def test_the_command_line_runs_it(target: Path) -> None:
    words = ["run", "gentle-rock", "--engine", "strict", "--timestep", "1e-3", "--json"]
    done = subprocess.run(  # noqa: S603 - our own words
        [sys.executable, "-c", "from harness.cli import main; main()", *words],
        env=script_environment(target),
        capture_output=True,
        check=False,
        encoding="utf-8",
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["engine"] == "strict"
    assert answer["outcome"].startswith("finished")
