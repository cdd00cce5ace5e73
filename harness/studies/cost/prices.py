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
from itertools import accumulate

import numpy as np
from scipy.stats import linregress
from scipy.stats import t as student

from harness.core.case import Case
from harness.core.report_model import Figure, Panel, Series, Table
from harness.engines.ladder import takes_timestep
from harness.engines.registry import export_settings
from harness.evaluation.evaluation import Record
from harness.studies.cost.design import CostPlan, Hardness, target_of
from harness.studies.cost.points import Family, Point

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
    """Price of a target: the cheapest offers that reach it.

    Parameters
    ----------
    winners : tuple of Offer
        The cheapest, and what is tied with it, by rising cost; empty if the target is not reached.
    best : Offer or None
        Of the least error, for when it is not reached; None if nothing ran.
    """

    winners: tuple[Offer, ...]
    best: Offer | None


def offers(ladder: Sequence[Point], target: str, *, steps: bool) -> tuple[Offer, ...]:
    """Return the offers of a ladder.

    Parameters
    ----------
    ladder : sequence of Point
        From coarse to fine.
    target : str
        Name of the error.
    steps : bool
        Whether it is a ladder of timesteps or accuracies, in which finer rungs vouch for coarser.
    """
    sizes = [point.error(target) for point in ladder]
    if steps and len(ladder) > 1:
        coarse, fine = ladder[-2].rung, ladder[-1].rung
        ratio = coarse / fine if coarse and fine else 1.0
        sizes[-1] = max(sizes[-1], sizes[-2] / ratio**_HIGHEST_ORDER)
        if math.isinf(sizes[-2]):
            sizes[-1] = math.inf
        sizes = [*accumulate(reversed(sizes), max)][::-1]
    return tuple(Offer(point=p, error=e) for p, e in zip(ladder, sizes, strict=True))


def price(sold: Sequence[Offer], target: float) -> PriceEntry:
    """Return the cheapest offers within a target, and those tied with the cheapest."""
    known = [offer for offer in sold if math.isfinite(offer.error)]
    best = min(known, key=lambda offer: (offer.error, offer.point.cost), default=None)
    reaching = sorted(
        (o for o in known if o.error <= target and math.isfinite(o.point.cost)),
        key=lambda offer: offer.point.cost,
    )
    winners = tuple(offer for offer in reaching if tied(reaching[0], offer))
    return PriceEntry(winners=winners, best=best)


def tied(cheaper: Offer, dearer: Offer) -> bool:
    """Whether two costs differ by less than the noise of both."""
    return dearer.point.cost <= cheaper.point.cost * (1.0 + cheaper.noise) * (1.0 + dearer.noise)


def cost_of(sold: Sequence[Offer], target: float) -> tuple[float, bool] | None:
    """Return the cost of a target on one ladder, between its rungs, and whether it is a bound.

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
    runs : mapping of Case to Record
        The error runs of all cases.
    overheads : mapping of str to Record
        By engine.
    """

    plan: CostPlan
    ladders: tuple[Ladder, ...]
    tuned: Mapping[tuple[str, str], str]
    hardness: tuple[tuple[Hardness, tuple[Ladder, ...]], ...]
    runs: Mapping[Case, Record]
    overheads: Mapping[str, Record]

    @property
    def points(self) -> tuple[Point, ...]:
        """Every point of the scene."""
        return tuple(point for _, ladder in self.ladders for point in ladder)

    def sold(self, engine: str, choice: str) -> tuple[Offer, ...]:
        """Return the offers of an engine under one of `CHOICES`."""
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
        """Return the price of a target in an engine."""
        return price(self.sold(engine, choice), target)


SHIPPED = "settings as shipped"
FIXED = "tuned elsewhere, fixed step"
FOLLOWING = "tuned elsewhere, steps follow the motion"
HERE = "best of all here"

CHOICES = (SHIPPED, FIXED, FOLLOWING, HERE)
"""Where settings come from: the engine as it ships at any timestep; chosen on another scene, with
the harness's rule for the timestep or without; chosen on this very scene, which flatters."""

_KINDS = (FIXED, FOLLOWING)
"""Choices whose settings are tuned elsewhere."""


def _follows(family: Family) -> bool:
    """Whether the steps of a family follow the motion: by the harness's rule, or the engine's."""
    return family.variant.profile == "adaptive" or not takes_timestep(family.engine)


_TIE = 1.25
"""Ratio of the costs of single runs up to which they are equal: the first declared is taken."""


def cost(
    plan: CostPlan,
    errors: Mapping[Case, Record],
    times: Mapping[Case, Record],
    overheads: Mapping[str, Record],
) -> Cost:
    """Return the points of a plan from the records of its runs.

    Parameters
    ----------
    plan : CostPlan
    errors : mapping of Case to Record
        Of every case of the plan.
    times : mapping of Case to Record
        Of those that are timed alone.
    overheads : mapping of str to Record
    """

    def point(case: Case, family: Family) -> Point:
        return Point(case=case, variant=family.variant, run=errors[case], timed=times.get(case))

    def ladders(families: Sequence[Family]) -> tuple[Ladder, ...]:
        return tuple((f, tuple(point(case, f) for case in f.cases)) for f in families)

    tuned = {}
    for name in plan.engines:
        for choice in _KINDS:
            follows = choice == FOLLOWING
            tried = [f for f in plan.tuning if f.engine == name and _follows(f) == follows]
            chosen = _tuned(ladders(tried), target_of(plan.tuning_scene))
            if chosen:
                tuned[name, choice] = chosen
    return Cost(
        plan=plan,
        ladders=ladders(plan.scored),
        tuned=tuned,
        hardness=tuple((hard, ladders(hard.families)) for hard in plan.hardness),
        runs=errors,
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
    nearest = [(name, price(own, 0.0).best) for name, own in sold]
    return _first([(best.error, name) for name, best in nearest if best is not None])


def _first(ranked: list[tuple[float, str]]) -> str:
    """Return the first name whose number is as good as the least; empty of none."""
    least = min((number for number, _ in ranked), default=0.0)
    return next((name for number, name in ranked if number <= _TIE * least), "")


def all_pasted(cost: Cost) -> str:
    """Return the cheapest settings at a fixed step of every engine and target, as paragraphs.

    A model file has one timestep; what follows the motion needs a program, and has a command. Of an
    engine that chooses its own steps they are those of its own steps.
    """
    blocks = []
    for target in TARGETS:
        for engine in cost.plan.engines:
            choice = FIXED if takes_timestep(engine) else FOLLOWING
            price = cost.price(engine, choice, target)
            if price.winners and price.winners[0].point.rung is not None:
                text = " ".join(export_settings(price.winners[0].point.case).split())
                blocks.append(f"{engine}, {target:g} degrees: {text}")
    return "\n\n".join(blocks)


@dataclass(frozen=True, slots=True, kw_only=True)
class Exponent:
    """Cost ~ epsilon^exponent; half-width of the 95 % interval, infinite for two points."""

    exponent: float
    confidence: float
    points: int


def exponent(epsilons: Sequence[float], costs: Sequence[float]) -> Exponent | None:
    """Return the exponent of cost against epsilon, by least squares in logarithms; None of one."""
    pairs = [(e, c) for e, c in zip(epsilons, costs, strict=True) if c > 0.0 and math.isfinite(c)]
    if len(pairs) < 2:  # noqa: PLR2004 - a slope needs two points
        return None
    fit = linregress(*np.log(np.array(pairs)).T)
    freedom = len(pairs) - 2
    width = float(student.ppf(0.975, freedom) * fit.stderr) if freedom else math.inf
    return Exponent(exponent=float(fit.slope), confidence=width, points=len(pairs))


COSTS = (1e-3, 1e3)
"""Processor seconds per simulated second: ends of the axis of costs, the same for all scenes."""


def hardness_figure(degree: Table, growth: Table) -> Figure:
    """Return the cost of a degree against epsilon, from its table and that of its exponents."""
    series = tuple(
        Series(
            label=f"{name}, {steps}",
            kind=str(name),
            x=own["epsilon"].to_numpy(dtype=np.float64),
            y=own["cost_s_s"].to_numpy(dtype=np.float64),
            mark="both",
            dashed=steps != "fixed step",
            hover=tuple("at most" if bound else "one degree" for bound in own["at_most"]),
        )
        for (name, steps), own in degree.frame.groupby(["engine", "steps"], sort=False)
    )
    exponents = "; ".join(
        f"{row.engine}, {row.steps}: {row.exponent:+.2f}" for row in growth.frame.itertuples()
    )
    return Figure(
        name=f"{degree.scene}-hardness",
        title="What one degree costs as the bounce gets harder",
        seen=(
            "From right to left the bounce gets harder, down to the paper's. Exponents of the cost "
            f"against epsilon: {exponents or 'none'}."
        ),
        panels=(
            Panel(
                title="Cost of one degree",
                x_label="epsilon",
                y_label="processor seconds per simulated second",
                series=series,
                log_x=True,
                log_y=True,
                x_range=(1e-11, 1e-3),
                y_range=COSTS,
            ),
        ),
        columns=1,
        scene=degree.scene,
    )
