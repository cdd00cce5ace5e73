"""Points of a sample of the unit cube at any rows, without the points before them.

Any process can so make any partition: a row follows from the seed and its own number. The points
are those of numpy's and scipy's generators, to the bit.
"""

import warnings
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from harness.core.trajectory import Floats

_BITS = 30
"""Of a coordinate of scipy's Sobol points, which are whole numbers over 2**30."""

Words = NDArray[np.int64]


def points(sample: str, seed: int, dimensions: int, rows: range) -> Floats:
    """Return consecutive points of a sample in the unit cube, shape (n, dimensions).

    Parameters
    ----------
    sample : str
        random, sobol or halton.
    seed : int
    dimensions : int
    rows : range
        At least one, with a stride of 1.
    """
    if sample == "random":
        # a double takes one number of the sequence: any row can be reached without those before
        bits = np.random.PCG64(seed).advance(rows.start * dimensions)
        return np.random.Generator(bits).random((len(rows), dimensions))
    if sample == "sobol":
        return _sobol(seed, dimensions, rows)
    from scipy.stats import qmc  # noqa: PLC0415 - takes a third of a second to import

    sequence = qmc.Halton(d=dimensions, scramble=True, rng=np.random.default_rng(seed))
    # A point follows from its number, which scipy counts in this public attribute; `fast_forward`
    # draws, and holds, all before it. The tests hold far points against van der Corput's.
    sequence.num_generated = rows.start
    return np.asarray(sequence.random(len(rows)), dtype=np.float64)


def _sobol(seed: int, dimensions: int, rows: range) -> Floats:
    """Return points of scipy's scrambled Sobol sequence.

    Point n is the exclusive or of point 0 and a change for each bit of n that is set. So the points
    of an aligned block of 2**m rows follow from its first, doubled m times.
    """
    width = (len(rows) - 1).bit_length()
    first, last = rows.start >> width, (rows.stop - 1) >> width
    words = np.concatenate(
        [_sobol_block(seed, dimensions, block, width) for block in range(first, last + 1)]
    )
    begin = rows.start - (first << width)
    return np.ldexp(words[begin : begin + len(rows)].astype(np.float64), -_BITS)


def _sobol_block(seed: int, dimensions: int, block: int, width: int) -> Words:
    """Return the points of rows `block` * 2**`width` and on, 2**`width` of them."""
    start = block << width
    words = _sobol_word(seed, dimensions, 0)[None, :]
    for bit in range(width, start.bit_length()):
        if start >> bit & 1:
            words = words ^ _sobol_change(seed, dimensions, bit)
    for bit in range(width):
        words = np.concatenate([words, words ^ _sobol_change(seed, dimensions, bit)])
    return words


@lru_cache(maxsize=256)
def _sobol_change(seed: int, dimensions: int, bit: int) -> Words:
    """Return how a bit of the row changes a point, shape (dimensions,)."""
    return _sobol_word(seed, dimensions, 1 << bit) ^ _sobol_word(seed, dimensions, 0)


def _sobol_word(seed: int, dimensions: int, row: int) -> Words:
    """Return one point as whole numbers, shape (dimensions,), in a time that grows with its row."""
    from scipy.stats import qmc  # noqa: PLC0415 - takes a third of a second to import

    sequence = qmc.Sobol(d=dimensions, scramble=True, bits=_BITS, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        # of a count that is no power of two: a plot or a mean needs no perfect balance
        warnings.filterwarnings("ignore", message="The balance properties")
        if row:  # `fast_forward(0)` overflows
            sequence.fast_forward(row)
        point = sequence.random(1)[0]
    word: Words = np.ldexp(point, _BITS).astype(np.int64)
    return word
