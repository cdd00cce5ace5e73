"""The price list in sentences, and the cheapest settings in each engine's own language."""

from harness.engines.variants import paste
from harness.studies.cost.hard_tables import exponents
from harness.studies.cost.prices import TARGETS
from harness.studies.cost.results import FIXED, FOLLOWING, Cost


def summary(cost: Cost) -> str:
    """Return what was found, a sentence an engine and a target."""
    plan = cost.plan
    parts = [
        (
            f"{len(cost.points)} runs of {len(plan.engines)} engines on {plan.scene.name}; "
            f"settings tuned on {plan.tuning_scene.name}; costs are processor seconds per "
            "simulated second."
        )
    ]
    for engine in plan.engines:
        for choice in (FIXED, FOLLOWING):
            told = _told(cost, engine, choice)
            if told:
                words = "" if engine == "reference" else f", {choice}"
                parts.append(f"{engine}{words}: {told}.")
            if engine == "reference":
                break
    grown = [
        f"{engine} with {steps} {found.exponent:+.2f}"
        for (engine, steps), found in exponents(cost).items()
    ]
    if grown:
        parts.append(f"One degree costs epsilon to the power of: {', '.join(grown)}.")
    return " ".join(parts)


def _told(cost: Cost, engine: str, choice: str) -> str:
    """Return what each target costs an engine, per simulated second."""
    told = []
    for target in TARGETS:
        price = cost.price(engine, choice, target)
        if price.winners:
            point = price.winners[0].point
            told.append(f"{target:g} degrees for {point.cost:.2g} s ({point.family})")
        elif price.best is not None:
            told.append(f"{target:g} degrees not reached, best is {price.best.error:.2g}")
    return "; ".join(told)


def all_pasted(cost: Cost) -> str:
    """Return the cheapest settings at a fixed step of every engine and target, as paragraphs.

    A model file has one timestep; what follows the motion needs a program, and has a command.
    """
    blocks = []
    for target in TARGETS:
        for engine in cost.plan.engines:
            price = cost.price(engine, FIXED, target)
            if price.winners and price.winners[0].point.timestep is not None:
                text = " ".join(paste(price.winners[0].point.case).split())
                blocks.append(f"{engine}, {target:g} degrees: {text}")
    return "\n\n".join(blocks)
