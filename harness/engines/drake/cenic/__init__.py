"""Drake with a continuous plant, whose integrator chooses its steps by their error."""

from typing import TYPE_CHECKING

from harness.core.public_paths import lazy_exports
from harness.engines.description import Description, Method

if TYPE_CHECKING:
    from harness.engines.drake.cenic.engine import CenicEngine

__all__ = ["DESCRIPTION", "CenicEngine"]

DESCRIPTION = Description(
    label="Drake CENIC",
    light="#3e0f8e",
    dark="#f8c9f3",
    method=Method.ERROR_CONTROL,
    accuracy_setting="accuracy",
    accuracies=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    tells_forces=False,
    by_default=False,
    step_s=5e-4,
)

__getattr__, __dir__ = lazy_exports(__name__, {"CenicEngine": "harness.engines.drake.cenic.engine"})
