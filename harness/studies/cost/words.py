"""The price list in sentences, and the cheapest settings in each engine's own language."""

from harness.engines.variants import paste
from harness.studies.cost.hard_tables import exponents
from harness.studies.cost.prices import TARGETS, Offer
from harness.studies.cost.results import CHOICES, HERE, TUNED, Cost


def summary(cost: Cost) -> str:
    """Return what was found, a sentence an engine and a target."""
    plan = cost.plan
    parts = [
        (
            f"{len(cost.points)} runs of {len(plan.engines)} engines on {plan.scene.name}; "
            f"settings tuned on {plan.tuning_scene.name}."
        )
    ]
    for engine in plan.engines:
        told = []
        for target in TARGETS:
            price = cost.price(engine, TUNED, target)
            if price.winners:
                first = price.winners[0].point
                told.append(f"{target:g} degrees cost {first.cost:.2g} s ({first.family})")
            elif price.best is not None:
                told.append(f"{target:g} degrees: not reached, best is {price.best.error:.2g}")
        if told:
            parts.append(f"{engine}, per simulated second: {'; '.join(told)}.")
    grown = [
        f"{engine} with {steps} {found.exponent:+.2f}"
        for (engine, steps), found in exponents(cost).items()
    ]
    if grown:
        parts.append(f"One degree costs epsilon to the power of: {', '.join(grown)}.")
    return " ".join(parts)


def pasted(cost: Cost, engine: str, target: float, choice: str = TUNED) -> str:
    """Return the cheapest settings of an engine for a target, ready to paste; empty if none."""
    price = cost.price(engine, choice, target)
    return paste(price.winners[0].point.case) if price.winners else ""


def fixed(cost: Cost, engine: str, target: float) -> Offer | None:
    """Return the cheapest offer of an engine at a fixed timestep, wherever its settings come from.

    A model file has one timestep; what follows the motion needs a program.
    """
    sold = [
        offer
        for offer in cost.sold(engine, HERE)
        if offer.point.case.profile != "adaptive" and offer.error <= target
    ]
    return min(sold, key=lambda offer: offer.point.cost, default=None)


def all_pasted(cost: Cost) -> str:
    """Return the cheapest tuned settings of every engine and target, as paragraphs."""
    blocks = []
    for target in TARGETS:
        for engine in cost.plan.engines:
            text = pasted(cost, engine, target, CHOICES[1])
            if text:
                blocks.append(f"{engine}, {target:g} degrees: {' '.join(text.split())}")
    return "\n\n".join(blocks)
