"""PyBullet, imported without the line that it prints."""

from harness.engines.suppress_output import silence

__all__ = ["pybullet"]

with silence():
    import pybullet
