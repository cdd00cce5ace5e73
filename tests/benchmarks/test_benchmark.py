"""The clock of the benchmark, and that its claims are computed; speed is not for tests to say."""

import time

import pytest

from tests.benchmarks.clock import Ratio, in_turns, seconds
from tests.benchmarks.reference import _batch, _by_scipy, _releases


def _work(rounds: int) -> int:
    return sum(range(rounds))


def test_work_of_twice_the_size_takes_longer() -> None:
    short, long = in_turns(lambda: _work(200_000), lambda: _work(2_000_000))
    assert 0.0 < short < long


def test_only_the_processor_counts() -> None:
    # sleeping is not work: a tenth of the nap leaves room for the calls around it
    assert seconds(lambda: time.sleep(0.05)) < 0.005


def test_both_solvers_are_given_the_same_releases() -> None:
    few = {name: values[:2] for name, values in _releases(2).items()}
    # DOP853 at rtol 1e-12 keeps a turn of a few radians to some hundred times that
    assert _batch(few) == pytest.approx(_by_scipy(few), abs=1e-9)


def test_a_ratio_says_what_it_claims() -> None:
    ratio = Ratio(
        what="a against b", ratio=2.0, claim="", holds=True, first_s=2.0, second_s=1.0, note=""
    )
    assert ratio.first_s / ratio.second_s == ratio.ratio
