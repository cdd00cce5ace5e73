"""What was found of consecutive scenes of a sweep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.sweep.parameters import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """Quantities and outcomes of n scenes.

    Parameters
    ----------
    numbers : mapping of str to ndarray, shape (n,)
        By the names of quantities; NaN where a scene has none.
    outcomes : sequence of str
        How each scene ended.
    """

    numbers: Mapping[str, Floats]
    outcomes: Sequence[str]
