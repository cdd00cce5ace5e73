"""PyBullet, adapted: the one place that imports `pybullet`."""

from harness.engines.pybullet import suppress_output  # noqa: F401 - first: imports pybullet silently
from harness.engines.pybullet.engine import PybulletEngine

__all__ = ["PybulletEngine"]
