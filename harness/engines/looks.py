"""After how many steps to look again, where a look costs more than a step.

The recorder keeps a sample whenever the path of the angles has grown by `ANGLE_STEP`, or time by
its own share. From a state alone follows how fast that path grows, so an engine that pays for each
reading need not read every step of a slow motion: `LOOKS` times between two samples are enough, and
where the can races round its rim that is every step.

What the rate may do in between. Near the flat state the path grows with 1/phi^2, so a pause also
ends before phi has changed by `CHANGE`; a contact that is lost or made changes the rates
themselves, by what a fall gives, sqrt(g/R), and a pause ends before that could have changed phi by
as much.
"""

import math
from collections.abc import Sequence

from harness.engines.recorder import ANGLE_STEP, SAMPLES_IN_TIME

LOOKS = 2.0
"""Looks from one sample to the next: samples lie at most half their spacing late."""

CHANGE = 0.1
"""Share of phi, or of sin(phi/2), that may change unseen: a fifth of the rate of the path."""

_OFTEN, _CHANGING = LOOKS / ANGLE_STEP, 0.5 / CHANGE


class Looks:
    """Says of a run, look by look, how many steps to take until the next.

    Parameters
    ----------
    interval : float
        Time between two samples where no angle moves, s.
    """

    def __init__(self, interval: float) -> None:
        self._often = LOOKS / interval
        self._fall = 1.0 / (SAMPLES_IN_TIME * interval)
        self._due = 0.0
        self.left = 0

    def spare(self, timestep: float) -> bool:
        """Whether a step of this length, s, is ever to be taken without a look."""
        return self._often * timestep <= 1.0 / LOOKS

    def steps(self, timestep: float) -> float:
        """Return the steps of this length, s, from one look to the next where no angle moves."""
        return 1.0 / (self._often * timestep)

    def pause(
        self, quaternion: Sequence[float], angular_velocity: Sequence[float], timestep: float
    ) -> int:
        """Return the steps from a state to the next that is worth a look, at least one.

        The share of a step that is left over counts towards the next pause, so that looks do not
        fall into step with an engine that does something every other step.

        Parameters
        ----------
        quaternion : sequence of 4 floats
            From body to world, scalar last.
        angular_velocity : sequence of 3 floats
            In world coordinates, rad/s.
        timestep : float
            s.
        """
        x, y, z, w = quaternion
        o_x, o_y, o_z = angular_velocity
        tilted, upright = x * x + y * y, w * w + z * z
        if tilted == 0.0 or upright == 0.0:
            return 1
        # half angles as the recorder's, cos(phi/2) exp(i (psi + theta)/2) = w + i z and
        # sin(phi/2) exp(i (psi - theta)/2) = x + i y, and twice their derivatives
        d_w, d_z = -o_x * x - o_y * y - o_z * z, o_z * w + o_x * y - o_y * x
        d_x, d_y = o_x * w + o_y * z - o_z * y, o_y * w + o_z * x - o_x * z
        rocked = abs(x * d_x + y * d_y) / math.sqrt(tilted * upright)
        path = rocked + abs(w * d_z - z * d_w) / upright + abs(x * d_y - y * d_x) / tilted
        rate = _OFTEN * path + self._often
        change = _CHANGING * (rocked + self._fall) * math.sqrt(upright / tilted)
        due = self._due + 1.0 / (max(rate, change) * timestep)
        if not due >= 1.0:  # no number, where the state holds none
            self._due = 0.0
            return 1
        steps = int(due)
        self._due = due - steps
        return steps
