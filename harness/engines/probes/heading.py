"""Probe of the heading: the same scene, faced five ways, has one answer.

A plane has no direction of its own, and so a can that is turned about the vertical before it is let
go moves as before, turned. Engines find the lowest point of the rim from the horizontal part of the
axis, which nearly vanishes where the can is nearly flat: round-off there, or a law that prefers a
direction, shows as a turn that depends on the heading.

Near the flat state w = phi exp(i chi), with chi = psi sqrt(a_p/(a_p + 1)), moves on a straight line
past the origin at a constant speed (`harness.engines.stepping.schedule`). The can is let go at a
distance `_START` from it, at the speed `_SPEED`, on a line that passes it at `_LEAST`, with

    phi' = -speed,    chi' = least speed/phi^2,    theta' = -psi' cos phi

so that it has no spin about its axis. It falls on its way, and passes closer, at half of that; it
is watched until it is as far away again.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Trajectory
from harness.engines.probes.survey import Opener, Reading, probe, with_gravity
from harness.engines.stepping.horizon import natural_time
from models import Horizon, Release, Scene
from models.kinematics import angles

HEADINGS = tuple(0.3 + 2.0 * math.pi * share / 5.0 for share in range(5))
"""rad: none along an axis of the world, and no two alike for a law with four directions."""

_START, _LEAST = 5e-3, 4e-5  # rad: what comes of it is as close as the paper's release
_SPEED = 0.03  # rad in a natural time: that of a fall from some hundredths of a radian
_LONGER = 1.1  # so that the bounce is over


def passing(scene: Scene, heading: float) -> Scene:
    """Return a scene of an ideal can that passes the flat state closely, at a heading in rad."""
    speed = _SPEED / natural_time(scene)
    psi_dot = _LEAST * speed / _START**2 / scene.can.slowness
    release = Release(
        phi=_START,
        psi=heading,
        phi_dot=-speed,
        psi_dot=psi_dot,
        theta_dot=-psi_dot * math.cos(_START),
    )
    horizon = Horizon(seconds=2.0 * _LONGER * _START / speed)
    return replace(scene, name="passing", cite="", release=release, horizon=horizon)


def spread(paths: Sequence[Trajectory | None]) -> tuple[float, float]:
    """Return how far the last turn and the last tilt depend on the heading, rad.

    Parameters
    ----------
    paths : sequence of Trajectory or None
        One for each of `HEADINGS`; without one, both spreads are NaN.
    """
    if any(path is None for path in paths):
        return math.nan, math.nan
    ends = [angles(path.quaternion[-1]) for path in paths if path is not None]
    turns = np.array([float(end[1]) - each for end, each in zip(ends, HEADINGS, strict=True)])
    # about their mean, so that a turn by half of a circle is no jump
    apart = np.angle(np.exp(1j * turns) / np.mean(np.exp(1j * turns)))
    return float(np.ptp(apart)), float(np.ptp([end[0] for end in ends]))


@probe("heading")
def heading(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield how far the turn past the flat state, and the tilt behind it, depend on the heading."""
    ideal = with_gravity(case, case.scene.gravity)
    turn, tilt = spread(
        [
            engine.simulate(replace(ideal, scene=passing(ideal.scene, each))).trajectory
            for each in HEADINGS
        ]
    )
    how = "a pass of the flat state at some 2e-5 rad, at five headings"
    yield "spread of the turn", "rad", turn, 0.0, how
    yield "spread of the tilt behind it", "rad", tilt, 0.0, how
