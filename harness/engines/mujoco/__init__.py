"""MuJoCo, adapted: the one place that imports `mujoco`."""

from harness.engines.mujoco.engine import MujocoEngine

__all__ = ["MujocoEngine"]
