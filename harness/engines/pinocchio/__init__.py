"""Pinocchio, adapted: the one place that imports `pinocchio` and `coal`, its collision library."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.pinocchio.engine import PinocchioEngine

__all__ = ["DESCRIPTION", "PinocchioEngine"]

DESCRIPTION = Description(
    label="Pinocchio",
    light="#664246",
    dark="#c03a29",
    by_default=False,
    step_s=1e-4,
)

__getattr__, __dir__ = lazy_exports(
    __name__, {"PinocchioEngine": "harness.engines.pinocchio.engine"}
)
