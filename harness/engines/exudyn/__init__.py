"""Exudyn, adapted: the one place that imports `exudyn`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Method

if TYPE_CHECKING:
    from harness.engines.exudyn.engine import ExudynEngine

__all__ = ["DESCRIPTION", "ExudynEngine"]

DESCRIPTION = Description(
    label="Exudyn",
    light="#003200",
    dark="#5aff28",
    method=Method.CONSTRAINT,
    by_default=False,
    step_s=2.5e-5,
)

__getattr__, __dir__ = lazy_exports(__name__, {"ExudynEngine": "harness.engines.exudyn.engine"})
