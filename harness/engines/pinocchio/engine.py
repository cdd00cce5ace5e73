"""Pinocchio as an engine: its dynamics, its solvers on Coulomb's cone, coal's collisions.

An example of a small adapter: an engine is a `World` that can be placed, stepped and read, and this
class, which says what it is and opens one. Parity, settling, adaptive timesteps, recording and the
horizon are those of `PhysicsEngine`.
"""

from collections.abc import Iterator

import pinocchio as pin

from harness.engines import Capabilities, Case, Chunk, PhysicsEngine, Schedule, walk
from harness.engines.pinocchio import DESCRIPTION
from harness.engines.pinocchio import settings as declared
from harness.engines.pinocchio.world import PinocchioWorld

_PASTE = """\
import coal
import pinocchio

timestep = {timestep!r}  # of a step v += timestep * pinocchio.aba(model, data, q, v, tau)
request = coal.CollisionRequest(coal.CollisionRequestFlag.CONTACT, 4)
request.security_margin = {security_margin!r}
correction = {correction!r}  # share of an overlap that a step asks of the velocities
solver = pinocchio.{solver}ConstraintSolver()
settings = pinocchio.{solver}SolverSettings()
settings.max_iterations = {max_iterations!r}
for kind in ("absolute", "relative"):
    for what in ("feasibility", "complementarity"):
        setattr(settings, f"{{kind}}_{{what}}_tol", {tolerance!r})
"""

_ADAPTIVE = """\
# The timestep follows the motion. Before each step of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   timestep = ...                                 # of schedule.next(quaternion, spin)
"""


class PinocchioEngine(PhysicsEngine[PinocchioWorld]):
    """Pinocchio: reduced coordinates, impulses on Coulomb's cone, a step of this project."""

    name = "pinocchio"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    capabilities = Capabilities(
        honours=frozenset({"slip", "damping", "tilt", "shake", "point_mass"}),
        imposes={
            "stabilisation": "an overlap is taken away by a velocity, which adds energy",
            "gyroscopic term": "taken explicitly, and a free spin gains energy",
        },
    )

    @property
    def version(self) -> str:
        """The version of Pinocchio."""
        return str(pin.__version__)

    def open(self, case: Case) -> PinocchioWorld:
        """Open a world with the scene of a case."""
        return PinocchioWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PinocchioWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def counted_step(self, world: PinocchioWorld) -> int:
        """Step, and return the iterations of the solver; none without a contact."""
        world.iterations = 0
        world.step()
        return world.iterations

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as Python, for a step like `PinocchioWorld.step`."""
        timestep = self.timestep(case)
        text = _PASTE.format(timestep=timestep, **self.resolve(case))
        return text + (_ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else "")
