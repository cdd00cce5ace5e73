"""Workers that would compute otherwise are refused: what differs is named, and where."""

import importlib
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from harness.core.engine_packages import ENGINE_ENTRY_POINTS
from harness.core.errors import UnknownEngineError
from harness.execution import dask_cluster
from harness.execution.dask_cluster import (
    LateWorkerError,
    NoEnvironmentError,
    UnfitWorkersError,
    _check,
    check_same_environment,
    dask_executor,
    environment_differences,
)
from harness.execution.limits import NO_LIMITS
from harness.execution.source_fingerprint import fingerprint

ROOT = Path(__file__).parents[3]
HERE = dask_cluster.environment_description()


@pytest.fixture
def anew() -> Iterator[None]:
    """Ask again what this process computes with, before a test and after."""
    dask_cluster.environment_description.cache_clear()
    yield
    dask_cluster.environment_description.cache_clear()


class Client:
    """The client of a cluster whose workers say what they are told to."""

    def __init__(self, *said: dict[str, str] | Exception) -> None:
        self._said = {f"tcp://node-{n}:1": what for n, what in enumerate(said)}

    def run(self, *_: object, **__: object) -> dict[str, dict[str, str] | Exception]:
        """Ask each worker."""
        return self._said


def test_workers_alike_are_taken() -> None:
    _check(Client(HERE, HERE), "host:1")


@pytest.mark.parametrize("key", ["sources of rockingcan", "mujoco", "pybullet", "Python"])
def test_a_worker_that_differs_is_named_with_what_differs(key: str) -> None:
    with pytest.raises(UnfitWorkersError) as caught:
        _check(Client(HERE, HERE | {key: "other"}), "host:1")
    (place,) = caught.value.workers
    assert (caught.value.address, place) == ("host:1", "tcp://node-1:1")
    assert caught.value.workers[place] == f"has {key} other (here {HERE[key]})"
    assert len(str(caught.value).splitlines()) == 1


def test_another_numpy_is_said_to_be_that_and_not_other_sources() -> None:
    other = HERE | {"numpy": "1.0", "sources of rockingcan": "follows from it"}
    assert environment_differences(other, HERE) == [f"numpy 1.0 (here {HERE['numpy']})"]


def test_a_worker_without_rockingcan_is_named() -> None:
    with pytest.raises(UnfitWorkersError) as caught:
        _check(Client(ModuleNotFoundError("No module named 'harness'")), "host:1")
    assert "ModuleNotFoundError" in caught.value.workers["tcp://node-0:1"]


@pytest.mark.usefixtures("anew")
def test_an_engine_of_somebody_else_that_both_have_must_be_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "somebodys.py"
    monkeypatch.syspath_prepend(str(tmp_path))
    entry = EntryPoint("theirs", "somebodys:Engine", ENGINE_ENTRY_POINTS)
    monkeypatch.setattr(dask_cluster, "entry_points", lambda **_: [entry])
    said = []
    for content in ("A = 1\n", "A = 2\n"):
        source.write_text(content, encoding="utf-8")
        fingerprint.cache_clear()
        dask_cluster.environment_description.cache_clear()
        said.append(dask_cluster.environment_description())
    (found,) = [words for words in environment_differences(*said) if "theirs" in words]
    assert found.startswith("engine theirs unknown ")
    without = {key: value for key, value in said[0].items() if key != "engine theirs"}
    assert (
        environment_differences(said[0], without) == []
    )  # what only the worker has is nobody's result


def test_a_task_is_not_done_by_a_worker_that_came_later_and_differs() -> None:
    assert check_same_environment(HERE, max, 1, 2) == 2
    with pytest.raises(LateWorkerError) as caught:
        check_same_environment(HERE | {"scipy": "0.0"}, max, 1, 2)
    assert caught.value.differences == (f"scipy {HERE['scipy']} (here 0.0)",)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # those of the cluster's own threads are not ours
def test_a_worker_with_an_edited_checkout_of_the_same_version_is_refused(tmp_path: Path) -> None:
    for package in ("harness", "models", "reference"):
        shutil.copytree(ROOT / package, tmp_path / package)
    edited = tmp_path / "harness" / "metrics" / "energy.py"
    edited.write_text(edited.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    dask: Any = importlib.import_module("distributed")
    with dask.LocalCluster(
        n_workers=0, dashboard_address=None, local_directory=str(tmp_path / "dask")
    ) as machines:
        address = machines.scheduler_address
        program = "import sys; from dask.__main__ import main; sys.exit(main())"
        words = ["worker", address, "--no-nanny", "--no-dashboard", "--nthreads", "1"]
        words += ["--local-directory", str(tmp_path / "worker")]
        worker = subprocess.Popen(  # noqa: S603 - the program of the cluster
            [sys.executable, "-c", program, *words], cwd=tmp_path, stderr=subprocess.DEVNULL
        )
        try:
            with dask.Client(address, set_as_default=False) as client:
                client.wait_for_workers(1, timeout=60)
            with pytest.raises(UnfitWorkersError) as caught:
                dask_executor(address, NO_LIMITS)
            (differences,) = caught.value.workers.values()
            assert differences.startswith("has sources of rockingcan ")
        finally:
            worker.terminate()
            worker.wait(30)


def unknown(name: str) -> None:
    """Fail as a case of an engine that is not there."""
    raise UnknownEngineError(name, ["mujoco"])


def test_an_engine_whose_environment_is_here_alone_is_named_with_the_machine() -> None:
    here = HERE | {"engine mine": "python 3.12.1, files 0123456789abcdef"}
    with pytest.raises(NoEnvironmentError) as caught:
        check_same_environment(here, unknown, "mine")
    assert (caught.value.engine, caught.value.node) == ("mine", platform.node())
    with pytest.raises(UnknownEngineError):
        check_same_environment(here, unknown, "nobody's")
