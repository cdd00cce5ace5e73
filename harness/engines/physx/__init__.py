"""PhysX 5, adapted: the one place that imports `ovphysx`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Precision

if TYPE_CHECKING:
    from harness.engines.physx.engine import PhysxEngine

__all__ = ["DESCRIPTION", "PhysxEngine"]

DESCRIPTION = Description(
    label="PhysX",
    light="#b9738d",
    dark="#b821ae",
    precision=Precision.SINGLE,
    by_default=False,
    step_s=2e-4,
)

__getattr__, __dir__ = lazy_exports(__name__, {"PhysxEngine": "harness.engines.physx.engine"})
