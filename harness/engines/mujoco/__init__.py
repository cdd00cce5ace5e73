"""MuJoCo, adapted: the one place that imports `mujoco`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.mujoco.engine import MujocoEngine

__all__ = ["DESCRIPTION", "MujocoEngine"]

DESCRIPTION = Description(
    label="MuJoCo",
    light="#0a6fb0",
    dark="#5cb8f0",
    step_s=6e-6,
    overhead=1.05,
    overhead_of_short=1.15,
    adaptive_gain=100.0,
)

__getattr__, __dir__ = lazy_exports(__name__, {"MujocoEngine": "harness.engines.mujoco.engine"})
