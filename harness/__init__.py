"""Hold multibody engines against the exact motion of a rocking can.

What is public is imported when it is first asked for: the program hears signals before that.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.api import compare, simulate, validate
    from harness.core.case import Case
    from harness.core.errors import HarnessError
    from harness.core.simulation import Outcome, Simulation
    from harness.engines.registry import names as engine_names
    from harness.evaluation.evaluation import Evaluation
    from models.catalogue import load as load_scene
    from models.catalogue import names as scene_names
    from models.scene import Scene

__all__ = [
    "Case",
    "Evaluation",
    "HarnessError",
    "Outcome",
    "Scene",
    "Simulation",
    "compare",
    "engine_names",
    "load_scene",
    "scene_names",
    "simulate",
    "validate",
]

_PLACES = {
    "Case": "harness.core.case:Case",
    "Evaluation": "harness.evaluation.evaluation:Evaluation",
    "HarnessError": "harness.core.errors:HarnessError",
    "Outcome": "harness.core.simulation:Outcome",
    "Scene": "models.scene:Scene",
    "Simulation": "harness.core.simulation:Simulation",
    "compare": "harness.api:compare",
    "engine_names": "harness.engines.registry:names",
    "load_scene": "models.catalogue:load",
    "scene_names": "models.catalogue:names",
    "simulate": "harness.api:simulate",
    "validate": "harness.api:validate",
}


def __getattr__(name: str) -> object:
    """Import a public name."""
    if name not in _PLACES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    module, _, inner = _PLACES[name].partition(":")
    globals()[name] = found = getattr(import_module(module), inner)
    return found


def __dir__() -> list[str]:
    """Return the public names, imported or not."""
    return sorted({*globals(), *__all__})
