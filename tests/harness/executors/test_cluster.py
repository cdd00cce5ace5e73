"""A Dask cluster: refusals that say the fix; the rest is the trial of the lost worker."""

from pathlib import Path

import pytest

from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.execution.dask_cluster import (
    DaskExecutor,
    LostSchedulerError,
    NoSchedulerError,
    check_cluster_address,
    dask_executor,
)
from harness.execution.limits import NO_LIMITS
from tests.faults.workers import lost_worker


def test_without_a_scheduler_it_says_how_to_start_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("harness.execution.dask_cluster._PATIENCE", 0.5)
    with pytest.raises(NoSchedulerError) as caught:
        dask_executor("tcp://127.0.0.1:1", NO_LIMITS)
    assert caught.value.address == "tcp://127.0.0.1:1"


@pytest.mark.parametrize(
    "address",
    ["nonsense", "", "tcp://host", "host:", "host:0", "host:65536", "tcp://a b:1", "http://a:1"],
)
def test_what_is_no_address_is_refused_before_anything_is_tried(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.import_module", lambda name: pytest.fail(f"{name} is wanted"))
    with pytest.raises(InvalidSettingError) as caught:
        dask_executor(address, NO_LIMITS)
    assert (caught.value.name, caught.value.value) == ("--on", address)


@pytest.mark.parametrize(
    "address",
    ["host:8786", "tcp://127.0.0.1:1", "tls://node-1.site.org:65535", "tcp://[fe80::1%eth0]:8786"],
)
def test_an_address_of_any_kind_is_taken(address: str) -> None:
    check_cluster_address(address)


class Gone:
    """The client of a scheduler that no longer answers."""

    def nthreads(self) -> None:
        """Find nobody."""
        raise TimeoutError("timed out")

    def submit(self, *_: object, **__: object) -> None:
        """Find the line cut."""
        raise ConnectionError("the line is cut")


def test_a_scheduler_that_no_longer_answers_is_said_to_be_gone() -> None:
    executor = DaskExecutor(Gone(), NO_LIMITS)
    for ask, reason in (
        (lambda: executor.submit(int), "the line is cut"),
        (lambda: executor.window, "timed out"),
    ):
        with pytest.raises(LostSchedulerError) as caught:
            ask()
        assert caught.value.reason == reason


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr("importlib.import_module", missing)
    with pytest.raises(MissingPackageError) as caught:
        dask_executor("tcp://127.0.0.1:1", NO_LIMITS)
    assert (caught.value.part, caught.value.package) == ("'--on'", "distributed")
    assert caught.value.install.endswith("pip install 'rockingcan[cluster]'")


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # those of the cluster's own threads are not ours
def test_a_worker_is_lost_and_nothing_with_it(tmp_path: Path) -> None:
    trial = lost_worker(tmp_path, lambda _: None)
    assert trial.passed, trial.found
