"""Commands with `--on`: cases run on workers of a Dask cluster, and the results are the same."""

import importlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.execution.cache import CacheFolder
from harness.studies.effects.plan import FACTORS
from models import Horizon, load, write_scene
from tests.faults.journal_check import differing, differing_tables, whole
from tests.support.command_line import Command

# the warnings of a cluster's own threads are not ours
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("default")]


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of the scheduler of a cluster of one worker."""
    dask: Any = importlib.import_module("distributed")
    with dask.LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        local_directory=str(tmp_path_factory.mktemp("dask")),
    ) as machines:
        yield machines.scheduler_address


@pytest.fixture
def three_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the quick suite one scene and one timestep."""
    ladders = {"quick": {"gentle-rock": (1e-3,)}}
    # by their full names: the package has a function of the same name as one
    for name in ("study", "suite"):
        module = importlib.import_module(f"harness.studies.comparison.{name}")
        monkeypatch.setattr(module, "SUITES", ladders)


@pytest.mark.usefixtures("three_cases")
def test_validate_on_a_cluster_leaves_the_bits_of_a_run_here(
    rockingcan: Command, cluster: str, tmp_path: Path
) -> None:
    for place, words in (("here", ("--jobs", "1")), ("there", ("--on", cluster))):
        store, out = str(tmp_path / place / "store"), str(tmp_path / place / "out")
        answer = rockingcan(
            "validate", "--engine", "mujoco", *words, "--store", store, "--out", out
        )
        assert answer.code == 0, answer.err
    here, there = (CacheFolder(folder=tmp_path / n / "store") for n in ("here", "there"))
    assert whole(here) == whole(there) >= 3
    assert differing(here, there) == 0
    tables = [tmp_path / name / "out" / "tables" for name in ("here", "there")]
    assert sum(1 for _ in tables[0].glob("*.csv")) >= 3
    assert differing_tables(*tables) == 0


def test_a_sweep_on_a_cluster_leaves_the_bytes_of_one_here(
    rockingcan_process: Command, cluster: str, tmp_path: Path
) -> None:
    words = ["sweep", "gentle-rock", "--over", "release.psi_dot=1.5:2.5:5", "--engine", "mujoco"]
    words += ("--timestep", "4e-3", "--quantity", "angle_of_turn_deg", "--json")
    said = {}
    for place, more in (("here", ("--jobs", "1")), ("there", ("--on", cluster))):
        answer = rockingcan_process(*words, *more, "--out", str(tmp_path / place))
        assert answer.code == 0, answer.err
        said[place] = answer.json()
    assert said["here"].pop("parts") == str(tmp_path / "here" / "parts")
    assert said["there"].pop("parts") == str(tmp_path / "there" / "parts")
    parts = {
        place: {path.name: path.read_bytes() for path in (tmp_path / place / "parts").iterdir()}
        for place in said
    }
    assert parts["here"]
    assert parts["there"] == parts["here"]
    assert said["there"]["quantities"] == said["here"]["quantities"]
    assert said["there"]["scenes"] == 5


def test_effects_on_a_cluster_are_those_found_here(
    rockingcan_process: Command, cluster: str, tmp_path: Path
) -> None:
    brief = replace(load("slipping-rock"), horizon=Horizon(seconds=0.02))
    scene = tmp_path / "brief.toml"
    scene.write_text(write_scene(brief), encoding="utf-8")
    words = ["effects", str(scene), "--engine", "mujoco", "--timestep", "1e-3", "--no-store"]
    words += ("--assume", "tilt.angle=0.2", "--json")
    found = []
    for place, more in (("here", ("--jobs", "1")), ("there", ("--on", cluster))):
        answer = rockingcan_process(*words, *more, "--out", str(tmp_path / place))
        assert answer.code == 0, answer.err
        found.append(answer.json())
        assert (tmp_path / place / "index.html").is_file()
    for one in found:
        assert (one["scene"], one["declared"]) == (brief.name, list(brief.effects.declared()))
        assert list(one["engines"]) == ["reference", "mujoco"]
        assert all(list(effects) == list(FACTORS) for effects in one["engines"].values())
        # a plane that is tilted by 11 degrees is felt within 20 ms, and as the same by both
        for engine in ("reference", "mujoco"):
            tilt = one["engines"][engine]["tilt"]
            assert tilt["verdict"] == "missing"
            assert tilt["changes"]["y_end_m"] is not None
            # a ratio of processor times is another each time; that it was measured is not
            assert tilt.pop("cpu_ratio") > 0.0
        for effects in one["engines"].values():
            for effect in effects.values():
                effect.pop("cpu_ratio", None)
        one["sentences"] = len(one["sentences"])
    assert json.dumps(found[0]) == json.dumps(found[1])
