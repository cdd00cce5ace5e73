"""Evaluations that are kept have the bits of those that were made, times included."""

import math
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.errors import CacheWarning
from harness.core.simulation import Outcome
from harness.engines.reference.assumption_checks import Divergence
from harness.evaluation.case_cache import evaluation_cache
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from harness.evaluation.run_cases import failed_evaluation, run_cases
from harness.execution.cache import JOURNAL, CacheFolder
from harness.execution.cache_entry import Defect
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.tasks import ProgressListener, run_tasks
from harness.execution.worker import Loss, LostTaskError
from models import Effects, Scene, Slip, Tilt
from reference import Finding, FindingKind


def same(one: Any, other: Any) -> bool:
    """Whether two values have the same types and bits, all the way down."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    if is_dataclass(one):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float):
        return np.float64(one).tobytes() == np.float64(other).tobytes()
    return bool(one == other)


def cases(brief: Scene) -> list[Case]:
    """Return cases of every kind: engines, profiles, effects, none that has no trajectory."""
    slippery = replace(brief, effects=Effects(slip=Slip(mu=0.3)))
    return [
        Case(scene=brief, engine="mujoco", profile="default"),
        Case(scene=brief, engine="pybullet", timestep=1e-3),
        Case(scene=brief, engine="reference"),
        Case(scene=brief, engine="reference", options=(("model", "reduced"),)),
        Case(scene=slippery, engine="mujoco", timestep=1e-3, options=(("solref", (0.01, 1.0)),)),
    ]


def test_kept_is_made_bit_for_bit(brief: Scene, tmp_path: Path) -> None:
    store = CacheFolder(folder=tmp_path / "store")
    wanted = cases(brief)
    made = run_cases(wanted, store=store)
    done: list[Evaluation] = []
    kept = run_cases(wanted, None, done.append, store=store)
    begun = (store.folder / JOURNAL).read_text("utf-8").count('"begun"')
    assert begun == len(wanted)  # all of them the first time, and none the second
    assert len(done) == len(wanted)
    assert [e.simulation.case for e in kept] == wanted
    for one, other in zip(made, kept, strict=True):
        assert same(one, other)
    assert kept[0].simulation.wall_s == made[0].simulation.wall_s > 0.0


SAID = {
    "nothing": ((), None, None),
    "a finding": (
        (Finding(kind=FindingKind.PULL, sentence="It pulls.", model="coulomb"),),
        None,
        0.0,
    ),
    "two, and a motion that never parts": (
        (
            Finding(kind=FindingKind.ENDING, sentence="phi is ½π."),
            Finding(kind=FindingKind.CONE, sentence="µ is too small.", model="general"),
        ),
        Divergence(growth=1.0, lyapunov_time=math.inf, parted=math.inf, chaotic=False),
        None,
    ),
    "chaos": (
        (),
        Divergence(growth=1.1e5, lyapunov_time=0.1 + 0.2, parted=5.5, chaotic=True),
        math.nextafter(0.3, 1.0),
    ),
}


@pytest.mark.parametrize("said", SAID)
def test_what_is_said_of_the_truth_is_kept_bit_for_bit(
    brief: Scene, tmp_path: Path, said: str
) -> None:
    findings, chaos, parts_at = SAID[said]
    case = Case(scene=brief, engine="mujoco", timestep=1e-3)
    made = replace(evaluate(case), findings=findings, divergence=chaos, parts_at=parts_at)
    shelf = evaluation_cache(CacheFolder(folder=tmp_path / "store"))
    run_tasks([case], lambda _: made, SerialExecutor(), lost=failed_evaluation, cache=shelf)

    def runs_again(case: Case) -> Evaluation:
        raise AssertionError(case.label())

    (kept,) = run_tasks([case], runs_again, SerialExecutor(), lost=failed_evaluation, cache=shelf)
    assert kept is not made
    assert same(kept, made)


def test_a_real_finding_and_a_real_divergence_are_kept(brief: Scene, tmp_path: Path) -> None:
    tilted = replace(brief, effects=Effects(tilt=Tilt(angle=0.1)))
    sunk = replace(brief, release=replace(brief.release, height=-1e-6))
    store = CacheFolder(folder=tmp_path / "store")
    wanted = [Case(scene=scene, engine="pybullet", timestep=1e-3) for scene in (tilted, sunk)]
    made = run_cases(wanted, store=store)
    assert made[0].divergence is not None
    assert made[1].findings[0].kind is FindingKind.REFUSED
    assert all(map(same, made, run_cases(wanted, store=store)))


def test_a_broken_one_is_run_again_and_the_rest_is_not(brief: Scene, tmp_path: Path) -> None:
    store, wanted = CacheFolder(folder=tmp_path / "store"), cases(brief)[:3]
    made = run_cases(wanted, store=store)
    shelf = evaluation_cache(store)
    path = store.path(shelf.kind, shelf.key(wanted[1]))
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.warns(CacheWarning, match=Defect.CUT_SHORT.value):
        again = run_cases(wanted, store=store)
    assert same(made[0], again[0])
    assert same(made[2], again[2])
    assert made[1].simulation.wall_s != again[1].simulation.wall_s
    assert same(made[1].motion, again[1].motion)


@pytest.mark.parametrize("loss", Loss)
def test_crashes_are_kept_and_what_was_stopped_is_tried_again(
    brief: Scene, tmp_path: Path, loss: Loss
) -> None:
    case = Case(scene=brief, engine="mujoco")
    shelf = evaluation_cache(CacheFolder(folder=tmp_path / "store"))

    def dies(case: Case) -> Evaluation:
        raise LostTaskError(loss, f"killed: {case.engine}")

    found = run_tasks([case], dies, SerialExecutor(), lost=failed_evaluation, cache=shelf)[0]
    assert found.simulation.outcome.name == loss.name
    assert found.simulation.note == "killed: mujoco"
    kept: list[int] = []
    again = run_tasks(
        [case],
        evaluate,
        SerialExecutor(),
        lost=failed_evaluation,
        cache=shelf,
        listener=ProgressListener(kept=lambda count, _: kept.append(count)),
    )[0]
    crashed = loss is Loss.CRASHED
    assert kept == [int(crashed)]
    assert again.simulation.outcome is (Outcome.CRASHED if crashed else Outcome.FINISHED)
