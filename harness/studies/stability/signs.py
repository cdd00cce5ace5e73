"""Signs of failure in a run, each sought by itself: when it is seen first, and by how much.

Energy is measured against what the can has to spend: its kinetic energy at release and the height
of its centre above where it could come to rest. Of the paper's release that is 3 % of m g R; a
share of m g R would see nothing.
"""

import math
from collections.abc import Sequence

import numpy as np

from harness.bounce import Bounce
from harness.engines.horizon import natural_time
from harness.metrics.conservation import energy
from harness.runner import Evaluation
from harness.simulation import Outcome
from harness.studies.stability.exact import Exact
from harness.studies.stability.verdict import Sign
from harness.trajectory import Floats, Trajectory
from models.rim import contact_point
from models.scene import Scene

GAIN = LOSS = 0.05
"""Of the energy that the can has to spend: what a reader sees in phi at the first glance."""

DEEP = 0.1
"""Of the radius: a can this deep in the plane no longer touches it with its rim."""

LOW = 0.05
"""Of the largest phi: below it for good, the can counts as flat."""

HIGH = 0.5
"""Of the largest phi: above it the exact motion is plainly not flat."""


def spendable(trajectory: Trajectory, scene: Scene) -> float:
    """Return the energy over that of the can at rest, flat or on its side, at release, J."""
    can = scene.can
    lowest = can.half_height if scene.release.phi < can.balancing_angle else can.radius
    return float(energy(trajectory, scene)[0]) - can.mass * scene.gravity * lowest


def diverged(e: Evaluation) -> Sign | None:
    """Return when the numbers broke: the record of such a run ends there."""
    if e.simulation.outcome is not Outcome.DIVERGED:
        return None
    trajectory = e.simulation.trajectory
    if trajectory is None:
        return Sign(time=0.0, number=math.nan, words="no numbers in the first step")
    speed = np.linalg.norm(trajectory.velocity, axis=1)
    return Sign(
        time=float(trajectory.time[-1]), number=float(speed.max()), words="speed reached, m/s"
    )


def tunnelled(e: Evaluation) -> Sign | None:
    """Return when the ideal rim was deeper in the plane than a tenth of the radius."""
    trajectory, scene = e.simulation.trajectory, e.simulation.case.scene
    if trajectory is None or scene.gravity == 0.0:
        return None
    gap = contact_point(scene.can, trajectory.position, trajectory.quaternion)[:, 2]
    depth = (min(scene.release.height, 0.0) - gap) / scene.can.radius
    return _first(trajectory.time, depth, DEEP, "depth over the radius")


def gained(e: Evaluation) -> Sign | None:
    """Return when the energy had grown by a twentieth of what the can has to spend."""
    return _first(*_spent(e, -1.0), GAIN, "energy gained over what the can has to spend")


def dissipated(e: Evaluation, until: float) -> Sign | None:
    """Return when a twentieth of what the can has to spend was lost, up to a time in s."""
    time, lost = _spent(e, 1.0)
    within = time <= until
    return _first(time[within], lost[within], LOSS, "energy lost over what the can has to spend")


def stuck_flat(e: Evaluation, truth: Exact | None) -> Sign | None:
    """Return when the can lay down for good although the exact motion rises.

    Without an exact motion: when it lay down for longer than the natural time sqrt(R/g).
    """
    if e.motion is None:
        return None
    time, phi, scene = e.motion.time, e.motion.angles.phi, e.simulation.case.scene
    largest = float(phi.max()) if truth is None else float(truth.phi.max())
    up = np.flatnonzero(phi > LOW * largest)
    first = int(up[-1]) + 1 if len(up) else 0
    if first >= len(phi):
        return None
    since = float(time[first])
    if truth is None:
        flat = float(time[-1]) - since > natural_time(scene)
    else:
        flat = bool((truth.phi[truth.time >= since] > HIGH * largest).any())
    words = "largest phi since, rad"
    return Sign(time=since, number=float(phi[first:].max()), words=words) if flat else None


def unresolved(e: Evaluation, true: Sequence[Bounce]) -> Sign | None:
    """Return when the contact point first went round too fast to be counted, in a true bounce."""
    if e.motion is None:
        return None
    for bounce, _ in zip(e.bounces, true, strict=False):
        if not bounce.resolved:
            inside = (e.motion.time >= bounce.start) & (e.motion.time <= bounce.end)
            step = float(np.abs(np.diff(e.motion.angles.psi[inside])).max())
            return Sign(time=bounce.time, number=step, words="change of psi in a step, rad")
    return None


def _spent(e: Evaluation, sign: float) -> tuple[Floats, Floats]:
    """Return times and the energy lost (sign 1) or gained (-1), as a share of the spendable."""
    trajectory, scene = e.simulation.trajectory, e.simulation.case.scene
    if trajectory is None:
        return np.empty(0), np.empty(0)
    total = energy(trajectory, scene)
    # lifting the can out of the plane costs what its depth is worth, and is no gain
    lift = scene.can.mass * scene.gravity * max(0.0, -scene.release.height)
    change = sign * (total[0] - total) - (lift if sign < 0.0 else 0.0)
    return trajectory.time, change / spendable(trajectory, scene)


def _first(time: Floats, values: Floats, limit: float, words: str) -> Sign | None:
    """Return when values first exceed a limit, and the most they reach."""
    beyond = np.flatnonzero(values > limit)
    if len(beyond) == 0:
        return None
    return Sign(time=float(time[beyond[0]]), number=float(values.max()), words=words)
