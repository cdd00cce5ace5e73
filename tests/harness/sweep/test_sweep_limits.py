"""Numbers that messages and docstrings cite of sweeps and their figures, inside and outside each.

They are written out here and not imported: whoever changes one in the code is told.
"""

import numpy as np
import pandas as pd
import pytest

from harness.core.errors import InvalidSettingError
from harness.sweep.drawing import Curves, Map
from harness.sweep.plan import SweepPlan
from harness.sweep.values import SOURCES
from tests.support.sweeps import make_plan


def test_a_sweep_has_a_billion_scenes_at_most() -> None:
    def of(count: int) -> SweepPlan:
        return make_plan("gentle-rock", f"release.psi_dot=0.5:2:{count}")

    assert of(1_000_000_000).rows == 1_000_000_000
    with pytest.raises(InvalidSettingError) as caught:
        of(1_000_000_001)
    assert "1000000000" in caught.value.allowed


def test_an_unknown_derivative_is_answered_with_those_of_its_quantity() -> None:
    with pytest.raises(InvalidSettingError) as caught:
        make_plan("gentle-rock", "release.psi_dot=1:2:2", quantities=("d_period_s/d_release.fi",))
    assert "d_period_s/d_release.phi" in caught.value.allowed.split(", ")
    assert all(name.startswith("d_period_s/") for name in caught.value.allowed.split(", "))


def test_a_partition_has_32768_exact_bounces_or_256_runs() -> None:
    axis = "release.psi_dot=0.5:2:99999"
    assert make_plan("gentle-rock", axis).rows_per_partition == 32_768
    runs = make_plan("gentle-rock", axis, engine="mujoco", timestep=1e-3)
    assert runs.rows_per_partition == 256


@pytest.mark.parametrize(
    ("scenes", "rows"), [(99_999, 32_768), (6_400_000, 100_000), (1_000_000_000, 1_048_576)]
)
def test_a_reduced_sweep_has_enough_partitions_to_lose_one(scenes: int, rows: int) -> None:
    axes = ("release.psi_dot=0.5:2", "release.phi=0.1:0.2")
    plan = make_plan("gentle-rock", *axes, sample="random", count=scenes, reduce=True)
    assert plan.rows_per_partition == rows
    slow = make_plan(
        "gentle-rock",
        *axes,
        sample="random",
        count=scenes,
        reduce=True,
        quantities=("d_period_s/d_can.h",),
    )
    assert slow.rows_per_partition == 2048


def test_kernels_are_compiled_from_a_hundred_thousand_scenes_on() -> None:
    few, many = (make_plan("gentle-rock", f"release.psi_dot=1:2:{n}") for n in (99_999, 100_000))
    assert (few.compiled, many.compiled) == (False, True)
    assert many.rows_per_partition == 65_536
    assert "numba" in dict(many.program)
    assert "numba" not in dict(few.program)


@pytest.mark.parametrize(("count", "cells"), [(399, 399), (400, 400), (401, 400)])
def test_a_map_has_four_hundred_cells_across(count: int, cells: int) -> None:
    plan = make_plan("gentle-rock", f"release.psi_dot=1:2:{count}", "release.theta_dot=1:2:3")
    assert Map(plan).image(plan.quantities[0]).shape == (3, cells)


@pytest.mark.parametrize(("scenes", "cells"), [(199, 9), (200, 10), (201, 10)])
def test_a_cell_has_two_scenes_of_a_sample(scenes: int, cells: int) -> None:
    axes = ("release.psi_dot=1:2", "release.theta_dot=1:2")
    plan = make_plan("gentle-rock", *axes, sample="random", count=scenes, seed=1)
    assert Map(plan).image(plan.quantities[0]).shape == (cells, cells)


def curves(plan: SweepPlan, values: np.ndarray) -> Curves:
    """Return curves of quantities that all have these values."""
    found = Curves(plan, None)
    columns = dict.fromkeys(plan.quantities, values)
    place = np.arange(len(values), dtype=float)
    found.add(pd.DataFrame(columns | {plan.axes[0].column: place}))
    return found


@pytest.mark.parametrize(("names", "panels"), [(5, 5), (6, 6), (7, 6)])
def test_six_quantities_are_drawn(names: int, panels: int) -> None:
    asked = tuple(SOURCES)[:names]
    plan = make_plan(
        "gentle-rock", "release.psi_dot=1:2:4", engine="mujoco", timestep=1e-3, quantities=asked
    )
    assert len(plan.quantities) == names
    assert len(curves(plan, np.ones(4)).figure().panels) == panels


@pytest.mark.parametrize(("scenes", "points"), [(20_000, 20_000), (20_001, 10_001)])
def test_a_curve_has_twenty_thousand_points(scenes: int, points: int) -> None:
    plan = make_plan("gentle-rock", f"release.psi_dot=1:2:{scenes}")
    x, _ = curves(plan, np.ones(scenes)).curve(plan.quantities[0])
    assert len(x) == points


@pytest.mark.parametrize(("largest", "log"), [(99.9, False), (100.1, True)])
def test_from_two_decades_on_an_axis_is_logarithmic(largest: float, *, log: bool) -> None:
    plan = make_plan("gentle-rock", "release.psi_dot=1:2:3")
    (panel, *_) = curves(plan, np.array([1.0, 2.0, largest])).figure().panels
    assert panel.log_y is log
