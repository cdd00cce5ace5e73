"""Extrapolation of the modified midpoint rule in long double: the truth of the friction benchmark.

The method of Gragg, Bulirsch and Stoer shares nothing with the collocation of the integrator or
with the Runge-Kutta formulas of DOP853, and its long doubles have 64 bits where a machine has them
(x86); elsewhere they are doubles, and the truth is no better than those.

Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.9.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference import Problem
from tests.benchmarks.newton_euler import LONG_DOUBLE, Event, Motion

Extended = NDArray[np.longdouble]
# Substeps of the midpoint rule: their extrapolation is of order 16.
_SUBSTEPS = tuple(range(2, 18, 2))
# Some roundings of a long double, of states of size 1 or more.
_WANTED = 16 * float(np.finfo(np.longdouble).eps)
_SHORTEST = 1e-12
# Of what falls to zero at an event, forces and velocities of size 1: some of their roundings.
_ZERO = 8 * _WANTED
# Secant steps that find an event: the steps of a motion are short beside its curvature.
_MOST_SECANTS = 40


class Extrapolation:
    """A motion integrated in long double.

    Attributes
    ----------
    motion : Motion
    time : float
    y : ndarray, shape (8,), of long double
    slips : bool
    """

    def __init__(self, problem: Problem) -> None:
        self.motion = Motion.of(problem, LONG_DOUBLE)
        self.time = np.longdouble(0)
        self.y: Extended = np.array(self.motion.released(), dtype=np.longdouble)
        self.slips = problem.slip != (0.0, 0.0)
        self._length = np.longdouble(0.01)

    def integrate(self, end: float, event: Event | None) -> bool:
        """Integrate to a time, or to where a quantity falls to zero; return whether it did."""
        margin = np.inf if event is None else event(self.time, tuple(self.y))
        while self.time < end:
            length = min(self._length, np.longdouble(end) - self.time)
            y, error = self._stepped(length)
            # the error of the last but one column, of order 14
            factor = 0.9 * (_WANTED / max(error, 1e-30)) ** (1 / 15)
            if not error <= _WANTED:
                self._length = length * max(0.1, factor if np.isfinite(factor) else 0.1)
                if self._length < _SHORTEST:
                    raise RuntimeError(f"no step of {_SHORTEST:g} is resolved at {self.time}")
                continue
            before = self.time, self.y
            self.time, self.y = self.time + length, y
            if event is not None:
                last, margin = margin, event(self.time, tuple(self.y))
                if last > 0 >= margin:
                    self._back_to(event, *before, length)
                    return True
            if length == self._length:
                self._length = length * min(2.0, factor)
        return False

    def _back_to(
        self,
        event: Event,
        time: Any,
        y: Extended,
        length: Any,
    ) -> None:
        """Go to the zero of a quantity within the last step, by the Illinois method."""
        high, at_high = length, event(self.time, tuple(self.y))
        self.time, self.y = time, y
        low, at_low = np.longdouble(0), event(self.time, tuple(self.y))
        side = 0
        for _ in range(_MOST_SECANTS):
            middle = (low * at_high - high * at_low) / (at_high - at_low)
            self.time, self.y = time, y
            ahead, _ = self._stepped(middle)
            self.time, self.y = time + middle, ahead
            here = event(self.time, tuple(self.y))
            if abs(here) < _ZERO:
                return
            if here > 0:
                low, at_low, at_high = middle, here, at_high / (2 if side > 0 else 1)
            else:
                high, at_high, at_low = middle, here, at_low / (2 if side < 0 else 1)
            side = 1 if here > 0 else -1
        raise RuntimeError(f"no event was found near {self.time}")

    def _rates(self, time: Any, y: Extended) -> Extended:
        return np.array(self.motion.rates(time, tuple(y), self.slips), dtype=np.longdouble)

    def _stepped(self, length: Any) -> tuple[Extended, float]:
        """Return the state after a step, and how far apart its last two columns are."""
        table: list[Extended] = []
        first = self._rates(self.time, self.y)
        for row, substeps in enumerate(_SUBSTEPS):
            h = length / substeps
            before, here = self.y, self.y + h * first
            for k in range(1, substeps):
                rates = self._rates(self.time + k * h, here)
                before, here = here, before + 2 * h * rates
            last = self._rates(self.time + length, here)
            new = [(before + here + h * last) / 2]
            for column in range(row):
                ratio = np.longdouble(substeps) / _SUBSTEPS[row - column - 1]
                new.append(new[-1] + (new[-1] - table[column]) / (ratio * ratio - 1))
            table = new
        apart = np.abs(table[-1] - table[-2]) / np.maximum(np.abs(table[-1]), 1)
        return table[-1], float(apart.max())
