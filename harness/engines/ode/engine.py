"""ODE as an engine: one LCP of velocities a step, by a direct method or by relaxation.

There is no batched stepping, and a reading costs as much as a step: most steps of a slow motion are
taken without one.
"""

from collections.abc import Iterator

from harness.engines import Capabilities, Case, Chunk, PhysicsEngine, Schedule, Value, walk
from harness.engines.ode import DESCRIPTION
from harness.engines.ode import settings as declared
from harness.engines.ode.library import library_version
from harness.engines.ode.world import OdeWorld

_PASTE = """\
import odepy

{world}odepy.dBodySetGyroscopicMode(body, {gyroscopic:d})
odepy.dBodySetFiniteRotationMode(body, {finite:d})
contact.surface.mode |= odepy.{friction}


def step():
    odepy.{step}(world, {timestep!r})
"""

_RIM = """\

# instead of dCollide, for a body whose origin is the centre of the can, at its lowest point:
#   from models import Pose, contact_point
#   point = contact_point(can, position, quaternion)         # shape (3,), m
#   contact.geom.pos[:3], contact.geom.normal[:3], contact.geom.depth = point, (0, 0, 1), -point[2]
"""

_ADAPTIVE = """\

# The timestep follows the motion. Before each step of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   odepy.{step}(world, dt)                        # dt of schedule.next(quaternion, spin)
"""


class OdeEngine(PhysicsEngine[OdeWorld]):
    """Open Dynamics Engine: maximal coordinates, impulses at the level of velocities."""

    name = "ode"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    capabilities = Capabilities(
        honours=frozenset({"compliance", "restitution", "damping", "tilt", "shake", "point_mass"}),
        imposes={
            "slip": "friction is bounded along x and along y, each by itself, by mu times the "
            "normal force that there would be without friction, and what slides moves wrongly at "
            "any timestep",
            "flat contact": "below 4.5e-4 rad the collider has four fixed points of the base, and "
            "none before the middle of the base is in the plane",
            "stabilisation": "a fifth of a penetration is taken away in a step, which adds energy",
            "rebound": "an impact gives back up to a fifth of its speed, by how far its step goes "
            "into the plane, where restitution would give back less",
            "gyroscopic term": "taken implicitly, and a free spin loses energy",
        },
    )

    @property
    def version(self) -> str:
        """The version in the name of the library."""
        return library_version()

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which ODE goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case))

    def open(self, case: Case) -> OdeWorld:
        """Open a world with the scene of a case."""
        return OdeWorld(case, self.resolve(case), self.timestep(case))

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide: a spring has no slack."""
        del timestep
        return {} if case.scene.effects.compliance is None else {"ContactSurfaceLayer": 0.0}

    def chunks(self, world: OdeWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def counted_step(self, world: OdeWorld) -> int:
        """Step, and return the sweeps of the relaxation; the direct method has none."""
        world.step()
        return world.sweeps

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as calls, for a `world`, its `body` and a `contact`."""
        timestep, chosen = self.timestep(case), self.resolve(case)
        names = ["ERP", "CFM", "ContactSurfaceLayer"]
        if chosen["ContactMaxCorrectingVel"] is not None:
            names.append("ContactMaxCorrectingVel")
        if chosen["step"] == declared.QUICK_STEP:
            names += ["QuickStepNumIterations", "QuickStepW"]
        text = _PASTE.format(
            world="".join(f"odepy.dWorldSet{name}(world, {chosen[name]!r})\n" for name in names),
            gyroscopic=chosen["GyroscopicMode"],
            finite=chosen["FiniteRotationMode"],
            friction=chosen["friction"],
            step=chosen["step"],
            timestep=timestep,
        )
        text += _RIM if chosen["contacts"] == declared.RIM else ""
        if case.profile == "adaptive":
            text += _ADAPTIVE.format(largest=timestep, step=chosen["step"])
        return text
