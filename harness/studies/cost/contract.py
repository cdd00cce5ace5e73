"""The fairness contract: the rules that every price was measured under, published with it."""

from harness.artefact import Prose
from harness.simulation import Outcome
from harness.studies.cost.design import priced
from harness.studies.cost.prices import NOISE
from harness.studies.cost.results import FOLLOWING, Cost
from harness.timing.alone import FEWEST


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
