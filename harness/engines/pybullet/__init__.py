"""PyBullet, adapted: the one place that imports `pybullet`."""

from harness.engines.pybullet.engine import PybulletEngine

__all__ = ["PybulletEngine"]
