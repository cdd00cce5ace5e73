"""Open Dynamics Engine, adapted: the one place that imports `odepy`, its binding by ctypes."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.ode.engine import OdeEngine

__all__ = ["DESCRIPTION", "OdeEngine"]

DESCRIPTION = Description(
    label="ODE",
    light="#6f8f5f",
    dark="#8cb294",
    by_default=False,
    step_s=3e-5,
)

__getattr__, __dir__ = lazy_exports(__name__, {"OdeEngine": "harness.engines.ode.engine"})
