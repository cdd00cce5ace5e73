"""Everything that moves a can, each behind one role; the one import path for adapters.

An adapter imports all that it needs from here, and this path stays:

    from harness.engines import Capabilities, Chunk, PhysicsEngine, Schedule, Setting
"""

from harness.core.case import Case, Value
from harness.core.errors import HarnessError, RefusedModelError
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Floats, Integers, Trajectory
from harness.engines.base import (
    COMMON,
    TIMESTEP,
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
from harness.engines.stepping.generic_stepping import (
    StageReader,
    step_by_stages,
    take_stage,
    walk,
)
from harness.engines.stepping.physics_engine import PhysicsEngine
from harness.engines.stepping.recording import Chunk, SamplingInterval, record, trajectory_of
from harness.engines.stepping.schedule import ETA_SETTING, Adaptive, Fixed, Schedule, Stage
from harness.engines.stepping.settling import settle

__all__ = [
    "COMMON",
    "ETA_SETTING",
    "TIMESTEP",
    "Adaptive",
    "Capabilities",
    "Case",
    "Chunk",
    "Contact",
    "Engine",
    "EngineFeatures",
    "Fixed",
    "Floats",
    "HarnessError",
    "Integers",
    "ModelDifference",
    "Outcome",
    "PhysicsEngine",
    "RefusedModelError",
    "SamplingInterval",
    "Schedule",
    "Setting",
    "Simulation",
    "SolverEffort",
    "Stage",
    "StageReader",
    "Trajectory",
    "Value",
    "Variant",
    "World",
    "record",
    "resolve",
    "settle",
    "step_by_stages",
    "take_stage",
    "trajectory_of",
    "walk",
]
