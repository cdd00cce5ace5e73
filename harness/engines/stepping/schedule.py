"""Which timestep comes next: the same always, or one that follows the motion.

Fixed steps are for comparing timesteps. Adaptive steps are for running an engine as well as it can
be run: a bounce of some 20 microseconds between falls of 30 milliseconds needs steps of
nanoseconds, and only there.

The error indicator. Near the flat state the tilt of the axis, w = phi exp(i chi) with
chi = psi sqrt(a_p/(a_p + 1)), moves on a straight line past the origin at constant speed; a first
order step of length dt misses its direction by about dt |w'|/|w|. The rule keeps that at `ETA`, and
keeps the turn of the body in a step there as well, between bounds tied to the natural time
sqrt(R/g). What a step misses on the way into a bounce is made good on the way out, but not for a
can that spins about its axis: of its turn an error is left that was measured to go with the axial
rate s and with the step, 50 ETA s sqrt(R/g) degrees. So the faster it spins, the less is allowed:
ETA/(1 + |s| sqrt(R/g)/SPIN), and no less than a hundredth of ETA: a can that spins faster still is
a top, and no step that is affordable turns it right.

The rule looks at the state alone, so it is deterministic and needs no rejected steps; steps are
powers of two, so that times are exact sums and a soft contact sees few changes of its stiffness;
and since |w| can halve at most in the time |w|/(2 |w'|), that long the step may be kept without
looking again.

A convex integrator with error control (Kurtz and Castro, "CENIC") estimates the error of a step
by step doubling and rejects what exceeds a tolerance. That serves any scene at three solves a step;
the rule here knows this one, costs no solve, and would not see an error that is not geometric.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.trajectory import Floats
from harness.engines.base import Setting
from harness.engines.stepping.recording import SamplingInterval
from models.can import Can

ETA = 0.01
"""Share of the distance to the flat state that the tilt may move in a step, and rad of turn."""

SPIN = 0.015
"""Axial rate in natural units at which half of ETA is allowed: 0.004 degrees of the turn."""

LEAST = 0.01
"""Of ETA, however fast a can spins."""

RISE_MARGIN = 1.01
"""Share of the fall that the rise is given, and what shows that it is over: an engine's bounce is
symmetric but for its own errors."""

ETA_SETTING = Setting(
    "eta",
    None,
    None,
    "Adaptive only: share of its way that the tilt moves in a step, rad of turn likewise.",
    adaptive=ETA,
    positive=True,
)
"""The one setting of adaptive stepping, the same in all engines."""

LARGEST_SHARE, SMALLEST_SHARE = 5e-4, 1e-9
"""Bounds of the timestep in natural times: outside the bounce first-order error goes with the
largest; below the smallest a position of a metre no longer feels a step of a metre a second."""

_LONGEST_STAGE = 256
"""Steps without looking again, however slow the motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Steps of one length.

    Parameters
    ----------
    timestep : float
        s.
    times : ndarray, shape (n,)
        Before each of the steps, s.
    ahead : int
        Steps of this length that are known to come, those of the stage among them.
    """

    timestep: float
    times: Floats
    ahead: int


class Schedule(ABC):
    """Gives stage after stage until the limit is reached.

    Parameters
    ----------
    largest : float
        Timestep, s.
    sampling : SamplingInterval or None
        Which steps to read, for an engine that pays for each reading; None is every step.
    """

    largest: float
    sampling: SamplingInterval | None = None

    @abstractmethod
    def next(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> Stage | None:
        """Return the stage from this state on, or None at the end.

        Parameters
        ----------
        quaternion : sequence of 4 floats
            From body to world, scalar first.
        angular_velocity : sequence of 3 floats
            In world coordinates, rad/s.
        """

    def falls(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> bool:
        """Whether a run cannot be over before the next stage is: a look before it would be idle."""
        del quaternion, angular_velocity
        return False


class Fixed(Schedule):
    """Every step alike.

    Parameters
    ----------
    timestep : float
        s.
    limit : float
        s; the last state is the last before or at it.
    size : int
        Most steps in a stage; may be changed between two stages.
    first : int, optional
        Most steps in the first stage, and four times as many in each that follows, so that what
        breaks at once is seen at once.
    fall : int, optional
        Most steps from the release on for which `falls` may hold. A rise takes as long as the fall
        before it, so that a can that has done nothing but fall goes on for as long again. Once it
        rises, its height and rate tell how long it rises still.
    """

    def __init__(
        self, timestep: float, limit: float, size: int, first: int | None = None, fall: int = 0
    ) -> None:
        self.largest = timestep
        self.size = size
        self._fall = fall
        self._fallen: list[tuple[int, float, float]] = []  # steps done, height and its rate
        self._rise = 0
        self._grown = math.inf if first is None else first
        self._done = 0
        # both ends are recorded; the share absorbs the round-off of the division
        self._total = int(limit / timestep * (1.0 + 1e-12)) + 1

    def next(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> Stage | None:
        """Return the next stage; of the state its release alone matters."""
        if self._done >= self._total:
            return None
        if not self._fallen:
            self._fallen.append((0, *_height(quaternion, angular_velocity)))
        size = self.size
        if 0 < self._done <= self._fall:
            size = max(size, self._rise or self._done)
        count = int(min(size, self._grown, self._total - self._done))
        self._grown *= 4
        # counted, not summed: an engine's own clock drifts by round-off
        times = np.arange(self._done, self._done + count) * np.float64(self.largest)
        ahead = self._total - self._done
        self._done += count
        return Stage(timestep=self.largest, times=times, ahead=ahead)

    def falls(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> bool:
        """Whether the can has done nothing but fall, and may for as many steps again, or rises."""
        if not self._fall:
            return False
        height, rate = _height(quaternion, angular_velocity)
        since, above, fell = self._fallen[-1]
        # a fall that goes on faster and faster would have come to the ground: another one is seen
        falling = 0.0 < -fell * self.largest * (self._done - since) < above or not since
        ahead = 0
        if rate > 0.0 and not self._rise:
            # a stage to the end of the first rise; what follows is seen before it is stepped
            ahead = self._rise = self._left_of_rise(height, rate)
        elif rate < 0.0 and not self._rise and height < above and falling:
            ahead = self._done
            self._fallen.append((self._done, height, rate))
        if not 0 < ahead <= self._fall - self._done:
            self._fall = 0
        return self._fall > 0

    def _left_of_rise(self, height: float, rate: float) -> int:
        """Return the steps of a rise that are left, and those that show its end; 0 if unknown.

        The rise is the fall backwards: it takes as long as the fall took to this height, which lies
        between two of the stages. There the acceleration is taken as constant, which does not hold
        where the can is about to turn: then nothing is told.
        """
        higher = [one for one in self._fallen if one[1] > height]
        lower = [one for one in self._fallen if one[1] < (1.0 - PROMINENCE) * self._fallen[0][1]]
        if not higher or not lower or rate < -0.5 * higher[-1][2]:
            return 0
        (_, top, released), (since, above, fell) = higher[0], higher[-1]
        left = since + 2.0 * (above - height) / ((rate - fell) * self.largest)
        # in steps: 1% of the height below the top, of a fall that begins at rest there
        slowing = (released - lower[0][2]) / lower[0][0]
        shown = (math.sqrt(2.0 * PROMINENCE * top * slowing / self.largest) - released) / slowing
        return math.ceil(RISE_MARGIN * (self._done + left + shown)) - self._done


class Adaptive(Schedule):
    """Steps that follow the motion.

    Parameters
    ----------
    can : Can
    largest, smallest : float
        Bounds, s; taken down to powers of two.
    limit : float
        s.
    eta : float
        The error indicator to keep where the can does not spin about its axis.
    unit : float
        Natural time of the scene, s.
    """

    def __init__(
        self, can: Can, *, largest: float, smallest: float, limit: float, eta: float, unit: float
    ) -> None:
        self.largest = power_of_two(largest)
        self._smallest = min(power_of_two(smallest), self.largest)
        self._limit = limit
        self._eta = eta
        self._unit = unit
        self._slowness = can.slowness
        self._time = 0.0
        self._ended = False

    def next(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> Stage | None:
        """Return the next stage, with the step that the state calls for."""
        if self._ended:
            return None
        rate = self.rate(quaternion, angular_velocity)
        eta = self.eta(quaternion, angular_velocity)
        if not rate * self.largest > eta:  # a rate that is no number ends with the run
            timestep = self.largest
        elif rate * self._smallest >= eta:
            timestep = self._smallest
        else:
            timestep = power_of_two(eta / rate)
        count = _LONGEST_STAGE
        if rate * timestep * count > 0.5:  # noqa: PLR2004 - half the way to the flat state
            count = max(1, int(0.5 / (rate * timestep)))
        left = int((self._limit - self._time) / timestep) + 1
        if count >= left:
            count, self._ended = left, True
        times = self._time + np.float64(timestep) * np.arange(count)
        self._time += timestep * count
        return Stage(timestep=timestep, times=times, ahead=count)

    def rate(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> float:
        """Return the rate that a step must resolve, 1/s: of the tilt's direction, or of the body.

        The horizontal part u of the axis moves with u' = (Omega x axis): its share along u is
        phi'/phi, its share across is psi'.
        """
        o_x, o_y, o_z = angular_velocity
        spin = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
        a_x, a_y, a_z = _axis(quaternion)
        square = a_x * a_x + a_y * a_y
        if square == 0.0:
            return math.inf
        v_x, v_y = o_y * a_z - o_z * a_y, o_z * a_x - o_x * a_z
        along = (a_x * v_x + a_y * v_y) / square
        across = (a_x * v_y - a_y * v_x) / square
        return max(math.hypot(along, self._slowness * across), spin)

    def eta(self, quaternion: Sequence[float], angular_velocity: Sequence[float]) -> float:
        """Return the error indicator to keep: less, the faster the can spins about its axis."""
        o_x, o_y, o_z = angular_velocity
        a_x, a_y, a_z = _axis(quaternion)
        axial = abs(a_x * o_x + a_y * o_y + a_z * o_z)
        return max(self._eta / (1.0 + axial * self._unit / SPIN), LEAST * self._eta)


def _axis(quaternion: Sequence[float]) -> tuple[float, float, float]:
    """Return the can's axis in the world."""
    w, x, y, z = quaternion
    return 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)


def _height(quaternion: Sequence[float], angular_velocity: Sequence[float]) -> tuple[float, float]:
    """Return sin(phi/2) and its derivative in time, 1/s; zero where the can is flat."""
    w, x, y, z = quaternion
    o_x, o_y, _ = angular_velocity
    height = math.sqrt(x * x + y * y)
    rising = (x * o_x + y * o_y) * w + (x * o_y - y * o_x) * z  # d(sin(phi/2)^2)/dt
    return height, rising / (2.0 * height) if height > 0.0 else 0.0


def power_of_two(value: float) -> float:
    """Return the largest power of two that is not larger."""
    return 2.0 ** math.floor(math.log2(value))
