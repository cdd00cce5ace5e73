"""What the harness adds to an engine's own time, and what adaptive steps and batches take away."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import median

import numpy as np

from harness.benchmark.clock import Ratio, in_turns, seconds
from harness.case import Case
from harness.engines.registry import engine
from harness.engines.stepping import PhysicsEngine
from harness.runner import Evaluation, evaluate
from models.catalogue import load
from models.rim import released
from models.state import Pose, Release

OVERHEAD = {"mujoco": 1.10, "pybullet": 1.15}
"""Largest ratio of an adapter's loop to its engine's loop that steps and keeps nothing, in C where
the engine has one and else in Python: at the timestep at which a run is long."""

FINE = 1e-6
"""s. A sample costs what it costs, and a step of ten times this leaves fewer steps to carry it."""

_PAIRS = 5

GAIN = {"mujoco": 100.0, "pybullet": 10.0}
"""Least ratio of a fixed timestep's cost to that of adaptive steps, at the same error."""

_BRIEF = 25
"""Runs of tens of milliseconds, of which the shortest counts: together as long as a fixed one."""

_FIXED = (1e-5, 3e-6, 1e-6, 5e-7, 3e-7, 2e-7, 1.4e-7, 1e-7, 7e-8, 5e-8, 3e-8)


def engine_ratios(names: Sequence[str]) -> Iterator[Ratio]:
    """Measure the claims about the engines, one by one."""
    for name in names:
        chosen = engine(name)
        if isinstance(chosen, PhysicsEngine):
            for timestep in (FINE, 10.0 * FINE):
                yield _overhead(chosen, timestep)
            yield _batch(chosen)
            yield _adaptive(chosen)


def _overhead(chosen: PhysicsEngine, timestep: float) -> Ratio:  # type: ignore[type-arg]
    """Time the adapter's run of a gentle rock against the engine's loop that keeps nothing."""
    scene = load("gentle-rock")
    case = Case(scene=scene, engine=chosen.name, timestep=timestep)
    known = chosen.simulate(case)
    pose, twist = released(scene)
    sunk = Pose(
        position=pose.position - np.array((0.0, 0.0, known.static_penetration)),
        quaternion=pose.quaternion,
    )

    def lean() -> float:
        world = chosen.open(case)
        world.place(sunk, twist)
        return seconds(lambda: chosen.leanest(world, known.steps))

    pairs = [(chosen.simulate(case).cpu_s, lean()) for _ in range(_PAIRS)]
    ratio = median(adapted / bare for adapted, bare in pairs)
    bound = OVERHEAD.get(chosen.name, math.inf) if timestep <= FINE else math.inf
    return Ratio(
        what=f"{chosen.name}: adapter's loop against stepping alone, {known.steps:,} steps",
        ratio=ratio,
        claim=f"at most {bound:g}" if bound < math.inf else "",
        holds=ratio <= bound,
        first_s=median(pair[0] for pair in pairs),
        second_s=median(pair[1] for pair in pairs),
        note=f"gentle-rock, matched, timestep {timestep:g} s; medians of {_PAIRS}",
    )


def _batch(chosen: PhysicsEngine) -> Ratio:  # type: ignore[type-arg]
    """Time a batch of releases against the same one by one."""
    scene = load("gentle-rock")
    releases = [Release(phi=0.3 + 0.001 * n, psi_dot=2.0, theta_dot=-1.0) for n in range(100)]
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
    bound = GAIN.get(chosen.name, 1.0)
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
    """Return the error of the first angle of turn, deg."""
    if e.errors is None or not e.errors.angle_of_turn:
        return math.inf
    return abs(math.degrees(e.errors.angle_of_turn[0]))
