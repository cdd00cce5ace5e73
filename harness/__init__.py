"""Hold multibody engines against the exact motion of a rocking can.

What is public is imported when it is first asked for: the program hears signals before that.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.case import Case
    from harness.engines.registry import names as engine_names
    from harness.errors import HarnessError
    from harness.face import compare, simulate, validate
    from harness.runner import Evaluation
    from harness.simulation import Outcome, Simulation
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
    "Case": "harness.case:Case",
    "Evaluation": "harness.runner:Evaluation",
    "HarnessError": "harness.errors:HarnessError",
    "Outcome": "harness.simulation:Outcome",
    "Scene": "models.scene:Scene",
    "Simulation": "harness.simulation:Simulation",
    "compare": "harness.face:compare",
    "engine_names": "harness.engines.registry:names",
    "load_scene": "models.catalogue:load",
    "scene_names": "models.catalogue:names",
    "simulate": "harness.face:simulate",
    "validate": "harness.face:validate",
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
