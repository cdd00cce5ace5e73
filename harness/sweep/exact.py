"""A partition by the exact bounce: no scene is built, arrays go in and arrays come out."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.core.simulation import Outcome
from harness.engines.reference.batch import SENTENCES, Releases, bounces_of, epsilon_of
from harness.engines.reference.to_reference_problem import refusal
from harness.sweep.parameters import Floats, dimensions, scene_at
from harness.sweep.quantities import SweepValues
from models.can import AXIAL_INERTIA_ALLOWED
from models.scene import Scene

BEYOND = f"{Outcome.NO_SOLUTION.value} (Its numbers are beyond what a double holds.)"
NO_CAN = f"no such scene: `c` must be {AXIAL_INERTIA_ALLOWED}"

_DEGREES = {"angle_of_turn_deg": "angle_of_turn", "rotation_turn_deg": "rotation_turn"}
_AS_IS = {
    "period_s": "period",
    "phi_min_rad": "phi_min",
    "peak_psi_dot_rad_s": "peak_psi_dot",
}


def solved_exactly(
    scene: Scene, values: Mapping[str, Floats], quantities: Sequence[str]
) -> SweepValues:
    """Return the exact quantities of scenes and how each ended.

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
    numbers = {name: np.full(n, np.nan) for name in quantities}
    if well.any():
        _solve(_releases(scene, values, well), well, numbers, outcomes)
    return SweepValues(numbers=numbers, outcomes=outcomes.tolist())


def _releases(scene: Scene, values: Mapping[str, Floats], well: NDArray[np.bool_]) -> Releases:
    """Return the releases that are some; what does not vary stays one number."""
    some = {name: column[well] for name, column in values.items()}
    release, can = scene.release, dimensions(scene.can, some)
    n = int(well.sum())

    def rate(key: str) -> Floats:
        return np.broadcast_to(some.get(f"release.{key}", np.float64(getattr(release, key))), n)

    return Releases(
        a=np.asarray(can["a"]),
        c=np.asarray(can["c"]),
        h=np.asarray(can["h"]),
        radius=np.asarray(can["radius"]),
        gravity=np.asarray(some.get("gravity", scene.gravity)),
        phi=rate("phi"),
        phi_dot=rate("phi_dot"),
        psi_dot=rate("psi_dot"),
        theta_dot=rate("theta_dot"),
    )


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
        if name == "epsilon":
            found = epsilon
        elif name in _DEGREES:
            found = np.degrees(batch.numbers[_DEGREES[name]])
        else:
            found = batch.numbers[_AS_IS[name]]
        column[well] = np.where(sound, found, np.nan)
