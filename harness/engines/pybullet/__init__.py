"""PyBullet, adapted: the one place that imports `pybullet`."""

from harness.engines.pybullet import world  # noqa: F401 - first: it imports pybullet in silence
from harness.engines.pybullet.engine import PybulletEngine

__all__ = ["PybulletEngine"]
