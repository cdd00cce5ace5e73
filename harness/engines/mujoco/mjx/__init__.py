"""MJX, adapted: MuJoCo's equations in JAX."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Precision

if TYPE_CHECKING:
    from harness.engines.mujoco.mjx.engine import MjxEngine

__all__ = ["DESCRIPTION", "MjxEngine"]

DESCRIPTION = Description(
    label="MJX",
    light="#1c98f4",
    dark="#7877ef",
    precision=Precision.DOUBLE,
    by_default=False,
    compiles=True,
    step_s=1.5e-4,
)

__getattr__, __dir__ = lazy_exports(__name__, {"MjxEngine": "harness.engines.mujoco.mjx.engine"})
