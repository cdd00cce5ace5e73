"""The report of the study of cost: words, prices to paste, the fairness contract, and all tables.

The fairness contract is the rules that every price was measured under, published with it.
"""

from harness.core.report_model import Artefact, Prose
from harness.core.simulation import Outcome
from harness.engines.registry import export_settings
from harness.evaluation.timing import FEWEST
from harness.studies.cost.design import priced
from harness.studies.cost.figures import hardness_figure, work_precision
from harness.studies.cost.prices import (
    FIXED,
    FOLLOWING,
    NOISE,
    TARGETS,
    Cost,
    exponents,
)
from harness.studies.cost.tables import growth, hardness, orders, overhead, points, prices


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
                text = " ".join(export_settings(price.winners[0].point.case).split())
                blocks.append(f"{engine}, {target:g} degrees: {text}")
    return "\n\n".join(blocks)


def contract(cost: Cost) -> Prose:
    """Return the contract of a study, with its numbers in it."""
    plan, points = cost.plan, cost.points
    versions = ", ".join(
        f"{engine} {next(p.version for p in points if p.case.engine == engine)}"
        for engine in plan.engines
    )
    repeats = [len(p.cpu) for p in points if p.cpu]
    spreads = sorted(p.spread for p in points if len(p.cpu) > 1)
    middle = spreads[len(spreads) // 2] if spreads else 0.0
    waited = sorted(sum(p.wall) / sum(p.cpu) for p in points if p.wall and sum(p.cpu) > 0.0)
    clock = waited[len(waited) // 2] if waited else 1.0
    failed = [p for p in points if p.outcome is not Outcome.FINISHED]
    uncounted = sum(
        p.outcome is Outcome.FINISHED and p.errors.get(plan.target) is None for p in points
    )
    chosen = (
        "; ".join(
            f"{engine}, {'own steps' if choice == FOLLOWING else 'fixed step'}: {name}"
            for (engine, choice), name in cost.tuned.items()
        )
        or "none"
    )
    sizes = ", ".join(f"{len(priced(engine, plan.suite))} of {engine}" for engine in plan.engines)
    lines = (
        (
            f"The scene. Every engine runs {plan.scene.name}: the same can, release and horizon, "
            "checked in the compiled engine before the run."
        ),
        (
            "The ladder. Every fixed-step setting of every engine runs the same timesteps, over "
            "two decades or more; an engine as it ships runs its own timestep as well."
        ),
        (
            f"The settings. {sizes}. Those of an engine as it ships and those tuned have rows of "
            f"their own. Tuned settings were chosen on {plan.tuning_scene.name}, not on the scene "
            f"scored ({chosen}); the timestep is the buyer's. What is best of all on this very "
            "scene is listed apart, since whoever chooses after the race wins it."
        ),
        (
            "Error runs and timing runs are apart. Errors are read in runs that are not timed for "
            "the tables, and may run beside each other; times are taken in runs that nothing is "
            "read from."
        ),
        (
            "Alone. Timing runs go one after the other, in a process with one thread for linear "
            "algebra, under a lock on the machine so that no two studies time at once."
        ),
        (
            "Warm-up. The beginning of each case is run first and not counted. Compiling, parity "
            "and settling are set-up, reported in a column of their own."
        ),
        (
            f"Repeats. Each case is timed {min(repeats, default=FEWEST)} to "
            f"{max(repeats, default=FEWEST)} times; the price is the least processor time over "
            f"simulated time, the median stands beside it. Half of the medians lie within "
            f"{100 * middle:.0f} % of their minimum; by the clock a run took {clock:.2g} times its "
            "processor time, which says how busy the machine was."
        ),
        (
            f"Ties. Costs that differ by less than {100 * NOISE:.0f} % each, or by more where the "
            "two least of its repeats do, are tied and listed together."
        ),
        "No luck. A timestep reaches a target only if all finer ones on its ladder do.",
        (
            "What is paid for. An engine's cost holds its stepping and the harness's reading of "
            "each state, which the overhead row tells apart; the reference's cost is that of the "
            "motion known at any instant. The reference knows this one problem; engines know all. "
            "The truth is its fast integrator, which tests hold to forty digits: its own error "
            "reads zero."
        ),
        (
            f"Failures. {len(failed)} of {len(points)} runs did not reach the horizon and in "
            f"{uncounted} that did the error is not known; they are rows like all others."
        ),
        f"Versions: {versions}. Processor, platform and commit are in the provenance.",
    )
    return Prose(
        name=f"{plan.scene.name}-contract",
        title="Fairness contract",
        text="\n\n".join(lines),
        scene=plan.scene.name,
    )


_FALLING = ("turn_deg", "phi_rms_rad", "bounce_time_s")
"""Errors whose order is read: one of the bounce, one of the whole, one of the time."""

_FALLING_WITHOUT = ("rotation_rms_deg", "phi_rms_rad")
"""The same for a scene that has no bounce."""


def cost_report(cost: Cost) -> tuple[Artefact, ...]:
    """Return the artefacts of the study; no price without the contract and the overhead."""
    name = cost.plan.scene.name
    falling = _FALLING if cost.plan.target in _FALLING else _FALLING_WITHOUT
    hard = hardness_figure(cost)
    artefacts: list[Artefact] = [
        Prose(name="summary", title="Summary", text=summary(cost)),
        work_precision(cost),
        contract(cost),
        prices(cost),
        overhead(cost),
        Prose(
            name=f"{name}-paste",
            title="The tuned settings, to paste",
            text=all_pasted(cost) or "No engine reaches a target.",
            scene=name,
        ),
        orders(cost, falling),
    ]
    if hard is not None:
        artefacts += [hard, hardness(cost), growth(cost)]
    artefacts.append(points(cost))
    return tuple(artefacts)
