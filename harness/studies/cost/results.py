"""Everything that was measured for a plan, put together."""

from collections.abc import Mapping
from dataclasses import dataclass

from harness.core.case import Case
from harness.studies.cost.design import CostPlan, Hardness, target_of
from harness.studies.cost.points import Family, Point, Record, point
from harness.studies.cost.prices import Offer, PriceEntry, offers, price


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cost:
    """A plan with its points.

    Parameters
    ----------
    plan : Plan
    ladders : tuple of (Family, tuple of Point)
        Scored, in the order of the plan.
    tuned : mapping of (str, str) to str
        Of each engine, at fixed steps and at steps that follow the motion, the family that was
        chosen on the other scene; nothing where there is none.
    hardness : tuple of (Hardness, tuple of (Family, tuple of Point))
    gaps : mapping of Case to Record
        The error runs that say what a plateau is made of.
    overheads : mapping of str to Record
        By engine.
    """

    plan: CostPlan
    ladders: tuple[tuple[Family, tuple[Point, ...]], ...]
    tuned: Mapping[tuple[str, str], str]
    hardness: tuple[tuple[Hardness, tuple[tuple[Family, tuple[Point, ...]], ...]], ...]
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
    plan : Plan
    errors : mapping
        Of every case of `design.run`.
    times : mapping
        Of every case of `design.timed`.
    overheads : mapping of str to Record
    """

    def ladder(family: Family) -> tuple[Point, ...]:
        return tuple(point(c, family, errors[c], times.get(c)) for c in family.cases)

    target = target_of(plan.tuning_scene)
    return Cost(
        plan=plan,
        ladders=tuple((family, ladder(family)) for family in plan.scored),
        tuned={
            (name, choice): chosen
            for name in plan.engines
            for choice, follows in _KINDS.items()
            if (
                chosen := _tuned(
                    [
                        (family, ladder(family))
                        for family in plan.tuning
                        if family.engine == name
                        and (family.variant.profile == "adaptive") == follows
                    ],
                    target,
                )
            )
        },
        hardness=tuple(
            (hard, tuple((family, ladder(family)) for family in hard.families))
            for hard in plan.hardness
        ),
        gaps=errors,
        overheads=overheads,
    )


_TUNED_TO = (0.1, 1.0)
"""deg: the middle one of the targets, and where nothing reaches that, the easiest."""


def _tuned(ladders: list[tuple[Family, tuple[Point, ...]]], target: str) -> str:
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
