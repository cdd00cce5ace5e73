"""Hold multibody engines against the exact motion of a rocking can."""

from typing import TYPE_CHECKING

from harness.core.public_paths import install, lazy_exports

if TYPE_CHECKING:
    from harness.api import Comparison, compare, plot, simulate, validate
    from harness.core.case import Case
    from harness.core.errors import HarnessError
    from harness.core.simulation import Outcome, Simulation
    from harness.engines.registry import names as engine_names
    from harness.evaluation.evaluation import Evaluation
    from harness.studies.study import run_study
    from models.catalogue import load as load_scene
    from models.catalogue import names as scene_names
    from models.scene import Scene

__all__ = [
    "Case",
    "Comparison",
    "Evaluation",
    "HarnessError",
    "Outcome",
    "Scene",
    "Simulation",
    "compare",
    "engine_names",
    "load_scene",
    "plot",
    "run_study",
    "scene_names",
    "simulate",
    "validate",
]

install()

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Case": "harness.core.case",
        "Comparison": "harness.api",
        "Evaluation": "harness.evaluation.evaluation",
        "HarnessError": "harness.core.errors",
        "Outcome": "harness.core.simulation",
        "Scene": "models.scene",
        "Simulation": "harness.core.simulation",
        "compare": "harness.api",
        "engine_names": "harness.engines.registry:names",
        "load_scene": "models.catalogue:load",
        "plot": "harness.api",
        "run_study": "harness.studies.study",
        "scene_names": "models.catalogue:names",
        "simulate": "harness.api",
        "validate": "harness.api",
    },
)
