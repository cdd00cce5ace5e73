"""When a run of an engine ends: at its horizon, or earlier because nothing more will come.

A bounce is a minimum of phi between two maxima that both stand out from it. The watch sees the
recorded samples, which are dense in angle, and so misses none.
"""

import math

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory
from models.kinematics import half_angles
from models.scene import Scene

BOUNCE_ALLOWANCE = 100.0
"""Natural times sqrt(R/g) allowed for a bounce; one from 1e-5 rad off balance takes about 35."""

FLAT_ALLOWANCE = 20.0
"""Natural times below the prominence after which a can that does not rise is called flat."""

_COUNTABLE = 1e15
"""Steps: what a double counts one by one; a run is ended long before."""

_LARGEST_GAIN = 1e3
"""Kinetic energy, over that of the release and m g (R + H), from which a run counts as diverged."""


def natural_time(scene: Scene) -> float:
    """Return sqrt(R/g), s; without gravity a tenth of the horizon."""
    if scene.gravity > 0.0:
        return math.sqrt(scene.can.radius / scene.gravity)
    return scene.horizon.seconds / 10.0 if scene.horizon.seconds is not None else 1.0


def longest_time(scene: Scene) -> float:
    """Return the time after which a run is ended whatever happened, s."""
    if scene.horizon.seconds is not None:
        return scene.horizon.seconds
    return BOUNCE_ALLOWANCE * natural_time(scene) * (scene.horizon.bounces or 1)


def countable(timestep: float, scene: Scene) -> None:
    """Refuse a timestep, s, of which a run may need more than can be counted.

    Raises
    ------
    InvalidSettingError
    """
    longest = longest_time(scene)
    if longest / timestep > _COUNTABLE:
        allowed = f"at least {longest / _COUNTABLE:.2g} s, for a run may last {longest:.2g} s"
        raise InvalidSettingError("timestep", timestep, allowed)


class Watch:
    """Follows a run and says when it is over."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._falling = True
        self._peak = scene.release.phi
        self._valley = math.inf
        self._largest = 0.0
        self._bounces = 0
        self._last_up = 0.0
        self.ended_at = math.inf
        rates = scene.release
        spin = rates.phi_dot**2 + rates.psi_dot**2 + rates.theta_dot**2
        size = scene.can.bounding_radius
        self._scale = spin * size**2 + scene.gravity * size
        self._patience = FLAT_ALLOWANCE * natural_time(scene)

    def over(self, samples: Trajectory) -> Outcome | None:
        """Return how the run ended if these samples end it (at `ended_at`, s), else None."""
        speed = np.sum(samples.velocity**2, axis=1)
        sound = speed <= _LARGEST_GAIN * self._scale  # false for what is no number
        phi = half_angles(samples.quaternion)[0]
        columns = (samples.time.tolist(), phi.tolist(), sound.tolist())
        for time, tilt, good in zip(*columns, strict=True):
            outcome = self._see(time, tilt) if good else Outcome.DIVERGED
            if outcome is not None:
                self.ended_at = time
                return outcome
        return None

    def _see(self, time: float, phi: float) -> Outcome | None:
        """Take one sample into account."""
        if phi >= math.pi / 2.0:
            return Outcome.OVERTURNED
        self._largest = max(self._largest, phi)
        margin = PROMINENCE * self._largest
        if phi > margin:
            self._last_up = time
        elif time - self._last_up > self._patience:
            return Outcome.FLAT
        if self._falling:
            self._valley = min(self._valley, phi)
            if phi > self._valley + margin:
                self._bounces += self._peak > self._valley + margin
                self._falling, self._peak = False, phi
            return None
        self._peak = max(self._peak, phi)
        if phi < self._peak - margin:
            self._falling, self._valley = True, phi
            if self._bounces == self._scene.horizon.bounces:
                return Outcome.FINISHED
        return None
