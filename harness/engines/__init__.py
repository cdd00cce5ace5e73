"""Everything that moves a can, each behind one role; the one import path for adapters.

An adapter imports all that it needs from here, and this path stays:

    from harness.engines import Capabilities, Chunk, PhysicsEngine, Schedule, Setting
"""

from harness.core.case import PROFILES, Case, Value
from harness.core.errors import (
    HarnessError,
    InvalidSettingError,
    MissingLibraryError,
    RefusedModelError,
)
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Floats, Integers, Trajectory
from harness.engines.base import (
    COMMON,
    TIMESTEP,
    Capabilities,
    Engine,
    EngineFeatures,
    ModelDifference,
    Setting,
    SolverEffort,
    Variant,
    resolve,
)
from harness.engines.can_mesh import (
    MESH_SETTING,
    Mesh,
    hull_triangles,
    mesh_points,
    obj_text,
    outline_gap,
    prism,
)
from harness.engines.description import Description, Method, Precision
from harness.engines.linearised import LinearisedMotion
from harness.engines.parity.checks import SMALLEST_TILT, rim_within
from harness.engines.parity.contact import (
    FRICTIONS,
    TWO_DIRECTIONS,
    bounded_separately,
    declared_friction,
    probed_depth,
)
from harness.engines.stepping.generic_stepping import (
    StageReader,
    contact_of,
    step_by_stages,
    take_stage,
    walk,
)
from harness.engines.stepping.physics_engine import ErrorControlledEngine, PhysicsEngine
from harness.engines.stepping.recording import Chunk, SamplingInterval, record, trajectory_of
from harness.engines.stepping.schedule import ETA_SETTING, Adaptive, Fixed, Schedule, Stage
from harness.engines.stepping.settling import AT_REST, above_origin, pressed_distance, settle
from harness.engines.world import NO_POINTS, Collision, Contact, World

__all__ = [
    "AT_REST",
    "COMMON",
    "ETA_SETTING",
    "FRICTIONS",
    "MESH_SETTING",
    "NO_POINTS",
    "PROFILES",
    "SMALLEST_TILT",
    "TIMESTEP",
    "TWO_DIRECTIONS",
    "Adaptive",
    "Capabilities",
    "Case",
    "Chunk",
    "Collision",
    "Contact",
    "Description",
    "Engine",
    "EngineFeatures",
    "ErrorControlledEngine",
    "Fixed",
    "Floats",
    "HarnessError",
    "Integers",
    "InvalidSettingError",
    "LinearisedMotion",
    "Mesh",
    "Method",
    "MissingLibraryError",
    "ModelDifference",
    "Outcome",
    "PhysicsEngine",
    "Precision",
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
    "above_origin",
    "bounded_separately",
    "contact_of",
    "declared_friction",
    "hull_triangles",
    "mesh_points",
    "obj_text",
    "outline_gap",
    "pressed_distance",
    "prism",
    "probed_depth",
    "record",
    "resolve",
    "rim_within",
    "settle",
    "step_by_stages",
    "take_stage",
    "trajectory_of",
    "walk",
]
