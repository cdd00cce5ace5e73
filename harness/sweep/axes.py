"""Axes of a sweep: a parameter of the scene and its range; checks of all axes and of the sample."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.errors import InvalidSettingError
from harness.sweep.parameters import PARAMETERS, Floats, check_range, scene_at
from models.errors import InvalidValueError, ModelError
from models.scene import Scene

_FORM = "NAME=LOW:HIGH:COUNT for a grid, NAME=LOW:HIGH for a sample, log:LOW:HIGH for decades"
_ENDS = 2

_ROUND_OFF = 1e-9
"""Of a power of a logarithm, some eps times the exponent, over the number: far less than to the
next whole number, of which there are 100,000."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """A parameter and its range.

    Parameters
    ----------
    name : str
        Of the parameter.
    low, high : float
        In the parameter's unit; both ends are part of a grid.
    count : int or None
        Values of a grid; None for a sample.
    log : bool
        Spaced by ratio and not by difference.

    Raises
    ------
    InvalidSettingError
        If there is no such parameter, or it cannot have such values.
    """

    name: str
    low: float
    high: float
    count: int | None = None
    log: bool = False

    def __post_init__(self) -> None:
        """Refuse a range that no scene can have."""
        check_range(self.name, self.low, self.high)
        if self.log and not (self.low > 0.0 and self.high > 0.0):
            raise InvalidSettingError(
                f"--over {self.name}",
                f"log:{self.low:g}:{self.high:g}",
                "two ends greater than zero: a logarithm has no others",
            )
        if self.count is not None and self.count < 1:
            raise InvalidSettingError(f"--over {self.name}", self.count, "a count of 1 or more")
        if PARAMETERS[self.name].whole:
            self._check_whole()

    def _check_whole(self) -> None:
        """Refuse values between the whole numbers."""
        fits = self.low.is_integer() and self.high.is_integer()
        if fits and self.count is not None:
            fits = self.count <= abs(self.high - self.low) + 1.0
            if fits:  # no more than there are whole numbers, so the array is short
                values = self._spaced(np.arange(self.count))
                fits = bool((np.abs(values - np.rint(values)) < _ROUND_OFF * values).all())
        if not fits:
            raise InvalidSettingError("--over", self.text(), "ends and values on whole numbers")

    @property
    def column(self) -> str:
        """Its column in the table, unit last."""
        return PARAMETERS[self.name].column

    @property
    def label(self) -> str:
        """Its label in a figure, with the unit in brackets."""
        unit = PARAMETERS[self.name].unit
        return f"{self.name} [{unit}]" if unit else self.name

    def values(self, places: NDArray[np.intp]) -> Floats:
        """Return values of a grid at these places, those of `linspace` or `geomspace` bit for bit.

        Each value follows from its place alone, so that a long axis takes no memory.

        Parameters
        ----------
        places : ndarray of int
            From 0 for `low` to `count` - 1 for `high`.
        """
        values = self._spaced(places)
        return np.rint(values) if PARAMETERS[self.name].whole else values

    def _spaced(self, places: NDArray[np.intp]) -> Floats:
        """Return values of a grid before rounding to whole numbers."""
        last, ends = (self.count or 1) - 1, np.array((self.low, self.high))
        if not self.log:
            return _evenly(ends, last, places)
        values: Floats = np.power(10.0, _evenly(np.log10(ends), last, places))
        values[places == last] = self.high  # a power of a logarithm is not where it was
        values[places == 0] = self.low
        return values

    def at(self, share: Floats) -> Floats:
        """Return the values at shares in [0, 1] of the way, shape of `share`.

        Of a count each whole number takes as much of the way as the others, up to the next.
        """
        if PARAMETERS[self.name].whole:
            low, high = sorted((self.low, self.high))
            beyond = high + 1.0
            way = low * (beyond / low) ** share if self.log else low + (beyond - low) * share
            return np.minimum(np.floor(way), high)
        if not self.log:
            return self.low + (self.high - self.low) * share
        return np.asarray(self.low * (self.high / self.low) ** share, dtype=np.float64)

    def share(self, value: Floats) -> Floats:
        """Return where values lie on the way from low to high, shape of `value`."""
        if self.low == self.high:
            return np.zeros_like(value)
        if self.log:
            way = np.log(value / self.low) / math.log(self.high / self.low)
        else:
            way = (value - self.low) / (self.high - self.low)
        return np.asarray(way, dtype=np.float64)

    def text(self) -> str:
        """Return the axis as it is typed."""
        count = "" if self.count is None else f":{self.count}"
        return f"{self.name}={'log:' if self.log else ''}{self.low!r}:{self.high!r}{count}"


def _evenly(ends: Floats, last: int, places: NDArray[np.intp]) -> Floats:
    """Return low + (high - low) place / last, by numpy's own operations in numpy's own order."""
    low, high = ends
    way = high - low
    if not last:
        return np.asarray(places * way + low, dtype=np.float64)
    step = way / last
    # in a range of denormal numbers a step underflows to zero
    steps = places / np.float64(last) * way if step == 0.0 else places * step
    values: Floats = steps + low
    values[places == last] = high
    return values


def read_axis(text: str) -> Axis:
    """Return the axis that a text such as ``release.psi_dot=-1:1:401`` stands for.

    Raises
    ------
    InvalidSettingError
        If it is of another form, or no scene can have such values.
    """
    name, equals, rest = text.partition("=")
    log = rest.startswith("log:")
    parts = rest.removeprefix("log:").split(":")
    if not equals or len(parts) not in {_ENDS, _ENDS + 1}:
        raise InvalidSettingError("--over", text, _FORM)
    try:
        low, high = (float(part) for part in parts[:_ENDS])
        count = int(parts[_ENDS]) if len(parts) > _ENDS else None
    except ValueError:
        raise InvalidSettingError("--over", text, _FORM) from None
    return Axis(name=name, low=low, high=high, count=count, log=log)


SAMPLES = ("grid", "random", "sobol", "halton")
"""How the scenes are chosen."""


def checked_scene(scene: Scene, axes: Sequence[Axis]) -> Scene:
    """Return the scene that is checked for all of a sweep: lowest effects, longest run."""
    values = {axis.name: axis.low for axis in axes if _of_effects(axis)}
    values |= {
        axis.name: max(axis.low, axis.high) for axis in axes if axis.name.startswith("horizon.")
    }
    return scene_at(scene, values)


def check_axes(scene: Scene, axes: Sequence[Axis]) -> None:
    """Refuse no axis, one parameter twice, and constants that no effect has.

    Raises
    ------
    InvalidSettingError
    """
    names = [axis.name for axis in axes]
    if not names:
        raise InvalidSettingError("--over", "nothing", "at least one parameter to vary")
    for name in names:
        group = f"can.{name[-1].lower()}" if name in {"can.A", "can.C", "can.H"} else ""
        if names.count(name) > 1 or group in names:
            raise InvalidSettingError("--over", name, "each parameter once, as group or in SI")
    if {"horizon.bounces", "horizon.seconds"} <= set(names):
        only = "a number of bounces or a time: a run ends by one of them"
        raise InvalidSettingError("--over", "horizon.bounces and horizon.seconds", only)
    for axis in filter(_of_effects, axes):
        for end in (axis.low, axis.high):
            try:
                scene_at(scene, {axis.name: end})
            except InvalidValueError as error:
                own = error.key == axis.name.rpartition(".")[2]
                allowed = error.allowed if own else f"with `{error.key}` {error.allowed}"
                raise InvalidSettingError(f"--over {axis.name}", end, allowed) from None
            except ModelError as error:
                raise InvalidSettingError(f"--over {axis.name}", end, str(error)) from None
            except TypeError:
                effect = axis.name.rpartition(".")[0]
                only = f"nothing, unless the scene itself declares `{effect}` with its constants"
                raise InvalidSettingError(f"--over {axis.name}", end, only) from None


def check_sample(axes: Sequence[Axis], sample: str, count: int | None, seed: int | None) -> None:
    """Refuse a grid without counts on its axes, and a sample with them.

    Raises
    ------
    InvalidSettingError
    """
    if sample not in SAMPLES:
        raise InvalidSettingError("--sample", sample, ", ".join(SAMPLES))
    for axis in axes:
        if sample == "grid" and axis.count is None:
            raise InvalidSettingError("--over", axis.text(), "NAME=LOW:HIGH:COUNT in a grid")
        if sample != "grid" and axis.count is not None:
            raise InvalidSettingError(
                "--over", axis.text(), f"NAME=LOW:HIGH in a {sample} sample; --count says how many"
            )
    if sample == "grid" and (count is not None or seed is not None):
        raise InvalidSettingError(
            "--sample", sample, "random, sobol or halton beside --count and --seed"
        )
    if sample != "grid" and (count is None or count < 1):
        raise InvalidSettingError("--count", count, f"a whole number of {sample} scenes, 1 or more")
    if seed is not None and seed < 0:
        raise InvalidSettingError("--seed", seed, "zero or greater")


def _of_effects(axis: Axis) -> bool:
    return axis.name.startswith("effects.")
