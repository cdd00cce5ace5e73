"""How long to step before looking at the horizon again.

A look costs as much as a hundred steps and steps past the end are in vain. Where the end will be is
not known, but rocking is symmetric in time: a rise takes about as long as the fall before it, and a
run ends soon after a can has risen, or at a time that is given. What is foreseen here decides how a
run is cut into chunks, and nothing else.
"""

import numpy as np

from harness.engines.horizon import natural_time
from harness.trajectory import Trajectory
from models.kinematics import half_angles
from models.scene import Scene

SHORTEST = 0.05
"""Natural times sqrt(R/g) between two looks where the end is near, or nothing is known yet."""

_MARGIN = 1.02
"""Share of the fall that the rise is given: past its end, so that it is seen to be over."""


class Foresight:
    """Follows the samples of a run and foresees its end.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Scene) -> None:
        self._shortest = SHORTEST * natural_time(scene)
        self._timed = scene.horizon.seconds is not None
        self._rising = False
        self._turned = self._now = self._fall = 0.0
        self._extreme = -scene.release.phi

    def see(self, kept: Trajectory) -> None:
        """Take samples into account that follow those before; one turn of the tilt is enough."""
        self._now = float(kept.time[-1])
        phi = half_angles(kept.quaternion)[0]
        height = phi if self._rising else -phi
        at = int(np.argmax(height))
        if height[at] >= self._extreme:
            self._extreme, extreme = float(height[at]), float(kept.time[at])
        else:
            extreme = float(kept.time[0])
        if at < len(phi) - 1:
            self._fall, self._turned = extreme - self._turned, extreme
            self._rising, self._extreme = not self._rising, -float(height[-1])

    def ahead(self) -> float:
        """Return the time to step before looking again, s."""
        if self._timed:
            return np.inf
        since = self._now - self._turned
        if self._rising:
            left = _MARGIN * self._fall - since  # a rise takes as long as the fall
        else:
            # as long as the fall has taken; half of it where the run may end soon after a rise
            left = since if self._turned == 0.0 else since / 2.0
        return max(left, self._shortest)
