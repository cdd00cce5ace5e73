"""Quantities of a sweep and their values: by the exact bounce, or by running each scene.

Every quantity is of the first bounce. By the exact bounce no scene is built: arrays go in and
arrays come out. Otherwise each scene is run in an engine, or solved by the reference.
"""

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
    BEYOND_DOUBLES,
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
from harness.evaluation.evaluation import Evaluation
from harness.metrics.bounces import bounces
from harness.metrics.energy import energy_drift
from harness.metrics.motion import motion
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Quantity
from harness.sweep.derivatives import DERIVATIVES, of_cases, of_releases, source_of
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
    **{name: source_of(name) for name in DERIVATIVES},
}
"""Where each quantity comes from.

"exact": the exact bounce has it, as a formula for many releases at once; "run": only a whole motion
has it; "error": an engine's value minus the exact one.
"""

QUANTITIES: Mapping[str, Quantity] = {
    **{
        name: EPSILON if name == "epsilon" else REGISTRY[name]
        for name in SOURCES
        if name not in DERIVATIVES
    },
    **DERIVATIVES,
}
"""Every quantity that a sweep may have, by name."""

DEFAULT = (
    "angle_of_turn_deg",
    "rotation_turn_deg",
    "period_s",
    "phi_min_rad",
    "peak_psi_dot_rad_s",
)
"""Quantities of a sweep that names none."""


BEYOND = f"{Outcome.NO_SOLUTION.value} ({BEYOND_DOUBLES})"
NO_CAN = f"no such scene: `c` must be {AXIAL_INERTIA_ALLOWED}"


def solved_exactly(
    scene: Scene,
    values: Mapping[str, Floats],
    quantities: Sequence[str],
    *,
    compiled: bool = False,
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
    compiled : bool
        By compiled kernels, which differ from the arrays in round-off.
    """
    n = len(next(iter(values.values())))
    outcomes = np.full(n, "", dtype=object)
    release, can = scene.release, dimensions(scene.can, values)
    outcomes[np.broadcast_to(can["c"] > 2.0 * np.asarray(can["a"]), n)] = NO_CAN
    gravity = np.broadcast_to(values.get("gravity", np.float64(scene.gravity)), n)
    height = np.broadcast_to(values.get("release.height", np.float64(release.height)), n)
    for refused in (gravity == 0.0, height > 0.0, height < 0.0):
        rows = np.flatnonzero(refused & (outcomes == ""))
        if rows.size:
            first = {name: float(column[rows[0]]) for name, column in values.items()}
            reason = refusal(scene_at(scene, first))
            outcomes[rows] = f"{Outcome.NO_SOLUTION.value} ({reason})"
    valid = outcomes == ""
    if valid.any():
        # rates near the largest double overflow: that they are not representable is the answer
        with np.errstate(all="ignore"):
            releases = _releases(scene, values, valid)
            inside = representable(releases)
        if not inside.all():
            outcomes[np.flatnonzero(valid)[~inside]] = BEYOND
            valid = outcomes == ""
            releases = _releases(scene, values, valid)
    numbers = {name: np.full(n, np.nan) for name in quantities}
    if valid.any():
        slopes = [name for name in quantities if name in DERIVATIVES]
        _solve(
            releases,
            valid,
            {name: numbers[name] for name in quantities if name not in DERIVATIVES},
            outcomes,
            compiled=compiled,
        )
        if slopes:
            radius = np.broadcast_to(can["radius"], n)[valid]
            for name, column in of_releases(releases, gravity[valid], radius, slopes).items():
                numbers[name][valid] = column
    # as objects: pandas would otherwise copy the same few sentences row by row
    return pd.DataFrame({**numbers, "outcome": pd.Series(outcomes, dtype=object)})


def _releases(scene: Scene, values: Mapping[str, Floats], valid: NDArray[np.bool_]) -> Releases:
    """Return the releases of the valid scenes; a parameter that does not vary stays one number."""
    varied = {name: column[valid] for name, column in values.items()}
    can, n = dimensions(scene.can, varied), int(valid.sum())
    groups = {name: np.asarray(can[name]) for name in "ach"}
    state = {
        key: np.broadcast_to(varied.get(f"release.{key}", getattr(scene.release, key)), n)
        for key in ("phi", "phi_dot", "psi_dot", "theta_dot")
    }
    gravity = np.asarray(varied.get("gravity", scene.gravity))
    return Releases.of(gravity, np.asarray(can["radius"]), **groups, **state)


def _solve(
    releases: Releases,
    valid: NDArray[np.bool_],
    numbers: dict[str, Floats],
    outcomes: NDArray[np.object_],
    *,
    compiled: bool,
) -> None:
    """Write the quantities and outcomes of the releases into the rows of the valid scenes."""
    # rates near the largest double overflow: the result is not finite, and the outcome says so
    with np.errstate(all="ignore"):
        batch = bounces_of(releases, compiled=compiled)
        epsilon = epsilon_of(releases) if "epsilon" in numbers else np.empty(0)
    sound = np.ones(len(batch.code), dtype=bool)
    for column in batch.numbers.values():
        sound &= np.isfinite(column) | ~batch.bounced
    outcomes[valid] = np.where(sound, np.array(SENTENCES, dtype=object)[batch.code], BEYOND)
    for name, column in numbers.items():
        exact = epsilon if name == "epsilon" else batch.numbers[name]
        column[valid] = np.where(sound, exact, np.nan)


UNRESOLVED = "unresolved: the record is too coarse to tell how often psi went round"
INCOMPLETE = "no bounce: the run ended before phi had a maximum on either side of a minimum"


def compared_quantity(name: str) -> str:
    """Return the name of the quantity of which this one is the error."""
    return name.replace("_error", "")


def run_each(
    cases: Sequence[Case | str], quantities: Sequence[str], exact: Mapping[str, Floats]
) -> pd.DataFrame:
    """Run cases; return their quantities, and in the column `outcome` how each ended.

    Parameters
    ----------
    cases : sequence of Case or str
        A sentence stands for the case of a scene that cannot exist, and says why.
    quantities : sequence of str
    exact : mapping of str to ndarray, shape (n,)
        Exact quantities, from which the errors of the runs are taken.
    """
    simulations = _simulations([case for case in cases if isinstance(case, Case)])
    rows = [({}, case) if isinstance(case, str) else _measured(next(simulations)) for case in cases]
    columns = {
        name: np.array([numbers.get(name) for numbers, _ in rows], dtype=np.float64)
        for name in QUANTITIES
    }
    for name, source in SOURCES.items():
        if source == "error" and (of := compared_quantity(name)) in exact:
            columns[name] = columns[of] - exact[of]
    if "epsilon" in exact:
        columns["epsilon"] = exact["epsilon"]
    columns |= of_cases(cases, [name for name in quantities if name in DERIVATIVES])
    outcomes = [outcome for _, outcome in rows]
    return pd.DataFrame({**{name: columns[name] for name in quantities}, "outcome": outcomes})


def _simulations(cases: Sequence[Case]) -> Iterator[Simulation]:
    """Yield the simulation of each case, run in batches that fit into memory."""
    # a bounce is some hundred samples, and a run of given time may have many
    longest = max((case.scene.horizon.bounces or 16 for case in cases), default=1)
    size = max(1, 256 // longest)
    for start in range(0, len(cases), size):
        yield from _batch(cases[start : start + size])


def _batch(cases: Sequence[Case]) -> Sequence[Simulation]:
    """Run cases together where their engine can; one by one where that breaks."""
    chosen = engine(cases[0].engine)
    together = features_of(chosen).simulate_many
    if together is not None:
        # any error: running one by one, below, names the case and the reason
        with suppress(Exception):
            done = together(cases)
            if len(done) == len(cases) and not any(map(contract_violation, done, cases)):
                return done
    return [_simulated(case) for case in cases]


def _simulated(case: Case) -> Simulation:
    """Run one case; wrong use that only the values of this scene reveal is its outcome."""
    try:
        return simulate_case(case)
    except HarnessError as error:
        return failed_simulation(case, str(error), Outcome.NO_SOLUTION)


def _measured(simulation: Simulation) -> tuple[Mapping[str, float | None], str]:
    """Return the quantities of a run and the sentence of its outcome."""
    case, trajectory = simulation.case, simulation.trajectory
    drift = None if trajectory is None else energy_drift(trajectory, case.scene)
    known = _bounces(simulation)
    run = Evaluation(simulation=simulation, bounces=known, energy_drift=drift)
    numbers = {name: quantity.of_run(run) for name, quantity in QUANTITIES.items()}
    if not known:
        finished = simulation.outcome is Outcome.FINISHED
        return numbers, INCOMPLETE if finished else simulation.ending
    if not known[0].resolved:
        return numbers | dict.fromkeys(_TURNS), UNRESOLVED
    return numbers, simulation.ending


_TURNS = ("angle_of_turn_deg", "rotation_turn_deg")
"""Quantities that a run has only if its turns can be counted."""


def _bounces(simulation: Simulation) -> tuple[Bounce, ...]:
    """Return the bounces of a run; of the reference, to their last digit."""
    case, trajectory = simulation.case, simulation.trajectory
    if trajectory is not None and case.engine != "reference":
        return bounces(motion(trajectory, case.scene), case.scene.can)
    lost = simulation.outcome in {Outcome.NO_SOLUTION, Outcome.BROKEN}
    unsolved = trajectory is None and lost
    return () if unsolved or case.engine != "reference" else solve_case(case).bounces
