"""The price list: for each engine and target error the cheapest settings that reach it.

A rung of a ladder reaches a target if it and every finer rung of its ladder do: errors change sign,
and a coarse step that is right by luck is not for sale. The finest rung has no finer one to vouch
for it; it counts as no better than the one before, brought down at second order, which no contact
here exceeds.

Costs are equal, and tied, where they differ by less than the noise of the two measurements.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.studies.cost.design import CostPlan, Hardness, target_of
from harness.studies.cost.hardness import Exponent, exponent
from harness.studies.cost.points import Family, Point, Record, point

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


Ladder = tuple[Family, tuple[Point, ...]]
"""A family with its points, from coarse to fine."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cost:
    """A plan with its points.

    Parameters
    ----------
    plan : CostPlan
    ladders : tuple of Ladder
        Scored, in the order of the plan.
    tuned : mapping of (str, str) to str
        Of each engine, at fixed steps and at steps that follow the motion, the family that was
        chosen on the other scene; nothing where there is none.
    hardness : tuple of (Hardness, tuple of Ladder)
    gaps : mapping of Case to Record
        The error runs that say what a plateau is made of.
    overheads : mapping of str to Record
        By engine.
    """

    plan: CostPlan
    ladders: tuple[Ladder, ...]
    tuned: Mapping[tuple[str, str], str]
    hardness: tuple[tuple[Hardness, tuple[Ladder, ...]], ...]
    gaps: Mapping[Case, Record]
    overheads: Mapping[str, Record]

    @property
    def points(self) -> tuple[Point, ...]:
        """Every point of the scene."""
        return tuple(point for _, ladder in self.ladders for point in ladder)

    def sold(self, engine: str, choice: str) -> tuple[Offer, ...]:
        """Return what an engine offers: under one of `CHOICES`."""
        return tuple(
            offer
            for family, ladder in self.ladders
            if family.engine == engine and self._chosen(family, choice)
            for offer in offers(ladder, self.plan.target, steps=family.steps)
        )

    def _chosen(self, family: Family, choice: str) -> bool:
        if choice == SHIPPED:
            return family.variant.profile == "default" and not family.variant.settings
        if choice in _KINDS:
            return not family.steps or family.name == self.tuned.get((family.engine, choice))
        return True

    def price(self, engine: str, choice: str, target: float) -> PriceEntry:
        """Return what an engine costs at a target."""
        return price(self.sold(engine, choice), target)


SHIPPED = "settings as shipped"
FIXED = "tuned elsewhere, fixed step"
FOLLOWING = "tuned elsewhere, steps follow the motion"
HERE = "best of all here"

CHOICES = (SHIPPED, FIXED, FOLLOWING, HERE)
"""Where settings come from: the engine as it ships at any timestep; chosen on another scene, with
the harness's rule for the timestep or without; chosen on this very scene, which flatters."""

_KINDS = {FIXED: False, FOLLOWING: True}
"""Whether the steps of a choice follow the motion."""

_TIE = 1.25
"""Costs of single runs beside others that count as equal; the first declared is then taken."""


def cost(
    plan: CostPlan,
    errors: Mapping[Case, Record],
    times: Mapping[Case, Record],
    overheads: Mapping[str, Record],
) -> Cost:
    """Return the points of a plan from what its runs left.

    Parameters
    ----------
    plan : CostPlan
    errors : mapping of Case to Record
        Of every case of the plan.
    times : mapping of Case to Record
        Of those that are timed alone.
    overheads : mapping of str to Record
    """

    def ladder(family: Family) -> tuple[Point, ...]:
        return tuple(point(c, family, errors[c], times.get(c)) for c in family.cases)

    def ladders(families: Sequence[Family]) -> tuple[Ladder, ...]:
        return tuple((family, ladder(family)) for family in families)

    tuned = {}
    for name in plan.engines:
        for choice, follows in _KINDS.items():
            tried = [
                f
                for f in plan.tuning
                if f.engine == name and (f.variant.profile == "adaptive") == follows
            ]
            chosen = _tuned(ladders(tried), target_of(plan.tuning_scene))
            if chosen:
                tuned[name, choice] = chosen
    return Cost(
        plan=plan,
        ladders=ladders(plan.scored),
        tuned=tuned,
        hardness=tuple((hard, ladders(hard.families)) for hard in plan.hardness),
        gaps=errors,
        overheads=overheads,
    )


_TUNED_TO = (0.1, 1.0)
"""deg: the middle one of the targets, and where nothing reaches that, the easiest."""


def _tuned(ladders: Sequence[Ladder], target: str) -> str:
    """Return the family that reaches a tenth of a degree, or a degree, most cheaply.

    Where none does, the one that comes nearest. Of families that are as good the first counts.
    """
    sold = [(family.name, offers(ladder, target, steps=family.steps)) for family, ladder in ladders]
    for degrees in _TUNED_TO:
        prices = [(name, price(own, degrees)) for name, own in sold]
        reaching = [(p.winners[0].point.cost, name) for name, p in prices if p.winners]
        if reaching:
            return _first(reaching)
    found = [(name, price(own, 0.0).best) for name, own in sold]
    return _first([(best.error, name) for name, best in found if best is not None])


def _first(ranked: list[tuple[float, str]]) -> str:
    """Return the first name whose number is as good as the least; empty of none."""
    least = min((number for number, _ in ranked), default=0.0)
    return next((name for number, name in ranked if number <= _TIE * least), "")


ONE_DEGREE = 1.0


def hard_rows(cost: Cost) -> list[dict[str, object]]:
    """Return what a degree costs at each hardness."""
    rows = []
    for hard, ladders in cost.hardness:
        for family, ladder in ladders:
            found = cost_of(offers(ladder, "turn_deg", steps=True), ONE_DEGREE)
            told = _told(ladder, reached=found is not None)
            rows.append(
                {
                    "engine": family.engine,
                    "steps": family.name,
                    "epsilon": hard.epsilon,
                    "cost_s_s": None if found is None else found[0],
                    "at_most": None if found is None else found[1],
                    "case": told.digest,
                    "command": hard_command(told.case),
                }
            )
    return rows


def _told(ladder: Sequence[Point], *, reached: bool) -> Point:
    """Return the coarsest rung within a degree, the finest if there is none."""
    sold = offers(ladder, "turn_deg", steps=True)
    within = [offer.point for offer in sold if offer.error <= ONE_DEGREE]
    return within[0] if reached else ladder[-1]


def hard_command(case: Case) -> str:
    """Return what runs a case of a scene that the study wrote beside its report."""
    name = case.scene.name
    return case.command().replace(name, f"scenes/{name}.toml", 1)


def exponents(cost: Cost) -> dict[tuple[str, str], Exponent]:
    """Return the exponent of the cost of a degree, by engine and kind of step.

    Costs that are but bounds count where there are not two others.
    """
    ladders: dict[tuple[str, str], list[tuple[float, float, bool]]] = {}
    for row in hard_rows(cost):
        if row["cost_s_s"] is not None:
            seen = float(row["epsilon"]), float(row["cost_s_s"]), bool(row["at_most"])  # type: ignore[arg-type]
            ladders.setdefault((str(row["engine"]), str(row["steps"])), []).append(seen)
    found = {}
    for key, rows in ladders.items():
        sure = [row for row in rows if not row[2]]
        used = sure if len(sure) > 1 else rows
        found[key] = exponent([row[0] for row in used], [row[1] for row in used])
    return {key: value for key, value in found.items() if value is not None}
