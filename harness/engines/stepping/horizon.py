"""When a run of an engine ends: at its horizon, or earlier because nothing more will come.

A bounce is a minimum of phi between two maxima that both stand out from it. The watch sees the
recorded samples, which are dense in angle, and so misses none.
"""

import math

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome
from harness.core.trajectory import Floats
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

    def over(self, time: Floats, velocity: Floats, phi: Floats) -> Outcome | None:
        """Return how the run ended if these samples end it (at `ended_at`, s), else None.

        Parameters
        ----------
        time, phi : ndarray, shape (n,)
            That follow those before, s, and nutation in rad.
        velocity : ndarray, shape (n, 3)
            m/s.
        """
        largest = np.fmax(np.fmax.accumulate(phi), self._largest)
        margin = PROMINENCE * largest
        stop, outcome, last_up = len(phi), None, self._last_up
        if self._may_end(time, velocity, float(largest[-1])):
            stop, outcome, last_up = self._end(time, velocity, phi, margin)
        else:
            above = np.flatnonzero(phi > margin)
            last_up = float(time[above[-1]]) if len(above) else last_up
        closed = self._closed(phi[:stop], margin[:stop])
        if closed is not None:
            self.ended_at = float(time[closed])
            return Outcome.FINISHED
        if outcome is not None:
            self.ended_at = float(time[stop])
        self._largest, self._last_up = float(largest[-1]), last_up
        return outcome

    def _may_end(self, time: Floats, velocity: Floats, largest: float) -> bool:
        """Whether a look at each sample may find an end other than a bounce's; few numbers tell."""
        fastest = float(np.abs(velocity).max())
        sound = 3.0 * fastest * fastest <= _LARGEST_GAIN * self._scale  # false for no number
        return not sound or largest >= math.pi / 2.0 or time[-1] - self._last_up > self._patience

    def _end(
        self, time: Floats, velocity: Floats, phi: Floats, margin: Floats
    ) -> tuple[int, Outcome | None, float]:
        """Return the first sample that ends the run, if any, how, and when phi was up last."""
        sound = np.sum(velocity**2, axis=1) <= _LARGEST_GAIN * self._scale
        up = np.fmax(np.fmax.accumulate(np.where(phi > margin, time, 0.0)), self._last_up)
        overturned = phi >= math.pi / 2.0
        ends = ~sound | overturned | (time - up > self._patience)
        if not ends.any():
            return len(phi), None, float(up[-1])
        stop = int(np.argmax(ends))
        if not sound[stop]:
            return stop, Outcome.DIVERGED, float(up[-1])
        outcome = Outcome.OVERTURNED if overturned[stop] else Outcome.FLAT
        return stop, outcome, float(up[-1])

    def _closed(self, phi: Floats, margin: Floats) -> int | None:
        """Follow falls and rises; return which sample shows the last bounce closed, if one does."""
        start = 0
        while start < len(phi):
            left, around = phi[start:], margin[start:]
            if self._falling:
                extreme = np.fmin(np.fmin.accumulate(left), self._valley)
                turned = left > extreme + around
            else:
                extreme = np.fmax(np.fmax.accumulate(left), self._peak)
                turned = left < extreme - around
            at = int(np.argmax(turned)) if turned.any() else -1
            if self._falling:
                self._valley = float(extreme[at])
            else:
                self._peak = float(extreme[at])
            if at < 0:
                return None
            start += at + 1
            if self._falling:
                self._bounces += self._peak > self._valley + float(around[at])
                self._falling, self._peak = False, float(left[at])
            else:
                self._falling, self._valley = True, float(left[at])
                if self._bounces == self._scene.horizon.bounces:
                    return start - 1
        return None
