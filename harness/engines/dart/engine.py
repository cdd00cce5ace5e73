"""DART as an engine: velocity-level impulses at each step, in a boxed LCP or on Coulomb's cone.

There is no batched stepping, and a reading costs several times a step: most steps of a slow motion
are taken without one.
"""

from collections.abc import Iterator
from importlib.metadata import version

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    PhysicsEngine,
    Schedule,
    walk,
)
from harness.engines.dart import DESCRIPTION
from harness.engines.dart import settings as declared
from harness.engines.dart.world import DartWorld

_PASTE = """\
import dartpy

world.setTimeStep({timestep!r})
solver = world.getConstraintSolver()
detector = dartpy.collision.{detector}()
{mesh}solver.setCollisionDetector(detector)
solver.setSplitImpulseEnabled({split})
options = world.getDeactivationOptions()
options.mEnabled = {sleeps}
world.setDeactivationOptions(options)
"""

_MESH = "detector.setPrimitiveShapeType(type(detector).PrimitiveShape.MESH)\n"

_ADAPTIVE = """\
# The timestep follows the motion. Before each world.step() of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   world.setTimeStep(step)                        # of schedule.next(quaternion, angular velocity)
"""


class DartEngine(PhysicsEngine[DartWorld]):
    """DART: generalised coordinates, impulses at the level of velocities."""

    name = "dart"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    capabilities = Capabilities(
        honours=frozenset({"slip", "restitution", "damping", "tilt", "shake", "point_mass"}),
        imposes={
            "stabilisation": "of a penetration a hundredth is taken away in a step, at 1 mm/s at "
            "most, which adds energy",
            "gyroscopic term": "taken explicitly, and a free spin gains energy",
            "lost contact": "contacts need an overlap: a rim that the error of a step lifts off is "
            "without a force for some steps",
            "rebound": "an impact that would give back less than 0.1 m/s gives back nothing",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("dartpy")

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which DART goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case))

    def open(self, case: Case) -> DartWorld:
        """Open a world with the scene of a case."""
        return DartWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: DartWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def counted_step(self, world: DartWorld) -> int:
        """Step, and return the iterations of a solver of the cone; Dantzig's method has none."""
        before = world.iterations()
        world.step()
        return world.iterations() - before

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a `world` that has its bodies."""
        timestep, chosen = self.timestep(case), self.resolve(case)
        solver = str(chosen["boxedLcpSolver"])
        text = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        text += _PASTE.format(
            timestep=timestep,
            detector=chosen["collisionDetector"],
            mesh=_MESH if chosen[declared.SHAPE_TYPE] == declared.MESH else "",
            split=bool(chosen["splitImpulseEnabled"]),
            sleeps=bool(chosen["deactivation"]),
        )
        if solver == declared.DANTZIG:  # which Python cannot make, and a new world has
            return text
        lines = [
            f"cone = dartpy.constraint.{solver}()",
            "options = cone.getOptions()",
            f"options.tolerance = {chosen['tolerance']!r}",
            f"options.{declared.MOST_ITERATIONS[solver]} = {chosen['maxSweeps']!r}",
        ]
        if solver == declared.NSGS:
            lines.append(f"options.law = cone.Law.{chosen['law']}")
        return text + "\n".join(
            [*lines, "cone.setOptions(options)", "solver.setBoxedLcpSolver(cone)", ""]
        )
