"""Why the differences of short and of long steps go wrong, and from which step on.

A central difference of f over the step s is d(s) = (f(+s) - f(-s))/(2s). Long steps leave the
linear range of f: where f bends, the error of d grows as the square of the step (truncation); where
f is bounded and its derivative is large, f(+s) - f(-s) no longer grows with s and d falls as 1/s
(saturation; chaos where the derivative grew exponentially). Short steps drown in the digits of f
(round-off). Where f(+s) - f(-s) is far above round-off and as large at a step a hundredth as long,
f is not continuous there. All else that is wrong at short steps has one name, since differences do
not tell its two causes apart: a ripple of f, from one choice of steps or contacts to the next, and
a motion of the engine that has another derivative at this timestep.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from harness.core.trajectory import Floats


class Takeover(Enum):
    """What makes a difference wrong; the value is a sentence."""

    ROUND_OFF = "round-off: the numbers that are subtracted have no more digits"
    DISCONTINUITY = "discontinuity: the numbers that are subtracted stay apart at shorter steps"
    RIPPLE = "ripple or timestep: the run bends with its steps, or has another derivative"
    STIFFNESS = "stiffness: the step is long beside the depth to which the contact gives way"
    TRUNCATION = "truncation: the change bends within the step"
    SATURATION = "saturation: the change is no longer in proportion to the step"
    CHAOS = "chaos: disturbances grow exponentially, and a longer step leads to another motion"

    @property
    def word(self) -> str:
        """The first word."""
        return self.value.partition(":")[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """What goes wrong with the steps at one end of a ladder.

    Parameters
    ----------
    takeover : Takeover
    step : float
        Relative step from which on it is so: the longest of short ones, the shortest of long ones.
    """

    takeover: Takeover
    step: float


SETTLED = 0.01
"""Differences of neighbouring short steps that agree so far, relative, have settled."""

_FEWEST = 3
"""Steps that make a plateau, a level of differences or of the numbers that are subtracted."""

_RUN = 2
"""Neighbouring steps that are right, so that none of them is by chance."""

_LEVEL = 4.0
"""Factor within which what is subtracted is level, while steps change tenfold or more."""

_TENFOLD = 10.0 * (1.0 - SETTLED)
"""Steps are told with two digits."""

_ROUND_OFF = 1e-12
"""Noise of a quantity, over the quantity, up to which it is round-off."""

_GROWN = 10.0
"""Relative change over relative change from which on growth, and no bend, ends the linear range."""

_LOST = 0.5
"""Share of the exact derivative below which a long difference has lost it."""


def short_cause(
    steps: Sequence[float],
    values: Sequence[float | None],
    *,
    exact: float,
    scale: float,
    right: float,
    unit: float,
    size: float,
) -> Cause | None:
    """Return what is wrong with the steps below those that are right; None if nothing is.

    Parameters
    ----------
    steps : sequence of float, length n
        Relative, from long to short.
    values : sequence of float or None, length n
        Differences over their step, per unit of the key.
    exact : float
        Likewise.
    scale : float
        Of the errors.
    right : float
        Relative error up to which a difference is right.
    unit : float
        What a relative step of one is, in the unit of the key.
    size : float
        Magnitude of the quantity.
    """
    s, d, error = _known(steps, values, exact, scale)
    good = longest_run(error <= right)
    wrong = 0 if good is None else good[1] + 1
    if s.size < _FEWEST or wrong == s.size:
        return None
    s, d = s[wrong:], d[wrong:]
    plateau = _longest_plateau(d)
    step = float(s[0] if wrong or plateau is None else s[plateau[0]])
    tail = (np.abs(d - exact) * 2.0 * s * unit)[-_FEWEST:]  # of the quantity, beyond what is exact
    noise = float(np.median(tail)) / size if size else math.inf
    level = tail.size == _FEWEST and tail.max() <= _LEVEL * tail.min()
    if plateau is None and noise <= _ROUND_OFF:
        return Cause(takeover=Takeover.ROUND_OFF, step=step)
    if level and noise > _ROUND_OFF and s[-_FEWEST] >= _TENFOLD * s[-1]:
        return Cause(takeover=Takeover.DISCONTINUITY, step=step)
    return Cause(takeover=Takeover.RIPPLE, step=step)


def long_cause(
    steps: Sequence[float],
    values: Sequence[float | None],
    *,
    exact: float,
    scale: float,
    right: float,
    growth: float,
    chaotic: bool,
) -> Cause | None:
    """Return what is wrong with the steps above those that are right; None if nothing is.

    Parameters
    ----------
    steps, values, exact, scale, right
        As of `short_cause`.
    growth : float
        Relative change of the quantity over that of the key, exactly, to first order.
    chaotic : bool
        Whether disturbances of the motion grow exponentially.
    """
    s, d, error = _known(steps, values, exact, scale)
    good = longest_run(error <= right)
    if good is None or good[0] == 0 or exact == 0.0:
        return None
    s, d = s[: good[0]], d[: good[0]]
    change = np.abs(d) * s  # of the numbers that are subtracted; linear, it would be |exact| s
    if chaotic and growth >= _GROWN:
        takeover = Takeover.CHAOS
    elif change[0] < _LOST * abs(exact) * s[0] and change[0] <= _LEVEL * change[-1]:
        takeover = Takeover.SATURATION
    else:
        takeover = Takeover.TRUNCATION
    return Cause(takeover=takeover, step=float(s[-1]))


def _known(
    steps: Sequence[float], values: Sequence[float | None], exact: float, scale: float
) -> tuple[Floats, Floats, Floats]:
    pairs = [
        (s, d) for s, d in zip(steps, values, strict=True) if d is not None and math.isfinite(d)
    ]
    s, d = np.array(pairs, dtype=np.float64).reshape(-1, 2).T
    return s, d, np.abs(d - exact) / scale


def own_causes(errors: Sequence[float | None], *, right: float) -> list[Takeover | None]:
    """Return what is wrong with an engine's own differences at each of their steps.

    Where a shorter step has less than half the error, the step leaves the contact that it
    differentiates (stiffness). Where only a longer one has, it is round-off. Else it is what no
    step changes.

    Parameters
    ----------
    errors : sequence of float or None, length n
        Relative, of steps from long to short; None where the engine has no number.
    right : float
        Relative error up to which a derivative is right.

    Returns
    -------
    list of Takeover or None
        None where the derivative is right or not known.
    """
    found: list[Takeover | None] = []
    for place, error in enumerate(errors):
        if error is None or error <= right:
            found.append(None)
            continue
        shorter, longer = (
            any(each is not None and each < error / 2.0 for each in side)
            for side in (errors[place + 1 :], errors[:place])
        )
        if shorter:
            found.append(Takeover.STIFFNESS)
        else:
            found.append(Takeover.ROUND_OFF if longer else Takeover.RIPPLE)
    return found


def longest_run(right: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Return first and last place of the longest run of steps that are right, of two at least.

    One step alone may be right by chance: where its error crosses zero.
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([False], right, [False]))))
    runs = edges.reshape(-1, 2)
    lengths = runs[:, 1] - runs[:, 0]
    if not lengths.size or lengths.max() < _RUN:
        return None
    first, end = runs[int(np.argmax(lengths))]
    return int(first), int(end) - 1


def _longest_plateau(values: Floats) -> tuple[int, int] | None:
    """Return first and last place of the longest run of neighbours that agree; None without one."""
    best: tuple[int, int] | None = None
    first = 0
    for place in range(1, values.size + 1):
        agree = place < values.size and abs(values[place] - values[place - 1]) <= SETTLED * max(
            abs(values[place]), abs(values[place - 1])
        )
        if agree and (values[place] or values[place - 1]):
            continue
        if place - first >= _FEWEST and (best is None or place - first > best[1] - best[0] + 1):
            best = first, place - 1
        first = place
    return best
