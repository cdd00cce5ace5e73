"""DART, adapted: the one place that imports `dartpy`."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description

if TYPE_CHECKING:
    from harness.engines.dart.engine import DartEngine

__all__ = ["DESCRIPTION", "DartEngine"]

DESCRIPTION = Description(
    label="DART",
    light="#3c561c",
    dark="#aff3a0",
    by_default=False,
    step_s=2e-5,
)

__getattr__, __dir__ = lazy_exports(__name__, {"DartEngine": "harness.engines.dart.engine"})
