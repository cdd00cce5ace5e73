"""Drake's CENIC as an engine: convex contact problems at steps that follow from their error.

Each step of the integrator is a state of the run; where the can touches is looked up for those
alone that are recorded.
"""

from collections.abc import Iterator
from importlib.metadata import version

import numpy as np

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    ErrorControlledEngine,
    Floats,
    Schedule,
    Trajectory,
    Value,
    trajectory_of,
)
from harness.engines.drake.cenic import DESCRIPTION
from harness.engines.drake.cenic import settings as declared
from harness.engines.drake.cenic.world import CenicWorld, Steps
from harness.engines.drake.plant import unit
from harness.engines.drake.settings import POINTS, as_python

_PASTE = """
# of a simulator of the diagram that is built:
# from pydrake.systems.analysis import ApplySimulatorConfig
from pydrake.systems.analysis import SimulatorConfig
simulator_config = SimulatorConfig(
    integration_scheme="cenic", accuracy={accuracy!r}, max_step_size={max_step_size!r}
)
# ApplySimulatorConfig(simulator_config, simulator)
"""

_PER_CONTACT = 3
"""Rows of a contact: a normal and two of friction."""


class CenicEngine(ErrorControlledEngine[CenicWorld]):
    """Drake: a continuous plant, integrated with error control."""

    name = "drake-cenic"
    description = DESCRIPTION
    settings = declared.SETTINGS
    model_differences = declared.MODEL_DIFFERENCES
    variants = declared.VARIANTS
    colliders = POINTS
    capabilities = Capabilities(
        honours=frozenset({"slip", "tilt", "point_mass"}),
        imposes={
            "friction of another load": "the load of the step before bounds it: of a contact that "
            "is stiff that load is round-off, and what slides meets another friction",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("drake")

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide."""
        del timestep
        return declared.for_effects(case)

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which CENIC goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case))

    def open(self, case: Case) -> CenicWorld:
        """Open a world with the scene of a case."""
        return CenicWorld(case, self.resolve(case), self.interval(case))

    def chunks(self, world: CenicWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Advance to the end of a schedule, yielding after `size` steps or more."""
        while True:
            steps = world.advance(schedule.largest, size)
            yield _chunk(world, steps)
            if steps.ended:
                return

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as a program: the plant with the ground, and the integrator."""
        chosen = self.resolve(case)
        config = {"time_step": 0.0, "stiction_tolerance": chosen["stiction_tolerance"]}
        text = as_python(case, chosen, config)
        return text + _PASTE.format(**{name: chosen[name] for name in declared.OF_THE_INTEGRATOR})


def _chunk(world: CenicWorld, steps: Steps) -> Chunk:
    """Return the steps, of which those that are recorded are read."""
    quaternions: Floats = np.array([unit(state[:4]) for state in steps.states])
    forces = steps.forces

    def trajectory(time: Floats, states: Floats, unit: Floats, forces: Floats) -> Trajectory:
        motion = np.hstack((states[:, 4:7], unit, states[:, 10:], states[:, 7:10]))
        touched = [world.touch(state, force) for state, force in zip(states, forces, strict=True)]
        return trajectory_of(
            time,
            motion,
            np.array([each.point for each in touched]),
            forces,
            np.array([each.penetration for each in touched]),
            np.array([each.count for each in touched]),
        )

    return Chunk(
        times=steps.times,
        quaternions=quaternions,
        constraint_rows=_PER_CONTACT * (forces[:, 2] > 0.0).astype(np.int64),
        sound=not world.broken,
        velocities=steps.states[:, 10:],
        readings=(steps.states, quaternions, forces),
        trajectory=trajectory,
    )
