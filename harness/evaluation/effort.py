"""What a case is expected to cost: its steps, and what a step costs in its engine.

Measured on a usual machine, with the suites; the cost of a step is declared by the engine. The
estimate of a run corrects all of it by what the run finds.
"""

from functools import lru_cache

from harness.core.case import Case
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import exact_end
from harness.engines.registry import description_of, timestep_of
from harness.engines.stepping.horizon import longest_time, natural_time
from harness.evaluation.timing import FEWEST, PATIENCE
from models.scene import Scene

_SET_UP = 0.13
"""s: compiling, parity, settling, the exact motion at the samples, measuring."""

_ADAPTIVE = 3.0
"""Over a step of a fixed timestep: each is recorded, and there are more where much happens."""

_OWN_STEPS = 0.1
"""s of a solver of its own steps."""

_GENERAL = 0.3
"""s that the general equations, of a scene with effects, take for a second of a motion."""


def engine_group(case: Case) -> str:
    """Return the name of the cases whose expected cost is wrong by one factor."""
    return f"{case.engine} {case.profile}"


def expected_steps(case: Case) -> float:
    """Return how many steps a case is expected to take; 0 for a solver of its own steps."""
    timestep = timestep_of(case)
    if timestep is None:
        return 0.0
    seconds = simulated_seconds(case.scene)
    if case.profile == "adaptive":  # the largest step is taken where little happens
        return (seconds + natural_time(case.scene)) / timestep
    return seconds / timestep


def expected_seconds(case: Case) -> float:
    """Return the processor time of a run and its measurement, s."""
    if timestep_of(case) is None:
        effects = case.scene.effects.declared()
        return _OWN_STEPS + (_GENERAL * simulated_seconds(case.scene) if effects else 0.0)
    step = description_of(case.engine).step_s
    return _SET_UP + expected_steps(case) * step * (
        _ADAPTIVE if case.profile == "adaptive" else 1.0
    )


def expected_timing(case: Case) -> float:
    """Return the processor time of repeated runs of a case, s."""
    return max(FEWEST * expected_seconds(case), PATIENCE)


@lru_cache(maxsize=4096)
def simulated_seconds(scene: Scene) -> float:
    """Return how long a run simulates, s: to its horizon, or through its exact bounces."""
    if scene.horizon.seconds is not None:
        return scene.horizon.seconds
    return longest_time(scene) if refusal(scene) else exact_end(scene)
