"""Everything that moves a can, each behind one role; the one import path for adapters.

An adapter imports all that it needs from here, and this path stays:

    from harness.engines import Capabilities, Chunk, PhysicsEngine, Schedule, Setting
"""

from harness.core.case import Case, Value
from harness.core.errors import HarnessError, RefusedModelError
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Trajectory
from harness.engines.base import (
    Capabilities,
    Contact,
    Engine,
    EngineFeatures,
    ModelDifference,
    Setting,
    SolverEffort,
    Variant,
    World,
    resolve,
)
from harness.engines.stepping.generic_stepping import walk
from harness.engines.stepping.physics_engine import PhysicsEngine
from harness.engines.stepping.recording import Chunk
from harness.engines.stepping.schedule import ETA_SETTING, Adaptive, Fixed, Schedule, Stage

__all__ = [
    "ETA_SETTING",
    "Adaptive",
    "Capabilities",
    "Case",
    "Chunk",
    "Contact",
    "Engine",
    "EngineFeatures",
    "Fixed",
    "HarnessError",
    "ModelDifference",
    "Outcome",
    "PhysicsEngine",
    "RefusedModelError",
    "Schedule",
    "Setting",
    "Simulation",
    "SolverEffort",
    "Stage",
    "Trajectory",
    "Value",
    "Variant",
    "World",
    "resolve",
    "walk",
]
