"""PyBullet, adapted: the one place that imports `pybullet`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.pybullet.engine import PybulletEngine

__all__ = ["DESCRIPTION", "PybulletEngine"]

DESCRIPTION = Description(
    label="PyBullet",
    light="#d2560a",
    dark="#ff9d5c",
    step_s=1.2e-5,
    overhead=1.10,
    overhead_of_reading=1.10,
    adaptive_gain=10.0,
)

__getattr__, __dir__ = lazy_exports(__name__, {"PybulletEngine": "harness.engines.pybullet.engine"})
