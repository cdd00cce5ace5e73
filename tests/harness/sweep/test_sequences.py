"""Points of samples at any rows are those of the generators, drawn from the beginning."""

import warnings

import numpy as np
import pytest
from scipy.stats import qmc

from harness.core.trajectory import Floats
from harness.sweep.sequences import points

SEED, DIMENSIONS, COUNT = 7, 3, 5000

_DIGITS = 53
"""Of base two, of a double below one."""


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


@pytest.mark.parametrize(("kind", "far"), [(qmc.Sobol, 3_000_001), (qmc.Halton, 300_001)])
def test_a_far_point_is_the_one_that_scipy_reaches(kind: type[qmc.QMCEngine], far: int) -> None:
    sequence = kind(d=DIMENSIONS, scramble=True, rng=np.random.default_rng(SEED))
    sequence.fast_forward(far)
    name = kind.__name__.lower()
    part = points(name, SEED, DIMENSIONS, range(far - 5, far + 1))
    assert np.array_equal(part[-1:], sequence.random(1))


def test_the_last_row_of_a_random_sample_is_reached_by_the_generator_in_halves() -> None:
    rows = 1_000_000_000
    bits = np.random.PCG64(SEED)
    for _ in range(2):  # in two strides, each of half the numbers before the last row
        bits.advance((rows - 2) * DIMENSIONS // 2)
    last = points("random", SEED, DIMENSIONS, range(rows - 2, rows))
    assert np.array_equal(last, np.random.Generator(bits).random((2, DIMENSIONS)))


def test_the_last_row_of_a_halton_sample_is_that_of_van_der_corput() -> None:
    # of base two: the digits of the row in reverse, with those of row zero as the permutation
    far = 999_999_998
    (first,) = points("halton", SEED, 1, range(1))
    shift = np.ldexp(first, _DIGITS).astype(np.int64)
    for row, point in enumerate(points("halton", SEED, 1, range(far, far + 2)), start=far):
        mirrored = int(f"{row:0{_DIGITS}b}"[::-1], 2)
        assert np.ldexp(point, _DIGITS) == float(shift[0] ^ mirrored)
