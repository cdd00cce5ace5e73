"""A partition by whole motions: each scene run in an engine, or solved by the reference."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np

from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import features_of
from harness.engines.contract import contract_violation
from harness.engines.reference.truth import solve_case
from harness.engines.registry import engine
from harness.evaluation.evaluate import failed_simulation, simulate_case
from harness.metrics.bounces import bounces
from harness.metrics.energy import energy_drift
from harness.metrics.motion import motion
from harness.sweep.parameters import Floats
from harness.sweep.plan import SweepPlan
from harness.sweep.quantities import QUANTITIES, SweepValues
from models.scene import Scene

UNRESOLVED = "unresolved: the record is too coarse to tell how often psi went round"
INCOMPLETE = "no bounce: the run ended before phi had a maximum on either side of a minimum"

ERRORS = {
    "angle_of_turn_error_deg": "angle_of_turn_deg",
    "period_error_s": "period_s",
    "phi_min_error_rad": "phi_min_rad",
}
"""Of which quantity each error is."""

Numbers = dict[str, float]


def run_each(
    plan: SweepPlan, scenes: Sequence[Scene | str], exact: Mapping[str, Floats]
) -> SweepValues:
    """Run scenes; return their quantities and how each ended.

    Parameters
    ----------
    plan : Plan
    scenes : sequence of Scene or str
        A sentence stands for a scene that there is not.
    exact : mapping of str to ndarray, shape (n,)
        Exact quantities, to hold the runs against.
    """
    found = {name: np.full(len(scenes), np.nan) for name in QUANTITIES}
    outcomes = [scene if isinstance(scene, str) else "" for scene in scenes]
    there = [place for place, scene in enumerate(scenes) if isinstance(scene, Scene)]
    cases = [plan.case(scene) for scene in scenes if isinstance(scene, Scene)]
    for place, case, simulation in zip(there, cases, _simulations(cases), strict=True):
        numbers, outcomes[place] = _measured(case, simulation)
        for name, value in numbers.items():
            if math.isfinite(value):
                found[name][place] = value
    for name, of in ERRORS.items():
        if of in exact:
            found[name] = found[of] - exact[of]
    if "epsilon" in exact:
        found["epsilon"] = exact["epsilon"]
    return SweepValues(numbers={name: found[name] for name in plan.quantities}, outcomes=outcomes)


def _simulations(cases: Sequence[Case]) -> Iterator[Simulation]:
    """Yield what comes of cases: as many at once as a motion's length allows in memory."""
    for start in range(0, len(cases), size := _at_once(cases)):
        yield from _family(cases[start : start + size])


def _at_once(cases: Sequence[Case]) -> int:
    """Return how many motions to hold at once: a bounce is some hundred samples."""
    bounces = [case.scene.horizon.bounces for case in cases]
    longest = max((16 if count is None else count for count in bounces), default=1)
    return max(1, 256 // longest)


def _family(cases: Sequence[Case]) -> Sequence[Simulation]:
    """Run cases together where their engine can; one by one where that breaks."""
    if not cases:
        return ()
    chosen = engine(cases[0].engine)
    together = features_of(chosen).simulate_many
    if together is not None:
        # whatever goes wrong: one by one, below, says which case it was and why
        with suppress(Exception):
            done = together(cases)
            if len(done) == len(cases) and not any(map(contract_violation, done, cases)):
                return done
    return [_alone(case) for case in cases]


def _alone(case: Case) -> Simulation:
    """Run one case; wrong use that only this scene's own values reveal is its outcome."""
    try:
        return simulate_case(case)
    except HarnessError as error:
        return failed_simulation(case, str(error), Outcome.NO_SOLUTION)


def _measured(case: Case, simulation: Simulation) -> tuple[Numbers, str]:
    """Return the quantities of a run and the sentence of its outcome."""
    said = simulation.ending
    found: Numbers = {"steps": float(simulation.steps)}
    trajectory = simulation.trajectory
    drift = None if trajectory is None else energy_drift(trajectory, case.scene)
    if drift is not None:
        found["energy_drift"] = drift
    first = _first_bounce(case, simulation)
    if first is None:
        finished = simulation.outcome is Outcome.FINISHED
        return found, INCOMPLETE if finished else said
    return found | _of_bounce(first), said if first.resolved else UNRESOLVED


def _first_bounce(case: Case, simulation: Simulation) -> Bounce | None:
    """Return the first bounce of a run; of the reference, to its last digit."""
    if simulation.outcome is Outcome.NO_SOLUTION and simulation.trajectory is None:
        return None
    if case.engine == "reference":
        return next(iter(solve_case(case).bounces), None)
    if simulation.trajectory is None:
        return None
    found = motion(simulation.trajectory, case.scene)
    return next(iter(bounces(found, case.scene.can)), None)


_OF_BOUNCE = ("period_s", "phi_min_rad", "peak_psi_dot_rad_s", "peak_friction_ratio")
_TURNS = ("angle_of_turn_deg", "rotation_turn_deg")


def _of_bounce(first: Bounce) -> Numbers:
    """Return what a bounce has; without the turns if they cannot be counted."""
    names = _OF_BOUNCE + (_TURNS if first.resolved else ())
    values = {name: QUANTITIES[name].of_bounce(first) for name in names}
    return {name: value for name, value in values.items() if value is not None}
