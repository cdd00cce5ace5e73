"""Exudyn as an engine: rolling as an ideal joint, integrated in the second order.

Steps of one length are taken in one call, of which every state is read: a reading costs a tenth of
a step. GeneralizedAlpha loses its algorithmic accelerations from call to call, which changes states
by 1e-8 of their size; TrapezoidalIndex2 has none.
"""

from collections.abc import Iterator, Sequence
from importlib.metadata import version
from types import MappingProxyType

import numpy as np

from harness.engines import (
    PROFILES,
    Capabilities,
    Case,
    Chunk,
    PhysicsEngine,
    Schedule,
    Stage,
    step_by_stages,
    trajectory_of,
)
from harness.engines.exudyn import DESCRIPTION
from harness.engines.exudyn import settings as declared
from harness.engines.exudyn.world import ExudynWorld, JointSteps

_ROWS = 3
"""Of the joint: three components of a velocity."""

_PASTE = """\
import exudyn

settings = exudyn.SimulationSettings()
settings.timeIntegration.numberOfSteps = 1000
settings.timeIntegration.endTime = 1000 * {timestep!r}
settings.timeIntegration.minimumStepSize = 1e-300
settings.timeIntegration.automaticStepSize = False
settings.timeIntegration.adaptiveStep = False
settings.timeIntegration.generalizedAlpha.spectralRadius = {spectralRadius!r}
settings.timeIntegration.newton.useModifiedNewton = {useModifiedNewton!r}
settings.timeIntegration.newton.relativeTolerance = {relativeTolerance!r}
settings.timeIntegration.newton.absoluteTolerance = {absoluteTolerance!r}
settings.timeIntegration.newton.maxIterations = {maxIterations!r}
mbs.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.{solverType})
"""

_ADAPTIVE = """\
# The timestep follows the motion. Between calls of mbs.SolveDynamic(updateInitialValues=True), for
# a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   endTime = numberOfSteps * step                 # of schedule.next(quaternion, angular velocity)
"""


class ExudynEngine(PhysicsEngine[ExudynWorld]):
    """Exudyn: redundant coordinates, a joint that rolls, an implicit method of second order."""

    name = "exudyn"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    imposed = MappingProxyType(dict.fromkeys(PROFILES, declared.IMPOSED))
    capabilities = Capabilities(
        honours=frozenset({"tilt", "point_mass"}),
        imposes={
            "rolling": "a joint holds the rim on the plane, which may pull, and nothing slides",
            "fast spin": "a can that turns by radians in a step does not keep its spin, or the "
            "step fails",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("exudyn")

    def open(self, case: Case) -> ExudynWorld:
        """Open a world with the scene of a case."""
        return ExudynWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: ExudynWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return step_by_stages(_Reader(world), schedule, size)

    def bare_loop(self, world: ExudynWorld, steps: int) -> None:
        """Step so many times in one call."""
        world.advance(steps)

    def counted_step(self, world: ExudynWorld) -> int:
        """Step, and return the iterations of Newton's method."""
        world.step()
        return world.iterations()

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a system `mbs` that has its bodies."""
        timestep = self.timestep(case)
        text = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        return text + _PASTE.format(timestep=timestep, **self.resolve(case))


class _Reader:
    """Takes the steps of a stage in one call, and holds them until a chunk is made."""

    def __init__(self, world: ExudynWorld) -> None:
        self._world = world
        self._times: list[np.ndarray] = []
        self._taken: list[JointSteps] = []

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return quaternion (scalar first) and angular velocity."""
        state = self._world.state.tolist()
        return state[3:7], state[10:]

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage; return False where one failed."""
        self._world.set_timestep(stage.timestep)
        taken = self._world.advance(len(stage.times))
        # of a step that failed the state before it is the last
        self._times.append(stage.times[: len(taken.force) + (not taken.finished)])
        self._taken.append(taken)
        return taken.finished

    def chunk(self) -> Chunk | None:
        """Return the states since the last chunk; None without any."""
        if not self._times:
            return None
        times = np.concatenate(self._times)
        motion = np.vstack([taken.motion[: len(taken.force)] for taken in self._taken])
        force = np.vstack([taken.force for taken in self._taken])
        point = np.vstack([taken.point for taken in self._taken])
        sound = self._taken[-1].finished
        self._times, self._taken = [], []

        held = np.zeros(len(times), dtype=np.int64)
        held[: len(point)] = _ROWS * np.isfinite(point[:, 2])
        return Chunk(
            times=times,
            quaternions=motion[:, 3:7],
            constraint_rows=held,
            sound=sound,
            velocities=motion[:, 7:10],
            readings=(motion, point, force, -point[:, 2], np.isfinite(point[:, 2])),
            trajectory=trajectory_of,
        )
