"""What is foreseen of a run's end saves looks at it and steps past it."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.engines.registry import engine
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.physics_engine import SHORTEST, HorizonPrediction
from harness.engines.stepping.recording import Chunk
from models import Horizon, load
from tests.support.engines import DOUBLE

GENTLE = load("gentle-rock")
SHORT = SHORTEST * natural_time(GENTLE)
STEP = 1e-5
"""s: fine enough for a bounce to give back what it takes, so that a rise is as long as its fall."""


def rock(start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Return times and the tilt, which falls for a second and rises for a second."""
    time = np.linspace(start, end, 21)
    return time, GENTLE.release.phi * (0.1 + 0.9 * (time - 1.0) ** 2)


def test_of_nothing_the_shortest_is_foreseen() -> None:
    assert HorizonPrediction(GENTLE).ahead() == SHORT


def test_while_it_falls_the_rise_is_still_to_come() -> None:
    prediction = HorizonPrediction(GENTLE)
    prediction.see(*rock(0.0, 0.2))
    assert prediction.ahead() == pytest.approx(0.2)
    prediction.see(*rock(0.21, 0.8))
    assert prediction.ahead() == pytest.approx(0.8)


def test_a_rise_takes_as_long_as_the_fall() -> None:
    prediction = HorizonPrediction(GENTLE)
    prediction.see(*rock(0.0, 0.8))
    prediction.see(*rock(0.9, 1.3))  # a sample lies at the valley itself
    # 0.7 s are left, what the can took to fall visibly, and a little more to be sure
    assert 0.74 < prediction.ahead() < 0.76
    prediction.see(*rock(1.31, 1.9))
    assert 0.14 < prediction.ahead() < 0.16
    prediction.see(*rock(1.91, 2.5))  # it rises longer than it fell
    assert prediction.ahead() == SHORT


def test_the_fall_after_a_rise_counts_from_the_top() -> None:
    prediction = HorizonPrediction(GENTLE)
    prediction.see(*rock(0.0, 1.5))
    time, falling = rock(0.0, 1.0)
    prediction.see(time + 2.0, falling)
    prediction.see(time + 3.01, falling[::-1])
    assert prediction.ahead() <= 1.02 * 1.1  # not the whole run since the release


def test_a_run_ends_when_the_rise_is_seen_to_be_over() -> None:
    prediction = HorizonPrediction(GENTLE)
    prediction.see(*rock(0.0, 0.8))
    prediction.see(*rock(0.9, 1.9))
    time, falling = rock(0.0, 0.01)
    prediction.see(time + 2.0, falling)
    # at the release it took 0.01 s to see that it fell, in samples 0.04 s apart
    assert 0.02 < prediction.ahead() < 0.04


def test_a_fall_that_shows_late_tells_nothing_of_the_next() -> None:
    prediction = HorizonPrediction(GENTLE)
    time = np.linspace(0.0, 1.0, 21)
    slow = GENTLE.release.phi * (1.0 - 0.015 * time)
    prediction.see(time, slow)
    prediction.see(time + 1.0, slow[::-1])
    prediction.see(time[:3] + 2.05, slow[1:4])
    # a tenth of a second since the top, of a fall of a second that took 0.7 s to be seen
    assert prediction.ahead() == pytest.approx(0.05)


def test_an_end_in_time_needs_no_foresight() -> None:
    assert HorizonPrediction(replace(GENTLE, horizon=Horizon(seconds=1.0))).ahead() == np.inf


@pytest.mark.parametrize("name", DOUBLE)
@pytest.mark.parametrize("scene", ["gentle-rock", "paper-release", "wobble"])
def test_few_chunks_and_few_steps_in_vain(
    name: str, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = engine(name)
    case = Case(scene=load(scene), engine=name, timestep=STEP)
    taken: list[int] = []
    original = chosen.chunks  # type: ignore[attr-defined]

    def counted(*given: object) -> object:
        for chunk in original(*given):
            taken.append(steps(chunk))
            yield chunk

    monkeypatch.setattr(chosen, "chunks", counted)
    run = chosen.simulate(case)
    # less than a tenth of a run in vain, or than the shortest look
    assert sum(taken) - run.steps <= max(0.1 * run.steps, 1.1 * SHORT / STEP)
    # a fall is cut at each doubling, a rise in two; then it is looked for the end
    assert len(taken) <= 12 + 8 * (case.scene.horizon.bounces or 1)


def steps(chunk: Chunk) -> int:
    """Return the steps of a chunk."""
    return len(chunk.times) if chunk.spans is None else int(chunk.spans.sum())
