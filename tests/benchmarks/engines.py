"""What the harness adds to an engine's own time, and what adaptive steps and batches take away."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from statistics import median

import numpy as np

from harness.core.case import Case
from harness.engines.registry import engine
from harness.engines.stepping.physics_engine import PhysicsEngine
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import recorded_turn_error
from models.catalogue import load
from models.release import Release
from models.rim import released
from models.state import Pose
from tests.benchmarks.clock import Ratio, in_turns, median_of_pairs, seconds
from tests.benchmarks.recording_loops import recording_loop

FINE = 1e-6
"""s; at ten times this a tenth of the steps carry the same samples, which stand out then. What an
engine declares of the ratio of its adapter's loop to its own is of this timestep, where a run is
long: a sample costs what it costs, however many steps pass between two. Its own loop steps and
keeps nothing, in C where the engine has one; to keep each state and contact costs more."""

_TIMESTEPS = (FINE, 1e-5, 1e-4)

_ROUNDS = 12

_RELEASES = 100

_KEPT = 40_000
"""Steps kept whole, some kilobytes each in Python; what more would take is reckoned from these."""

_BRIEF = 25
"""Runs of tens of milliseconds, of which the shortest counts: together as long as a fixed one."""

_FIXED = (1e-5, 3e-6, 1e-6, 5e-7, 3e-7, 2e-7, 1.4e-7, 1e-7, 7e-8, 5e-8, 3e-8)


def engine_ratios(names: Sequence[str]) -> Iterator[Ratio]:
    """Measure the claims about the engines, one by one."""
    for name in names:
        chosen = engine(name)
        if isinstance(chosen, PhysicsEngine):
            for timestep in _TIMESTEPS:
                yield from _overhead(chosen, timestep)
            yield _batch(chosen)
            yield _adaptive(chosen)


def _overhead(chosen: PhysicsEngine, timestep: float) -> Iterator[Ratio]:  # type: ignore[type-arg]
    """Time the adapter's run of a gentle rock against the engine's own loops."""
    scene = load("gentle-rock")
    case = Case(scene=scene, engine=chosen.name, timestep=timestep)
    known = chosen.simulate(case)
    pose, twist = released(scene)
    sunk = Pose(
        position=pose.position - np.array((0.0, 0.0, known.static_penetration)),
        quaternion=pose.quaternion,
    )

    def bare(loop: Callable[..., None], most: int = known.steps) -> float:
        world, steps = chosen.open(case), min(known.steps, most)
        world.place(sunk, twist)
        return seconds(lambda: loop(world, steps)) * known.steps / steps

    rounds = [
        (chosen.simulate(case).cpu_s, bare(chosen.bare_loop), bare(recording_loop, _KEPT))
        for _ in range(_ROUNDS)
    ]
    bound = chosen.description.overhead if timestep <= FINE else math.inf
    adapted, *loops = zip(*rounds, strict=True)
    whats = ("stepping alone", "a loop that keeps each state and contact")
    for what, loop in zip(whats, loops, strict=True):
        # whatever else the machine does, it does to both of a pair
        pairs = [first / second for first, second in zip(adapted, loop, strict=True)]
        ratio, low, high = median_of_pairs(pairs)
        yield Ratio(
            what=f"{chosen.name}: adapter's loop against {what}, {known.steps:,} steps",
            ratio=ratio,
            claim=f"at most {bound:g}" if bound < math.inf else "",
            holds=ratio <= bound,
            first_s=median(adapted),
            second_s=median(loop),
            note=(
                f"gentle-rock, matched, timestep {timestep:g} s; median of {_ROUNDS} pairs, "
                f"95 % between {low:.3g} and {high:.3g}"
            ),
        )


def _batch(chosen: PhysicsEngine) -> Ratio:  # type: ignore[type-arg]
    """Time a batch of releases against the same one by one."""
    scene = load("gentle-rock")
    releases = [Release(phi=0.3 + 0.001 * n, psi_dot=2.0, theta_dot=-1.0) for n in range(_RELEASES)]
    cases = [
        Case(scene=replace(scene, release=release), engine=chosen.name, timestep=1e-3)
        for release in releases
    ]
    together, apart = in_turns(
        lambda: chosen.simulate_many(cases),
        lambda: [chosen.simulate(case) for case in cases],
        repeats=2,
    )
    return Ratio(
        what=f"{chosen.name}: {len(cases)} releases one by one against together",
        ratio=apart / together,
        claim="",
        holds=True,
        first_s=apart,
        second_s=together,
        note="the same results to the bit; timestep 1e-3 s, set-up included",
    )


def _adaptive(chosen: PhysicsEngine) -> Ratio:  # type: ignore[type-arg]
    """Time adaptive steps against the cheapest fixed timestep with the same error."""
    scene = load("paper-release")
    adaptive = Case(scene=scene, engine=chosen.name, profile="adaptive")
    error = _turn_error(evaluate(adaptive))
    fixed, fixed_error = None, math.inf
    for timestep in _FIXED:
        fixed = Case(scene=scene, engine=chosen.name, timestep=timestep)
        fixed_error = _turn_error(evaluate(fixed))
        if fixed_error <= error:
            break
    quick = min(chosen.simulate(adaptive).cpu_s for _ in range(_BRIEF))
    slow = chosen.simulate(fixed).cpu_s if fixed is not None else math.inf
    bound = chosen.description.adaptive_gain
    return Ratio(
        what=f"{chosen.name}: cheapest fixed timestep with the same error against adaptive",
        ratio=slow / quick,
        claim=f"at least {bound:g} times cheaper",
        holds=slow >= bound * quick,
        first_s=slow,
        second_s=quick,
        note=(
            f"paper-release: {error:.2g} deg adaptive, {fixed_error:.2g} deg at "
            f"{fixed.timestep if fixed else 0.0:g} s"
        ),
    )


def _turn_error(e: Evaluation) -> float:
    """Return the size of the error of the first angle of turn as recorded, deg."""
    error = recorded_turn_error(e)
    return math.inf if error is None else abs(error)
