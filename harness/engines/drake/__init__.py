"""Drake, adapted: a discrete plant, and in `cenic` a continuous one; all that imports `pydrake`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.drake.engine import DrakeEngine

__all__ = ["DESCRIPTION", "DrakeEngine"]

DESCRIPTION = Description(
    label="Drake",
    light="#881774",
    dark="#995967",
    by_default=False,
    step_s=1.5e-4,
)

__getattr__, __dir__ = lazy_exports(__name__, {"DrakeEngine": "harness.engines.drake.engine"})
