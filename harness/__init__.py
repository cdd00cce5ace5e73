"""Hold multibody engines against the exact motion of a rocking can."""

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
