"""Points of samples at any rows are those of the generators, drawn from the beginning."""

import warnings

import numpy as np
import pytest
from scipy.stats import qmc

from harness.core.trajectory import Floats
from harness.sweep.sequences import points

SEED, DIMENSIONS, COUNT = 7, 3, 5000


@pytest.fixture(params=["random", "sobol", "halton"])
def sample(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def drawn(sample: str) -> Floats:
    """Return the first points, all drawn at once by the generator itself."""
    random = np.random.Generator(np.random.PCG64(SEED))
    if sample == "random":
        return random.random((COUNT, DIMENSIONS))
    kind = qmc.Sobol if sample == "sobol" else qmc.Halton
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties")
        sequence = kind(d=DIMENSIONS, scramble=True, rng=np.random.default_rng(SEED))
        return np.asarray(sequence.random(COUNT))


def test_any_rows_are_those_of_the_sequence_to_the_bit(sample: str) -> None:
    whole = drawn(sample)
    for rows in (range(1), range(COUNT), range(1, 2), range(1023, 1026), range(2048, 4999)):
        part = points(sample, SEED, DIMENSIONS, rows)
        assert np.array_equal(part, whole[rows.start : rows.stop])


@pytest.mark.parametrize("sample", ["random", "halton"])
def test_the_last_rows_take_neither_the_time_nor_the_memory_of_those_before(sample: str) -> None:
    last = points(sample, SEED, DIMENSIONS, range(999_999_998, 1_000_000_000))
    assert np.array_equal(
        last[1:], points(sample, SEED, DIMENSIONS, range(999_999_999, 1_000_000_000))
    )


def test_a_far_sobol_point_is_the_one_that_scipy_reaches() -> None:
    far = 3_000_001
    sequence = qmc.Sobol(d=DIMENSIONS, scramble=True, rng=np.random.default_rng(SEED))
    sequence.fast_forward(far)
    part = points("sobol", SEED, DIMENSIONS, range(far - 5, far + 1))
    assert np.array_equal(part[-1:], sequence.random(1))
