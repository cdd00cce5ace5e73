"""Sweeps carried out in this process, and what they left."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from harness.execution.isolated_pool import SerialExecutor
from harness.sweep.axes import read_axis
from harness.sweep.folder import opened
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.run import run_sweep
from models import load


def make_plan(scene: str, *over: str, **more: Any) -> SweepPlan:
    """Plan a sweep of a scene over axes as they are typed."""
    return plan_sweep(load(scene), [read_axis(text) for text in over], **more)


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
