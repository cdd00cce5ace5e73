"""A folder of a sweep: resumed, refused, mended, and the same to the byte whoever fills it."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pandas as pd
import pytest

from harness.core.errors import OutputError
from harness.core.writing import ForeignFolderError, WriteError
from harness.execution.isolated_pool import SerialExecutor, local_executor
from harness.sweep.folder import PartitionError, PlanMismatchError, UnreadablePlanError, opened
from harness.sweep.plan import SweepPlan
from harness.sweep.run import run_sweep
from tests.support.examples import evenly
from tests.support.sweeps import carried_out, contents, make_plan, table

pytestmark = pytest.mark.usefixtures("small_partitions")


class Stopped(Exception):  # noqa: N818 - stands for a signal
    """The sweep is stopped."""


def test_a_second_start_does_what_is_missing_and_nothing_else(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    carried_out(tmp_path / "whole", sweep_of_225)
    made: list[int] = []

    def stop(part: pd.DataFrame) -> None:
        made.append(part.index[0] // 50)
        if len(made) == 2:
            raise Stopped

    out = tmp_path / "resumed"
    with opened(out, sweep_of_225) as folder, pytest.raises(Stopped):
        run_sweep(folder, SerialExecutor(), stop)
    assert len(contents(out)) == 2
    with opened(out, sweep_of_225) as folder:
        assert folder.missing() == [2, 3, 4]
        run_sweep(folder, SerialExecutor(), lambda part: made.append(part.index[0] // 50))
    assert made == [0, 1, 2, 3, 4]
    assert contents(out) == contents(tmp_path / "whole")
    with opened(out, sweep_of_225) as folder:
        run_sweep(folder, SerialExecutor(), lambda part: pytest.fail(f"{part} was made again"))


def file_of(out: Path, index: int) -> Path:
    """Return the file of a partition."""
    (path,) = (out / "parts").glob(f"part-{index:06d}-*")
    return path


@pytest.mark.parametrize("damage", ["cut short", "emptied", "of another sweep", "a folder"])
def test_a_damaged_partition_is_set_aside_and_made_again(
    sweep_of_225: SweepPlan, tmp_path: Path, damage: str
) -> None:
    out = tmp_path / "out"
    carried_out(out, sweep_of_225)
    before = contents(out)
    victim = file_of(out, 3)
    content = victim.read_bytes()
    if damage == "cut short":
        victim.write_bytes(content[: len(content) // 2])
    elif damage == "emptied":
        victim.write_bytes(b"")
    elif damage == "a folder":
        victim.unlink()
        victim.mkdir()
    else:
        other = make_plan("petals", "release.psi_dot=1:3:15", "release.theta_dot=-2:0:15")
        carried_out(tmp_path / "other", other)
        victim.write_bytes(file_of(tmp_path / "other", 3).read_bytes())
    with opened(out, sweep_of_225) as folder:
        assert folder.missing() == [3]
        assert [path.name for path in folder.damaged] == [victim.name]
        run_sweep(folder, SerialExecutor())
    assert contents(out) == before


def test_no_bit_of_a_partition_can_change_unseen(sweep_of_225: SweepPlan, tmp_path: Path) -> None:
    out = tmp_path / "out"
    carried_out(out, sweep_of_225)
    victim = file_of(out, 0)
    whole = victim.read_bytes()
    with opened(out, sweep_of_225) as folder:
        for place in evenly(range(0, len(whole), 7)):  # all regions of the file, all bits of a byte
            hurt = bytearray(whole)
            hurt[place] ^= 1 << place % 8
            victim.write_bytes(hurt)
            with pytest.raises(PartitionError) as caught:
                list(folder.read())
            assert (caught.value.parts, caught.value.index) == (folder.parts, 0)
            if place % 700 == 0:  # that which reads is that which sets aside
                assert folder.missing() == [0]
        victim.write_bytes(whole)
        assert folder.missing() == []
        assert sum(map(len, folder.read())) == 225


def test_a_partition_that_is_there_twice_counts_once(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    whole = carried_out(out, sweep_of_225)
    before = contents(out)
    sound = file_of(out, 3)
    twin = sound.with_name(f"{sound.stem[:-32]}{'f' * 32}.parquet")
    twin.write_bytes(sound.read_bytes())
    with opened(out, sweep_of_225) as folder:
        with pytest.raises(PartitionError) as caught:
            list(folder.read())
        assert caught.value.index == 3
        assert folder.missing() == []
        assert [path.name for path in folder.damaged] == [twin.name]
    assert contents(out) == before
    assert table(out).equals(whole)


def test_another_sweep_is_refused_and_the_difference_named(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    carried_out(out, sweep_of_225)
    before = contents(out)
    other = make_plan("gentle-rock", "release.psi_dot=1:3:16", "release.theta_dot=-2:0:15")
    with pytest.raises(PlanMismatchError) as caught:
        opened(out, other).__enter__()
    assert caught.value.out == out
    assert "release.psi_dot=1.0:3.0:15" in caught.value.differing
    third = make_plan("petals", "release.psi_dot=1:3:15", "release.theta_dot=-2:0:15")
    with pytest.raises(PlanMismatchError) as caught:
        opened(out, third).__enter__()
    assert "the scene" in caught.value.differing
    assert contents(out) == before


@pytest.mark.parametrize(
    ("name", "error"),
    [("", WriteError), ("thesis.tex", ForeignFolderError), ("sweep.json", UnreadablePlanError)],
    ids=["a file", "a folder of others", "a broken plan"],
)
def test_what_is_no_sweep_is_left_alone(
    sweep_of_225: SweepPlan, tmp_path: Path, name: str, error: type[OutputError]
) -> None:
    out = tmp_path / "out"
    if name:
        out.mkdir()
    (out / name).write_text("mine")
    with pytest.raises(error):
        opened(out, sweep_of_225).__enter__()
    left = out if out.is_file() else next(out.iterdir())
    assert left.read_text() == "mine"


@pytest.mark.slow
def test_reading_leaves_no_thread_that_could_outlive_the_program(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    carried_out(tmp_path / "out", sweep_of_225)
    program = f"""
import sys
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parents[3])!r})
from harness.sweep import plan
from harness.sweep.axes import read_axis
from harness.sweep.folder import opened
from harness.sweep.plan import plan_sweep
from models import load
plan.EXACT_ROWS = 50
axes = [read_axis(f"release.{{name}}:15") for name in ("psi_dot=1:3", "theta_dot=-2:0")]
chosen = plan_sweep(load("gentle-rock"), axes)


def threads():
    names = [place.read_text() for place in Path("/proc/self/task").glob("*/comm")]
    return len([name for name in names if not name.startswith("jemalloc")])  # it runs no Python


before = threads()
with opened(Path({str(tmp_path / "out")!r}), chosen) as folder:
    assert folder.missing() == []
    assert sum(map(len, folder.read())) == 225
print(threads() - before)
"""
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "0\n"


def test_a_draft_that_a_killed_sweep_left_goes(sweep_of_225: SweepPlan, tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "parts").mkdir(parents=True)
    draft = out / "parts" / ".part-000000-0.parquet.draft"
    draft.write_bytes(b"half")
    carried_out(out, sweep_of_225)
    assert not draft.exists()


def test_a_partition_that_cannot_be_written_is_said_and_leaves_nothing(
    sweep_of_225: SweepPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_handle: int) -> None:
        raise OSError(28, "No space left on device")

    out = tmp_path / "out"
    with opened(out, sweep_of_225) as folder, monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(WriteError) as caught:
            run_sweep(folder, SerialExecutor())
        assert caught.value.path.parent == out / "parts"
    assert list((out / "parts").iterdir()) == []
    carried_out(out, sweep_of_225)


@pytest.mark.slow
def test_threads_and_processes_make_the_same_bytes(sweep_of_225: SweepPlan, tmp_path: Path) -> None:
    runs = make_plan(
        "gentle-rock",
        "release.psi_dot=1.5:2.5",
        sample="random",
        count=8,
        engine="mujoco",
        timestep=2e-3,
        quantities=["angle_of_turn_deg", "angle_of_turn_error_deg"],
    )
    carried_out(tmp_path / "serial", sweep_of_225)
    with opened(tmp_path / "threads", sweep_of_225) as folder, ThreadPoolExecutor(3) as executor:
        run_sweep(folder, executor)
    assert contents(tmp_path / "threads") == contents(tmp_path / "serial")
    carried_out(tmp_path / "runs-serial", runs)
    with opened(tmp_path / "runs", runs) as folder, local_executor(2) as executor:
        run_sweep(folder, executor)
    assert contents(tmp_path / "runs") == contents(tmp_path / "runs-serial")


def test_the_plan_beside_the_table_says_what_it_is(sweep_of_225: SweepPlan, tmp_path: Path) -> None:
    carried_out(tmp_path / "out", sweep_of_225)
    told = json.loads((tmp_path / "out" / "sweep.json").read_text())
    assert told["digest"] == sweep_of_225.digest()
    assert told["plan"] == sweep_of_225.to_dict()
