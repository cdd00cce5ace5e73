"""The limit of a ladder of timesteps, its uncertainty, and the order at which it is approached.

Values Q(h) = L + C h^p + ... at h, h/r, h/r^2 give three unknowns from three equations
(Richardson's extrapolation with the order observed, which is Aitken's delta-squared): with the
differences d1 = Q(h) - Q(h/r), d2 = Q(h/r) - Q(h/r^2) and q = d2/d1,

    p = -log q / log r,    L = Q(h/r^2) - d2 q/(1 - q).

The limit is that of the three finest values. Its uncertainty is how far it has moved from the limit
of the three values one rung coarser: what the ladder neglects, the next power of h, falls by at
least r from rung to rung, so that the move exceeds what is left for r of 2 or more. Noise in the
values, which the division by 1 - q amplifies, is added.

Three values that shrink by luck prove nothing: an order counts where two neighbouring triples both
have one. Where the finest two do not, the limit is the finest value, and its uncertainty the range
of the last three.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

_LEAST_ORDER = 0.25
"""Below it the extrapolated part is five times the last difference or more: no extrapolation."""

_TRIPLE = 3

_ROUND_OFF = 1e-9
"""Of a ratio of timesteps: far above that of repeated division."""

_CLEAR = 100.0
"""A difference so many times the noise, and one twice as large, put an order off by no more than
(2/100 + 2/200)/log 2, less than 0.05, at a ratio of two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtrapolatedLimit:
    """Where a ladder goes.

    Parameters
    ----------
    value : float
    uncertainty : float
        Half-width of the interval about it; infinite for a ladder of one value.
    order : float or None
        Observed at the finest rungs that are clear of noise; None if there is none.
    spread : float or None
        Half the range of the last two or three observed orders; None with a single one.
    rungs : int
        Values that went into it.
    """

    value: float
    uncertainty: float
    order: float | None
    spread: float | None
    rungs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class _Triple:
    """Limit and order of three neighbouring values."""

    limit: float
    order: float
    amplification: float  # of noise in the values


def limit(
    timesteps: Sequence[float], values: Sequence[float | None], noise: float = 0.0
) -> ExtrapolatedLimit | None:
    """Return the limit for a timestep of zero.

    Parameters
    ----------
    timesteps : sequence of float, length n
        s, falling by a constant ratio.
    values : sequence of float or None, length n
        None is not known; what comes before the last such is not used.
    noise : float
        Largest amount by which a value is off for other reasons than the timestep.

    Returns
    -------
    Limit or None
        None if the finest value is not known.

    Raises
    ------
    ValueError
        If the timesteps do not fall by a constant ratio.
    """
    ratio = _ratio(timesteps)
    known: list[float] = []
    for value in values:
        known = [] if value is None else [*known, value]
    if not known:
        return None
    floor = noise + 4.0 * math.ulp(max(map(abs, known)))  # a few roundings
    triples = [
        _triple(coarse, middle, fine, ratio)
        for coarse, middle, fine in zip(known, known[1:], known[2:], strict=False)
    ]
    order, spread = _order(known, triples, floor)
    finest = triples[-1] if triples else None
    before = triples[-2] if len(triples) > 1 else None
    if finest is None or (before is None and len(triples) > 1):
        end = known[-_TRIPLE:]
        value = known[-1]
        uncertainty = (max(end) - min(end) if len(end) > 1 else math.inf) + floor
    else:
        value = finest.limit
        moved = value - (known[-1] if before is None else before.limit)
        uncertainty = abs(moved) + finest.amplification * floor
    return ExtrapolatedLimit(
        value=value, uncertainty=uncertainty, order=order, spread=spread, rungs=len(known)
    )


def _order(
    known: Sequence[float], triples: Sequence[_Triple | None], floor: float
) -> tuple[float | None, float | None]:
    """Return the order at the finest rungs that are clear of noise, and its spread."""
    clear = [abs(middle - fine) > _CLEAR * floor for middle, fine in pairwise(known)][1:]
    while clear and not clear[-1]:  # the finest rungs may have drowned in noise
        clear = clear[:-1]
    steady: list[float] = []
    for triple in reversed(triples[: len(clear)]):
        if triple is None:
            break
        steady.append(triple.order)
    last = steady[:3]
    if not last or (len(last) == 1 and len(triples) > 1):
        return None, None
    return last[0], (max(last) - min(last)) / 2.0 if len(last) > 1 else None


def _ratio(timesteps: Sequence[float]) -> float:
    """Return the ratio of neighbouring timesteps; of a single one, 2."""
    ratios = [coarse / fine for coarse, fine in pairwise(timesteps)]
    if any(r <= 1.0 or abs(r / ratios[0] - 1.0) > _ROUND_OFF for r in ratios):
        raise ValueError(f"`timesteps` must fall by a constant ratio, not {list(timesteps)}")
    return ratios[0] if ratios else 2.0


def _triple(coarse: float, middle: float, fine: float, ratio: float) -> _Triple | None:
    """Return limit and order of three values, or None if they do not approach a limit."""
    d1, d2 = coarse - middle, middle - fine
    q = d2 / d1 if d1 != 0.0 else math.inf
    if not 0.0 < q <= ratio**-_LEAST_ORDER:
        return None
    # derivatives of the limit by d2 and d1; a difference holds the noise of two values
    by_d2, by_d1 = q * (2.0 - q) / (1.0 - q) ** 2, q**2 / (1.0 - q) ** 2
    return _Triple(
        limit=fine - d2 * q / (1.0 - q),
        order=-math.log(q) / math.log(ratio),
        amplification=1.0 + 2.0 * by_d2 + 2.0 * by_d1,
    )
