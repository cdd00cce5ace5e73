"""The plan in a sweep's folder: one to a folder, on the disk, and mended when it is damaged."""

import fcntl
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.sweep.folder import (
    PlanMismatchError,
    ProgramMismatchError,
    SweepBusyError,
    UnreadablePlanError,
    opened,
)
from harness.sweep.plan import SweepPlan, digest_of
from tests.support.sweeps import carried_out, contents, make_plan

pytestmark = pytest.mark.usefixtures("small_partitions")


def test_two_sweeps_do_not_share_a_folder(sweep_of_225: SweepPlan, tmp_path: Path) -> None:
    with (
        opened(tmp_path / "out", sweep_of_225),
        pytest.raises(SweepBusyError) as caught,
    ):
        opened(tmp_path / "out", sweep_of_225).__enter__()
    assert caught.value.out == tmp_path / "out"
    with opened(tmp_path / "out", sweep_of_225):  # the lock goes with its holder
        pass


def test_of_two_sweeps_begun_at_once_in_an_empty_folder_one_is_refused(
    sweep_of_225: SweepPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    other = make_plan("gentle-rock", "release.psi_dot=1:3:2")
    real = fcntl.flock

    def late(*words: Any) -> None:
        monkeypatch.setattr(fcntl, "flock", real)
        carried_out(out, other)  # from its first look at the folder to its last partition
        real(*words)

    monkeypatch.setattr(fcntl, "flock", late)
    with pytest.raises(PlanMismatchError):
        opened(out, sweep_of_225).__enter__()
    assert json.loads((out / "sweep.json").read_text())["digest"] == other.digest()
    assert [other.digest() in name for name in contents(out)] == [True]


@pytest.mark.parametrize("damage", ["emptied", "cut short", "a number changed"])
def test_a_plan_that_cannot_be_read_says_what_to_do_and_that_helps(
    sweep_of_225: SweepPlan, tmp_path: Path, damage: str
) -> None:
    out = tmp_path / "out"
    carried_out(out, sweep_of_225)
    (out / "report").mkdir()
    place = out / "sweep.json"
    whole = place.read_text()
    hurt = {"emptied": "", "cut short": whole[:99], "a number changed": whole.replace("15", "16")}
    place.write_text(hurt[damage])
    before = contents(out)
    with pytest.raises(UnreadablePlanError) as unreadable:
        opened(out, sweep_of_225).__enter__()
    assert unreadable.value.place == place
    assert place.read_text() == hurt[damage]
    place.unlink()
    # partitions without a plan are of another sweep for all others
    with pytest.raises(PlanMismatchError) as caught:
        opened(out, make_plan("petals", "release.psi_dot=1:3:15")).__enter__()
    assert "its partitions" in caught.value.differing
    with opened(out, sweep_of_225) as folder:
        assert folder.missing() == []
    assert place.read_text() == whole
    assert contents(out) == before


def test_a_plan_is_on_the_disk_before_it_has_its_name(
    sweep_of_225: SweepPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flushed: list[str] = []
    real = os.fsync

    def fsync(handle: int) -> None:
        flushed.append(Path(f"/proc/self/fd/{handle}").readlink().name)
        assert "sweep.json" not in flushed
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)
    with opened(tmp_path / "out", sweep_of_225):
        assert flushed[0].startswith(".sweep.json.")
        assert flushed[1:] == ["out"]


@pytest.mark.parametrize("part", ["sources", "numpy", "scipy"])
def test_a_sweep_that_another_program_began_is_not_gone_on_with(
    sweep_of_225: SweepPlan, tmp_path: Path, part: str
) -> None:
    out = tmp_path / "out"
    carried_out(
        out, replace(sweep_of_225, program=tuple({**dict(sweep_of_225.program), part: "0"}.items()))
    )
    before = contents(out)
    with pytest.raises(ProgramMismatchError) as caught:
        opened(out, sweep_of_225).__enter__()
    assert caught.value.differing.startswith(f"{part} 0 (now ")
    assert contents(out) == before
    (out / "sweep.json").unlink()
    with pytest.raises(PlanMismatchError) as mismatch:
        opened(out, sweep_of_225).__enter__()
    assert "its partitions" in mismatch.value.differing


def test_a_plan_that_does_not_say_which_program_began_it_is_refused(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    place = tmp_path / "out" / "sweep.json"
    place.parent.mkdir()
    told = sweep_of_225.to_dict()
    del told["program"]
    content = {"format": "rockingcan-sweep", "digest": digest_of(told), "plan": told}
    place.write_text(json.dumps(content))
    with pytest.raises(ProgramMismatchError) as caught:
        opened(place.parent, sweep_of_225).__enter__()
    assert caught.value.differing == "no word of which"


def _write_plan(out: Path, plan: dict[str, object]) -> None:
    out.mkdir()
    content = {"format": "rockingcan-sweep", "digest": digest_of(plan), "plan": plan}
    (out / "sweep.json").write_text(json.dumps(content))


def test_arrays_do_not_go_on_with_what_kernels_began_and_the_message_names_the_extra(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    program = (*sweep_of_225.program, ("numba", "0.60.0"))
    by_kernels = replace(sweep_of_225, program=program, compiled=True, rows_per_partition=75)
    for began, goes_on, words in (
        (by_kernels, sweep_of_225, "numba 0.60.0 (now none, without the extra fast)"),
        (sweep_of_225, by_kernels, "numba none, without the extra fast (now 0.60.0)"),
    ):
        out = tmp_path / str(began.compiled)
        _write_plan(out, began.to_dict())
        with pytest.raises(ProgramMismatchError) as caught:
            opened(out, goes_on).__enter__()
        assert caught.value.differing == words


def test_a_plan_of_before_there_were_kernels_is_one_of_another_program(
    sweep_of_225: SweepPlan, tmp_path: Path
) -> None:
    plan = sweep_of_225.to_dict()
    plan["program"] = {**plan["program"], "sources": "0"}
    del plan["compiled"], plan["reduce"]
    _write_plan(tmp_path / "out", plan)
    with pytest.raises(ProgramMismatchError) as caught:
        opened(tmp_path / "out", sweep_of_225).__enter__()
    assert caught.value.differing.startswith("sources 0 (now ")


@pytest.mark.parametrize("engine", ["reference", "mujoco"])
def test_the_program_of_a_plan_is_its_engines_and_that_of_sweeps(
    engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, ...]] = []

    def asking(*names: str) -> str:
        asked.append(names)
        return "0123456789abcdef"

    monkeypatch.setattr("harness.sweep.plan.code_fingerprint", asking)
    made = make_plan("gentle-rock", "release.psi_dot=1:3:2", engine=engine, quantities=["period_s"])
    assert dict(made.program)["sources"] == "0123456789abcdef"
    assert asked == [(engine, "harness.sweep.plan")]
    monkeypatch.undo()
    again = make_plan(
        "gentle-rock", "release.psi_dot=1:3:2", engine=engine, quantities=["period_s"]
    )
    assert again.digest() != made.digest()
