"""The runner: in order, each told once, and wrong use refused before anything runs."""

from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from harness.core.case import Case
from harness.core.errors import (
    HarnessError,
    InvalidSettingError,
    UnknownEngineError,
    UnknownSettingError,
    UnsupportedEffectError,
)
from harness.evaluation.run_cases import run_cases
from harness.execution.isolated_pool import (
    IsolatedProcessPool,
    SerialExecutor,
    local_executor,
)
from harness.studies.study import evaluation_jobs, run_study
from models import Effects, Horizon, Scene, Slip
from tests.harness.studies.test_study import Once

if TYPE_CHECKING:
    from harness.evaluation.evaluation import Evaluation


@pytest.fixture
def cases(brief: Scene) -> list[Case]:
    """Return short cases that differ in their timestep."""
    return [
        Case(scene=replace(brief, horizon=Horizon(seconds=2e-3)), engine="mujoco", timestep=dt)
        for dt in (1e-3, 5e-4, 2e-4, 1e-4)
    ]


def test_results_come_in_the_order_of_the_cases(cases: list[Case]) -> None:
    told: list[Evaluation] = []
    done = run_cases(cases, None, told.append)
    assert [e.simulation.case for e in done] == cases
    assert all(first is second for first, second in zip(told, done, strict=True))


class Backwards(Executor):
    """Runs what it was given when the last of four has come, the last first."""

    def __init__(self) -> None:
        self._waiting: list[tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Wait for the fourth."""
        assert not kwargs
        future: Future[Any] = Future()
        self._waiting.append((future, fn, args))
        if len(self._waiting) == 4:
            for one, call, given in reversed(self._waiting):
                one.set_result(call(*given))
        return future


@pytest.mark.parametrize(
    "executor",
    [Backwards(), ThreadPoolExecutor(1), SerialExecutor()],
    ids=lambda executor: type(executor).__name__,
)
def test_any_executor_keeps_the_order_and_tells_of_each_once(
    cases: list[Case], executor: Executor
) -> None:
    told: list[str] = []
    with executor:
        done = run_cases(cases, executor, lambda e: told.append(e.simulation.case.label()))
    assert [e.simulation.case for e in done] == cases
    assert sorted(told) == sorted(case.label() for case in cases)


def test_cases_of_a_scene_go_where_it_is_known(cases: list[Case]) -> None:
    other = replace(cases[1].scene, horizon=Horizon(seconds=3e-3))
    wanted, topics = [cases[0], replace(cases[1], scene=other)], []

    class Told(IsolatedProcessPool):
        def submit_about(
            self, topic: Hashable, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
        ) -> "Future[Any]":
            topics.append(topic)
            return super().submit_about(topic, fn, *args, **kwargs)

    with Told(2) as pool:
        assert [e.simulation.case for e in run_cases(wanted, pool)] == wanted
        run_study(Once(evaluation_jobs(wanted)), executor=pool)
    assert topics[:2] == [case.scene for case in wanted]
    assert set(topics[2:]) == {case.scene for case in wanted}  # the longest first


def test_no_case_is_no_result() -> None:
    assert run_cases([]) == ()


def wrong(brief: Scene) -> Sequence[tuple[Case, type[HarnessError]]]:
    """Return cases that are wrong use, with what they raise."""
    patch = replace(brief, effects=Effects(slip=Slip(mu=0.3, patch=1e-4)))
    return (
        (Case(scene=brief, engine="ode"), UnknownEngineError),
        (Case(scene=patch, engine="mujoco"), UnsupportedEffectError),
        (Case(scene=brief, engine="reference", timestep=1e-3), InvalidSettingError),
        (Case(scene=brief, engine="mujoco", options=(("glue", 1),)), UnknownSettingError),
        (Case(scene=brief, engine="mujoco", options=(("cone", "flat"),)), InvalidSettingError),
        (Case(scene=brief, engine="pybullet", options=(("cone", "x"),)), UnknownSettingError),
    )


@pytest.mark.parametrize("number", range(6))
def test_wrong_use_is_refused_before_anything_runs(
    cases: list[Case], brief: Scene, number: int
) -> None:
    bad, kind = wrong(brief)[number]
    told: list[Evaluation] = []
    with pytest.raises(kind):
        run_cases([*cases, bad], None, told.append)
    assert told == []


def test_an_executor_hands_on_what_a_task_raises() -> None:
    def fail() -> None:
        raise ZeroDivisionError("on purpose")

    future = SerialExecutor().submit(fail)
    with pytest.raises(ZeroDivisionError, match="on purpose"):
        future.result()
    assert SerialExecutor().submit(divmod, 7, 2).result() == (3, 1)


def test_one_job_is_this_process_and_two_are_a_pool() -> None:
    assert isinstance(local_executor(1), SerialExecutor)
    with local_executor(2) as pool:
        assert not isinstance(pool, SerialExecutor)
