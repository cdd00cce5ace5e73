"""Newton, adapted: the one place that imports `newton`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Precision

if TYPE_CHECKING:
    from harness.engines.newton.engine import NewtonEngine

__all__ = ["DESCRIPTION", "NewtonEngine"]

DESCRIPTION = Description(
    label="Newton",
    light="#fe00df",
    dark="#aa7ea0",
    precision=Precision.SINGLE,
    by_default=False,
    compiles=True,
    step_s=2e-4,
)

__getattr__, __dir__ = lazy_exports(__name__, {"NewtonEngine": "harness.engines.newton.engine"})
