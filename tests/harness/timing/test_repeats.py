"""How often a case is repeated where it is timed: the numbers that the docstrings cite."""

from itertools import count

import pytest

from harness.core.case import Case
from harness.evaluation import timing
from models import Scene


@pytest.mark.parametrize(
    ("looks", "repeats"),
    [
        # short ones nine times; after 0.08 s three are enough
        (0.001, 9),
        (0.0799, 4),
        (0.0801, 3),
    ],
)
def test_a_case_is_repeated_three_to_nine_times_within_eighty_milliseconds(
    gentle: Scene, looks: float, repeats: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clock goes on by so many seconds from look to look; it is looked at from the third on."""
    clock = count()
    monkeypatch.setattr("time.perf_counter", lambda: next(clock) * looks)
    monkeypatch.setattr(timing, "_work", lambda _: lambda: (1.0, 2.0, 3.0))
    monkeypatch.setattr(timing, "_warm_up", lambda _: None)
    found = timing.time_alone(Case(scene=gentle, engine="mujoco"))
    assert found == {"cpu_s": [1.0] * repeats, "wall_s": [2.0] * repeats, "setup_s": 3.0}
