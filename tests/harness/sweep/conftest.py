"""Small sweeps of the paper's can."""

from collections.abc import Callable, Iterable
from pathlib import Path

import pandas as pd
import pytest

from harness.execution.isolated_pool import SerialExecutor
from harness.sweep import plan
from harness.sweep.axes import read_axis
from harness.sweep.folder import opened
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.run import run_sweep
from models import load

Planned = Callable[..., SweepPlan]


@pytest.fixture
def planned() -> Planned:
    """Return a function that plans a sweep of a scene over axes as they are typed."""

    def make(scene: str, *over: str, **more: object) -> SweepPlan:
        return plan_sweep(load(scene), [read_axis(text) for text in over], **more)  # type: ignore[arg-type]

    return make


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut sweeps small, so that a few rows are many partitions."""
    monkeypatch.setattr(plan, "EXACT_ROWS", 50)
    monkeypatch.setattr(plan, "ENGINE_ROWS", 3)


@pytest.fixture
def chosen(planned: Planned) -> SweepPlan:
    """Return a sweep of 225 releases."""
    return planned("gentle-rock", "release.psi_dot=1:3:15", "release.theta_dot=-2:0:15")


def carried_out(out: Path, chosen: SweepPlan) -> pd.DataFrame:
    """Carry a sweep out here, one partition after the other, and return its table."""
    with opened(out, chosen) as folder:
        run_sweep(folder, SerialExecutor())
        return table(out)


def table(out: Path) -> pd.DataFrame:
    """Return the table of a sweep, as anybody reads it."""
    return pd.read_parquet(out / "parts")


def contents(out: Path) -> dict[str, bytes]:
    """Return the files of the partitions, to the byte."""
    return {path.name: path.read_bytes() for path in sorted((out / "parts").iterdir())}


def rows_of(parts: Iterable[pd.DataFrame]) -> int:
    """Return how many rows parts have."""
    return sum(map(len, parts))
