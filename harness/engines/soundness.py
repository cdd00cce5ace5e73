"""What every engine's answer must be before anything is measured of it.

An adapter is somebody's program and may be wrong; then its answer is refused with the reason, and
no other case suffers. What is refused here is a fault of the adapter. Numbers that grew without
bound are not: a run that diverged says so and hands over what was sound before.
"""

import numpy as np

from harness.case import Case
from harness.simulation import Simulation
from harness.trajectory import Trajectory

_STATE = ("time", "position", "quaternion", "velocity", "angular_velocity", "contact_force")

_UNIT_TOLERANCE = 1e-6
"""Off which a quaternion may be from unit length: that of one normalised in single precision."""


def fault(answer: object, case: Case) -> str:
    """Return in what an answer to a case is no simulation of it; empty if it is one.

    Parameters
    ----------
    answer : object
        What an adapter's `simulate` returned.
    case : Case
    """
    if not isinstance(answer, Simulation):
        return f"`simulate` returned {type(answer).__name__}, not a Simulation"
    if answer.case != case:
        return f"`simulate` answered another case, {answer.case.label()}"
    trajectory: object = answer.trajectory
    if trajectory is None:
        return ""
    if not isinstance(trajectory, Trajectory):
        return f"`trajectory` is {type(trajectory).__name__}, not a Trajectory"
    return _fault_of_numbers(trajectory)


def _fault_of_numbers(trajectory: Trajectory) -> str:
    """Return what is wrong with the numbers of a trajectory whose shapes are right."""
    for name in _STATE:
        bad = ~np.isfinite(getattr(trajectory, name).reshape(len(trajectory), -1)).all(axis=1)
        if bad.any():
            first = int(np.argmax(bad))
            return f"`{name}` is no number at sample {first} of {len(trajectory)}"
    if trajectory.time[0] != 0.0:
        return f"`time` starts at {float(trajectory.time[0])!r} s, not at the release, 0.0"
    off = float(np.abs(np.linalg.norm(trajectory.quaternion, axis=1) - 1.0).max())
    if off > _UNIT_TOLERANCE:
        return f"`quaternion` is off unit length by {off:.1e}"
    return ""
