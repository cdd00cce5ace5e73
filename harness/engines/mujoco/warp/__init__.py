"""MuJoCo Warp, adapted: MuJoCo's equations as kernels of Warp."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Precision

if TYPE_CHECKING:
    from harness.engines.mujoco.warp.engine import WarpEngine

__all__ = ["DESCRIPTION", "WarpEngine"]

DESCRIPTION = Description(
    label="MuJoCo Warp",
    light="#7333f3",
    dark="#a60aff",
    precision=Precision.SINGLE,
    by_default=False,
    compiles=True,
    step_s=6e-5,
)

__getattr__, __dir__ = lazy_exports(__name__, {"WarpEngine": "harness.engines.mujoco.warp.engine"})
