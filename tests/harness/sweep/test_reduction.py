"""Sweeps without rows: what is kept is what rows say, resumed, refused, the same to the bit."""

import json
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import code_of
from harness.core.errors import InvalidSettingError
from harness.execution.isolated_pool import SerialExecutor
from harness.sweep.drawing import drawing_of
from harness.sweep.folder import PartitionError, RowsMismatchError, opened
from harness.sweep.overview import overview
from harness.sweep.partition import compute
from harness.sweep.plan import SweepPlan
from harness.sweep.reduction import Reduction, merged, reduced, reduction_of
from harness.sweep.run import run_sweep
from tests.support.sweeps import carried_out, make_plan

pytestmark = pytest.mark.usefixtures("small_partitions")

AXES = ("release.psi_dot=-1:1:15", "release.theta_dot=-1:1:15")
"""Of a grid of 225 releases in partitions of 50; that at rest falls flat."""


@pytest.fixture
def plan() -> SweepPlan:
    """Return a sweep without rows."""
    return make_plan("paper-release", *AXES, reduce=True)


def test_a_reduction_says_what_the_rows_say(tmp_path: Path, plan: SweepPlan) -> None:
    table = carried_out(tmp_path / "rows", make_plan("paper-release", *AXES)).set_index("row")
    with opened(tmp_path / "reduced", plan) as folder:
        run_sweep(folder, SerialExecutor())
        whole = merged(plan, folder.read(), drawing_of(plan))
    assert (whole.start, whole.stop) == (0, 225)
    assert whole.outcomes == table["outcome"].astype(str).value_counts().to_dict()
    assert len(whole.outcomes) > 1
    for extent in whole.extents:
        column = table[extent.name].dropna()
        assert extent.count == len(column) < 225
        assert (extent.low, extent.high) == (column.min(), column.max())
        assert table.loc[extent.low_row, extent.name] == column.min()
        assert table.loc[extent.high_row, extent.name] == column.max()
        # sums of 224 numbers in another order
        size = column.abs().max() * len(column) * np.finfo(float).eps
        assert extent.mean == pytest.approx(column.mean(), rel=0, abs=size)
        assert extent.deviation == pytest.approx(column.std(ddof=0), rel=1e-13, abs=size)
        for share in (0.0, 0.01, 0.3, 0.5, 0.99):
            low, high = extent.quantile(share)
            assert low <= np.sort(column)[int(share * len(column))] <= high
        assert extent.even.counts.sum() == len(column)


def test_infinite_values_are_counted_and_change_no_other_number(plan: SweepPlan) -> None:
    part = compute(plan, plan.span(0))
    name = plan.quantities[0]
    wild = part.copy()
    wild.loc[[3, 5, 7], name] = [np.inf, -np.inf, np.nan]
    tame = part.copy()
    tame.loc[[3, 5, 7], name] = np.nan
    drawing = drawing_of(plan)
    one, other = (reduction_of(plan, each, drawing).extents[0] for each in (wild, tame))
    assert (one.infinite, other.infinite) == (2, 0)
    assert (one.count, one.total, one.squares) == (other.count, other.total, other.squares)
    assert (one.low, one.low_row) == (other.low, other.low_row)
    assert (one.high, one.high_row) == (other.high, other.high_row)
    assert np.isfinite(one.deviation)
    assert one.quantile(0.5) == other.quantile(0.5)
    halves = [reduction_of(plan, wild[:25], drawing), reduction_of(plan, wild[25:], drawing)]
    assert merged(plan, halves, drawing_of(plan)).extents[0].infinite == 2


def test_the_figure_is_that_of_the_rows(plan: SweepPlan) -> None:
    rows = make_plan("paper-release", *AXES)
    spans = [plan.span(index) for index in range(plan.partitions)]
    from_rows = overview(rows, (compute(rows, span) for span in spans)).figure
    without = overview(plan, [reduced(plan, span) for span in reversed(spans)]).figure
    for one, other in zip(from_rows.panels, without.panels, strict=True):
        assert one.heat is not None
        assert other.heat is not None
        assert np.array_equal(one.heat.z, other.heat.z, equal_nan=True)
        assert np.isfinite(one.heat.z).sum() > 200


@pytest.mark.parametrize("sample", ["grid", "random"])
def test_the_order_of_the_partitions_changes_no_bit(tmp_path: Path, sample: str) -> None:
    over = AXES if sample == "grid" else [text.removesuffix(":15") for text in AXES]
    chosen = {} if sample == "grid" else {"sample": sample, "count": 225, "seed": 4}
    plan = make_plan("paper-release", *over, reduce=True, **chosen)
    parts = [reduced(plan, plan.span(index)) for index in range(plan.partitions)]

    def content(order: list[int]) -> bytes:
        out = tmp_path / "-".join(map(str, order))
        whole = merged(plan, [parts[index] for index in order], drawing_of(plan))
        with opened(out, plan) as folder:
            folder.write(whole)
        (path,) = folder.parts.iterdir()
        return path.read_bytes()

    assert content([0, 1, 2, 3, 4]) == content([3, 0, 4, 2, 1])


def test_a_second_start_does_what_is_missing(tmp_path: Path, plan: SweepPlan) -> None:
    starts: list[int] = []
    with opened(tmp_path, plan) as folder:
        run_sweep(folder, SerialExecutor())
        paths = sorted(folder.parts.iterdir())
        paths[1].unlink()
        paths[3].write_bytes(paths[3].read_bytes()[:-1])
        with pytest.raises(PartitionError):
            list(folder.read())

        def note(part: Reduction) -> None:
            starts.append(part.start)

        run_sweep(folder, SerialExecutor(), note)
        assert starts == [50, 150]
        assert sorted(folder.parts.iterdir()) == paths


def test_rows_and_reductions_never_meet(tmp_path: Path, plan: SweepPlan) -> None:
    rows = make_plan("paper-release", *AXES)
    for one, other, words in ((rows, plan, "with rows"), (plan, rows, "with --reduce")):
        out = tmp_path / words
        with opened(out, one):
            pass
        with pytest.raises(RowsMismatchError, match=words), opened(out, other):
            pass


def test_only_the_exact_bounce_is_reduced() -> None:
    with pytest.raises(InvalidSettingError, match="--reduce"):
        make_plan("paper-release", *AXES, engine="mujoco", timestep=1e-3, reduce=True)


def test_a_thousand_million_scenes_are_planned_by_their_numbers() -> None:
    plan = make_plan(
        "paper-release",
        *(text.removesuffix(":15") for text in AXES),
        sample="random",
        count=1_000_000_000,
        reduce=True,
    )
    last = plan.span(plan.partitions - 1)
    assert last.stop == 1_000_000_000
    assert len(reduced(plan, last[:20])) == 20


def test_the_command_keeps_summaries_and_draws_from_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    over = [word for text in AXES for word in ("--over", text)]
    command = ["sweep", "paper-release", *over, "--reduce", "--jobs", "1", "--out", str(tmp_path)]
    assert code_of([*command, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["reduced"] is True
    assert len(list((tmp_path / "reduced").iterdir())) == 5
    assert not list((tmp_path / "parts").glob("*"))
    turn = answer["quantities"]["angle_of_turn_deg"]
    assert turn["least"] <= turn["p1"] <= turn["p50"] <= turn["p99"] <= turn["largest"]
    assert "Least or largest" in (tmp_path / "report" / "columns.md").read_text()
    assert code_of([*command, "--against", "period_s"]) == 2
    assert "leave out --against or --reduce" in capsys.readouterr().err
