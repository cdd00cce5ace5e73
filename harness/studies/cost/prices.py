"""The price list: for each engine and target error the cheapest settings that reach it.

A rung of a ladder reaches a target if it and every finer rung of its ladder do: errors change sign,
and a coarse step that is right by luck is not for sale. The finest rung has no finer one to vouch
for it; it counts as no better than the one before, brought down at second order, which no contact
here exceeds.

Costs are equal, and tied, where they differ by less than the noise of the two measurements.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from harness.studies.cost.points import Point

TARGETS = (1.0, 0.1, 0.01)
"""deg."""

NOISE = 0.10
"""Share by which a minimum of repeats differs in another session on a shared machine, at least."""

_NOISIEST = 0.5
"""Beyond it a repeat was disturbed, and says nothing of the least one."""

_HIGHEST_ORDER = 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Offer:
    """A point, and the error that one can rely on it to keep."""

    point: Point
    error: float

    @property
    def noise(self) -> float:
        """Share of its cost by which that is uncertain."""
        noise = self.point.noise
        return NOISE if math.isnan(noise) else max(NOISE, min(noise, _NOISIEST))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PriceEntry:
    """What one buyer pays.

    Parameters
    ----------
    target : float
    winners : tuple of Offer
        The cheapest, and what is tied with it, by rising cost; empty if the target is not reached.
    best : Offer or None
        Of the least error, for when it is not reached; None if nothing ran.
    """

    target: float
    winners: tuple[Offer, ...]
    best: Offer | None


def offers(ladder: Sequence[Point], target: str, *, steps: bool) -> tuple[Offer, ...]:
    """Return what a ladder offers.

    Parameters
    ----------
    ladder : sequence of Point
        From coarse to fine.
    target : str
        Name of the error.
    steps : bool
        Whether it is a ladder of timesteps, in which finer rungs vouch for coarser ones.
    """
    sizes = [point.error(target) for point in ladder]
    if steps and len(ladder) > 1:
        ratio = _ratio(ladder[-2], ladder[-1])
        sizes[-1] = max(sizes[-1], sizes[-2] / ratio**_HIGHEST_ORDER)
        if math.isinf(sizes[-2]):
            sizes[-1] = math.inf
        for rung in range(len(sizes) - 2, -1, -1):
            sizes[rung] = max(sizes[rung], sizes[rung + 1])
    return tuple(Offer(point=p, error=e) for p, e in zip(ladder, sizes, strict=True))


def _ratio(coarse: Point, fine: Point) -> float:
    """Return how much finer a rung is than the one before."""
    if coarse.timestep is None or fine.timestep is None:
        return 1.0
    return coarse.timestep / fine.timestep


def price(sold: Sequence[Offer], target: float) -> PriceEntry:
    """Return the cheapest offers within a target, and those tied with the cheapest."""
    known = [offer for offer in sold if math.isfinite(offer.error)]
    best = min(known, key=lambda offer: (offer.error, offer.point.cost), default=None)
    reaching = sorted(
        (o for o in known if o.error <= target and math.isfinite(o.point.cost)),
        key=lambda offer: offer.point.cost,
    )
    if not reaching:
        return PriceEntry(target=target, winners=(), best=best)
    cheapest = reaching[0]
    winners = tuple(offer for offer in reaching if tied(cheapest, offer))
    return PriceEntry(target=target, winners=winners, best=best)


def tied(cheaper: Offer, dearer: Offer) -> bool:
    """Whether two costs differ by less than the noise of both."""
    return dearer.point.cost <= cheaper.point.cost * (1.0 + cheaper.noise) * (1.0 + dearer.noise)


def cost_of(sold: Sequence[Offer], target: float) -> tuple[float, bool] | None:
    """Return what a target costs on one ladder, between its rungs, and whether that is a bound.

    Parameters
    ----------
    sold : sequence of Offer
        Of one ladder, from coarse to fine.
    target : float

    Returns
    -------
    cost : float
    bound : bool
        True if the coarsest rung reaches it already, so that it costs that or less.
    """
    for place, offer in enumerate(sold):
        if offer.error > target or not math.isfinite(offer.point.cost):
            continue
        if place == 0:
            return offer.point.cost, True
        before = sold[place - 1]
        if not math.isfinite(before.error) or before.error <= target or offer.error == 0.0:
            return offer.point.cost, True
        share = math.log(before.error / target) / math.log(before.error / offer.error)
        log_cost = math.log(before.point.cost) * (1.0 - share) + math.log(offer.point.cost) * share
        return math.exp(log_cost), False
    return None
