"""What a sweep may ask of each scene, and its values: by the exact bounce, or by whole motions.

Every quantity is of the first bounce. By the exact bounce no scene is built: arrays go in and
arrays come out. By whole motions each scene is run in an engine, or solved by the reference.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import features_of
from harness.engines.contract import contract_violation
from harness.engines.reference.to_reference_problem import (
    SENTENCES,
    Releases,
    bounces_of,
    epsilon_of,
    refusal,
    representable,
)
from harness.engines.reference.truth import solve_case
from harness.engines.registry import engine
from harness.evaluation.evaluate import failed_simulation, simulate_case
from harness.metrics.bounces import bounces
from harness.metrics.energy import energy_drift
from harness.metrics.motion import motion
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Quantity
from harness.sweep.parameters import Floats, dimensions, scene_at
from models.can import AXIAL_INERTIA_ALLOWED
from models.scene import Scene

EPSILON = Quantity(
    key="epsilon",
    label="epsilon",
    unit="",
    meaning="The paper's small parameter, B_-2 squared with rates in sqrt(g/R), of the "
    "release: its square root measures how far the can is from falling flat.",
    of_run=lambda _: None,  # of a release, not of a run
)

SOURCES: Mapping[str, Literal["exact", "run", "error"]] = {
    "angle_of_turn_deg": "exact",
    "rotation_turn_deg": "exact",
    "period_s": "exact",
    "phi_min_rad": "exact",
    "peak_psi_dot_rad_s": "exact",
    "epsilon": "exact",
    "peak_friction_ratio": "run",
    "energy_drift": "run",
    "steps": "run",
    "angle_of_turn_error_deg": "error",
    "period_error_s": "error",
    "phi_min_error_rad": "error",
}
"""Where each quantity comes from.

"exact": the exact bounce has it, as a formula for many releases at once; "run": only a whole motion
has it; "error": an engine's value minus the exact one.
"""

QUANTITIES: Mapping[str, Quantity] = {
    name: EPSILON if name == "epsilon" else REGISTRY[name] for name in SOURCES
}
"""What may be asked, by name."""

DEFAULT = (
    "angle_of_turn_deg",
    "rotation_turn_deg",
    "period_s",
    "phi_min_rad",
    "peak_psi_dot_rad_s",
)
"""What is asked if nothing is said."""


BEYOND = f"{Outcome.NO_SOLUTION.value} (Its numbers are beyond what a double holds.)"
NO_CAN = f"no such scene: `c` must be {AXIAL_INERTIA_ALLOWED}"

_OF_BATCH = {
    "angle_of_turn_deg": "angle_of_turn",
    "rotation_turn_deg": "rotation_turn",
    "period_s": "period",
    "phi_min_rad": "phi_min",
    "peak_psi_dot_rad_s": "peak_psi_dot",
}
"""By quantities what the exact bounce calls them; turns are in radians there."""


def solved_exactly(
    scene: Scene, values: Mapping[str, Floats], quantities: Sequence[str]
) -> pd.DataFrame:
    """Return the exact quantities of scenes, and in the column `outcome` how each ended.

    Parameters
    ----------
    scene : Scene
        What does not vary.
    values : mapping of str to ndarray, shape (n,)
        Of the parameters that vary.
    quantities : sequence of str
        Names of exact ones.
    """
    n = len(next(iter(values.values())))
    outcomes = np.empty(n, dtype=object)
    outcomes[:] = ""
    release, can = scene.release, dimensions(scene.can, values)
    outcomes[np.broadcast_to(can["c"] > 2.0 * np.asarray(can["a"]), n)] = NO_CAN
    gravity = np.broadcast_to(values.get("gravity", np.float64(scene.gravity)), n)
    height = np.broadcast_to(values.get("release.height", np.float64(release.height)), n)
    for refused in (gravity == 0.0, height > 0.0, height < 0.0):
        some = np.flatnonzero(refused & (outcomes == ""))
        if some.size:
            first = {name: float(column[some[0]]) for name, column in values.items()}
            reason = refusal(scene_at(scene, first))
            outcomes[some] = f"{Outcome.NO_SOLUTION.value} ({reason})"
    well = outcomes == ""
    if well.any():
        # rates near the largest double overflow: that they are not representable is the answer
        with np.errstate(all="ignore"):
            inside = representable(_releases(scene, values, well))
        outcomes[np.flatnonzero(well)[~inside]] = BEYOND
        well = outcomes == ""
    numbers = {name: np.full(n, np.nan) for name in quantities}
    if well.any():
        _solve(_releases(scene, values, well), well, numbers, outcomes)
    return pd.DataFrame({**numbers, "outcome": outcomes})


def _releases(scene: Scene, values: Mapping[str, Floats], well: NDArray[np.bool_]) -> Releases:
    """Return the releases that are some; what does not vary stays one number."""
    some = {name: column[well] for name, column in values.items()}
    can, n = dimensions(scene.can, some), int(well.sum())
    groups = {name: np.asarray(can[name]) for name in ("a", "c", "h", "radius")}
    rates = {
        key: np.broadcast_to(some.get(f"release.{key}", np.float64(getattr(scene.release, key))), n)
        for key in ("phi", "phi_dot", "psi_dot", "theta_dot")
    }
    return Releases(gravity=np.asarray(some.get("gravity", scene.gravity)), **groups, **rates)


def _solve(
    releases: Releases,
    well: NDArray[np.bool_],
    numbers: dict[str, Floats],
    outcomes: NDArray[np.object_],
) -> None:
    """Put the quantities and outcomes of the releases that are some into their places."""
    # rates near the largest double overflow: what comes of it is not finite, and is said so
    with np.errstate(all="ignore"):
        batch = bounces_of(releases)
        epsilon = epsilon_of(releases) if "epsilon" in numbers else np.empty(0)
    sound = np.ones(len(batch.code), dtype=bool)
    for column in batch.numbers.values():
        sound &= np.isfinite(column) | ~batch.bounced
    outcomes[well] = np.where(sound, np.array(SENTENCES, dtype=object)[batch.code], BEYOND)
    for name, column in numbers.items():
        found = epsilon if name == "epsilon" else batch.numbers[_OF_BATCH[name]]
        found = np.degrees(found) if name.endswith("_deg") else found
        column[well] = np.where(sound, found, np.nan)


UNRESOLVED = "unresolved: the record is too coarse to tell how often psi went round"
INCOMPLETE = "no bounce: the run ended before phi had a maximum on either side of a minimum"

Numbers = dict[str, float]


def held_against(name: str) -> str:
    """Return of which quantity an error is."""
    return name.replace("_error", "")


def run_each(
    cases: Sequence[Case | str], quantities: Sequence[str], exact: Mapping[str, Floats]
) -> pd.DataFrame:
    """Run cases; return their quantities, and in the column `outcome` how each ended.

    Parameters
    ----------
    cases : sequence of Case or str
        A sentence stands for the case of a scene that there is not.
    quantities : sequence of str
    exact : mapping of str to ndarray, shape (n,)
        Exact quantities, to hold the runs against.
    """
    found = {name: np.full(len(cases), np.nan) for name in QUANTITIES}
    outcomes = [case if isinstance(case, str) else "" for case in cases]
    there = [place for place, case in enumerate(cases) if isinstance(case, Case)]
    runs = [case for case in cases if isinstance(case, Case)]
    for place, case, simulation in zip(there, runs, _simulations(runs), strict=True):
        numbers, outcomes[place] = _measured(case, simulation)
        for name, value in numbers.items():
            if math.isfinite(value):
                found[name][place] = value
    for name, source in SOURCES.items():
        if source == "error" and (of := held_against(name)) in exact:
            found[name] = found[of] - exact[of]
    if "epsilon" in exact:
        found["epsilon"] = exact["epsilon"]
    return pd.DataFrame({**{name: found[name] for name in quantities}, "outcome": outcomes})


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
    trajectory = simulation.trajectory
    if case.engine == "reference":
        unsolved = simulation.outcome is Outcome.NO_SOLUTION and trajectory is None
        found = () if unsolved else solve_case(case).bounces
    else:
        found = (
            () if trajectory is None else bounces(motion(trajectory, case.scene), case.scene.can)
        )
    return next(iter(found), None)


_OF_BOUNCE = ("period_s", "phi_min_rad", "peak_psi_dot_rad_s", "peak_friction_ratio")
_TURNS = ("angle_of_turn_deg", "rotation_turn_deg")


def _of_bounce(first: Bounce) -> Numbers:
    """Return what a bounce has; without the turns if they cannot be counted."""
    names = _OF_BOUNCE + (_TURNS if first.resolved else ())
    values = {name: QUANTITIES[name].of_bounce(first) for name in names}
    return {name: value for name, value in values.items() if value is not None}
