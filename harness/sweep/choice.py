"""Which scenes a sweep may choose: its axes together, and how points on them are taken."""

from collections.abc import Sequence

from harness.errors import InvalidSettingError
from harness.sweep.axes import Axis
from harness.sweep.parameters import scene_at
from models.errors import InvalidValueError, ModelError
from models.scene import Scene

SAMPLES = ("grid", "random", "sobol", "halton")
"""How the scenes are chosen."""


def end_of(scene: Scene, axes: Sequence[Axis]) -> Scene:
    """Return the scene that is checked for all: its effects at their lowest, the longest run."""
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
