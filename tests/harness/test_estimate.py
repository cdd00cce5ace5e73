"""How long work will take: cases of costs that differ a thousandfold, on machines that differ."""

import json
import math
import random
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.core.case import Case
from harness.engines.reference.truth import truth
from harness.evaluation.effort import (
    expected_seconds,
    expected_steps,
    expected_timing,
    simulated_seconds,
)
from harness.execution.estimate import (
    FILE,
    Estimate,
    Expected,
    Taken,
    about,
    account,
    announcement,
    read_speeds,
    side_by_side,
    write_speeds,
)
from harness.execution.isolated_pool import SerialExecutor
from harness.paper.audit import CLAIMS
from harness.paper.gallery import FIGURES
from harness.progress import ItemBar
from harness.studies.stability.limits import foreseen_cases, next_round
from harness.studies.stability.suite import SUITES
from models.catalogue import load
from tests.usual_seconds import LONG, PLACE

EFFORTS = {
    f"task {n}": Expected("fast" if n % 2 else "slow", 10.0 ** (n % 4 - 2)) for n in range(40)
}
"""From a hundredth of a second to ten, in two groups."""

TRUE = {"fast": 0.5, "slow": 4.0}
"""Seconds that a group takes for one of effort on the machine of the test."""


def cost(name: str) -> float:
    return EFFORTS[name].effort * TRUE[EFFORTS[name].group]


WHOLE = sum(map(cost, EFFORTS))


def after(done: int, cores: int = 1, load: float = 1.0) -> tuple[Estimate, float]:
    """Return the estimate after some tasks, and what those that are left will take, s."""
    names = sorted(EFFORTS)
    random.Random(1).shuffle(names)  # noqa: S311 - no secret
    estimate = Estimate(cores)
    estimate.expect(EFFORTS)
    for name in names[:done]:
        estimate.finish(name, Taken(cost(name), load * cost(name)))
    return estimate, load * sum(map(cost, names[done:])) / cores


def test_before_anything_is_done_it_is_the_sum_of_the_efforts() -> None:
    estimate, _ = after(0)
    assert estimate.seconds == pytest.approx(sum(e.effort for e in EFFORTS.values()))
    assert estimate.tasks == len(EFFORTS)


@pytest.mark.parametrize("cores", [1, 4])
@pytest.mark.parametrize("load", [1.0, 3.0])
def test_after_a_quarter_it_is_right_within_a_factor_of_two(cores: int, load: float) -> None:
    estimate, left = after(10, cores, load)
    assert 0.5 < estimate.seconds / left < 2.0
    assert estimate.tasks == 30


def test_it_comes_nearer_as_more_is_done() -> None:
    off = [abs(e.seconds / left - 1.0) for e, left in map(after, (0, 10, 30))]
    assert off == sorted(off, reverse=True)


def test_groups_are_told_apart() -> None:
    estimate, _ = after(38)
    speeds = estimate.speeds()
    assert speeds["fast"] == pytest.approx(0.5, rel=0.2)
    assert speeds["slow"] == pytest.approx(4.0, rel=0.2)


def test_what_runs_alone_and_the_longest_are_not_shared_among_cores() -> None:
    estimate = Estimate(cores=4)
    estimate.expect({n: Expected("timing", 1.0, alone=True) for n in range(3)})
    assert estimate.seconds == pytest.approx(3.0)
    estimate.expect({n: Expected("runs", 8.0 if n == 0 else 1.0) for n in range(4)})
    assert estimate.seconds == pytest.approx(8.0)


def test_a_stored_or_lost_task_teaches_nothing_and_is_left_no_more() -> None:
    estimate = Estimate()
    estimate.expect({n: Expected("runs", 1.0) for n in range(3)})
    estimate.finish(0)
    estimate.finish("another")
    assert estimate.tasks == 2
    assert estimate.seconds == pytest.approx(2.0)
    assert estimate.speeds() == {}
    for n in (1, 2):
        estimate.finish(n, Taken(1.0, 1.0))
    assert estimate.seconds == 0.0


def test_what_an_earlier_run_found_is_known_at_once(tmp_path: Path) -> None:
    assert read_speeds(tmp_path) == {}
    write_speeds(tmp_path, TRUE)
    write_speeds(tmp_path, {"slow": 5.0})
    assert read_speeds(tmp_path) == {"fast": 0.5, "slow": 5.0}
    write_speeds(tmp_path, {"slow": math.inf})
    assert read_speeds(tmp_path) == {"fast": 0.5}
    estimate = Estimate(speeds=TRUE)
    estimate.expect(EFFORTS)
    assert estimate.seconds == pytest.approx(WHOLE)


@pytest.mark.parametrize("text", ["", "{", "[]", '{"x": 1}', "\x00"])
def test_a_broken_file_of_speeds_is_none(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text, encoding="utf-8")
    assert read_speeds(tmp_path) == {}
    write_speeds(tmp_path, TRUE)
    assert read_speeds(tmp_path) == TRUE


def test_the_words() -> None:
    assert announcement(200.0, 394, 2) == "about 3.3 min for 394 runs on 2 cores"
    assert announcement(12.3, 1, 1) == "about 12 s for 1 run"
    assert announcement(3.0, 50, 2) == ""
    assert account(1000.0, 700.0) == "took 17 min, estimated 12 min"
    assert account(11.0, 3.0) == "took 11 s, estimated 3 s"
    assert account(3.0, 2.0) == ""
    assert about(86_400.0) == "24 h"


def test_the_effort_of_a_case_follows_its_steps() -> None:
    scene = load("gentle-rock")
    coarse = Case(scene=scene, engine="mujoco", timestep=1e-4)
    fine = Case(scene=scene, engine="mujoco", timestep=1e-6)
    assert expected_steps(fine) == pytest.approx(100.0 * expected_steps(coarse))
    assert expected_steps(coarse) == pytest.approx(3473, rel=0.1)  # what the run takes
    assert expected_seconds(fine) > 10.0 * expected_seconds(coarse)
    assert expected_timing(fine) == pytest.approx(3.0 * expected_seconds(fine))
    own_steps = Case(scene=scene, engine="reference")
    assert expected_steps(own_steps) == 0.0
    assert expected_seconds(own_steps) == 0.1


@pytest.mark.parametrize("name", ["gentle-rock", "cusps", "slipping-rock", "wobble"])
def test_a_run_through_bounces_is_as_long_as_the_exact_motion(name: str) -> None:
    scene = load(name)
    assert scene.horizon.seconds is None
    assert simulated_seconds(scene) == truth(scene).ends


def test_a_search_foresees_the_rounds_after_the_next() -> None:
    suite = SUITES["quick"]
    foreseen = foreseen_cases(suite, ("mujoco",), {})
    first = next_round(suite, ("mujoco",), {})
    assert len(foreseen) > 2 * len(first)
    assert {case.scene.name for case in first} <= {case.scene.name for case in foreseen}


def test_usual_seconds_are_of_claims_and_figures_that_exist() -> None:
    known = json.loads(PLACE.read_text(encoding="utf-8"))
    assert set(known["audit"]) <= {claim.label for claim in CLAIMS}
    assert min(known["audit"].values()) >= LONG
    assert set(known["gallery"]) == {draw.__name__ for draw in FIGURES}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return the time that the bar reads, s, which a test moves."""
    now = [100.0]
    monkeypatch.setattr("harness.progress.time.monotonic", lambda: now[0])
    monkeypatch.setattr("harness.execution.estimate.current_load", lambda _: 1.0)
    return now


def test_a_bar_says_before_and_after_how_long_it_takes(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    with ItemBar({"one": 30.0, "two": 60.0}, "claim") as bar:
        bar.label("one")
        clock[0] += 40.0
        bar.advance("one")
        clock[0] += 60.0
        bar.advance("two")
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == ["about 90 s for 2 claims", "took 1.7 min, estimated 90 s"]


def test_a_cluster_is_as_wide_as_its_workers_and_the_load_here_says_nothing_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("harness.execution.estimate.current_load", lambda cores: 3.0 * cores)
    cluster = SimpleNamespace(workers=8, remote=True)
    assert side_by_side(cluster) == (8, 1.0)
    assert side_by_side(SimpleNamespace(workers=2)) == (2, 6.0)
    assert side_by_side(SerialExecutor()) == (1, 3.0)
    assert side_by_side(object(), 4) == (4, 12.0)


def test_a_short_work_and_a_failed_one_say_nothing_after(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    with ItemBar({"one": 3.0}, "claim") as bar:
        bar.label("one")
        clock[0] += 3.0
        bar.advance("one")
    assert capsys.readouterr().err == ""
    bar = ItemBar({"one": 30.0}, "claim")
    bar.label("one")
    bar.__exit__(KeyboardInterrupt, None, None)
    assert capsys.readouterr().err.splitlines() == ["about 30 s for 1 claim"]
