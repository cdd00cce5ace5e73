"""Drake as an engine: a discrete plant that solves a convex contact problem at each step.

There is no batched stepping; a reading costs half of a step: most steps of a slow motion are
taken without one.
"""

import math
from collections.abc import Iterator
from importlib.metadata import version

from harness.engines import (
    FRICTIONS,
    Capabilities,
    Case,
    Chunk,
    PhysicsEngine,
    Schedule,
    Value,
    outline_gap,
    rim_within,
    walk,
)
from harness.engines.drake import DESCRIPTION
from harness.engines.drake import settings as declared
from harness.engines.drake.world import DrakeWorld

_ADAPTIVE = """\
# The timestep follows the motion: a plant for each power of two, and the state goes from one to the
# next. Before each step of a can with these measures:
#   from harness.engines import Adaptive           # Adaptive(can, largest={largest!r}, ...)
#   stage = schedule.next(quaternion, angular_velocity)          # whose `timestep` is a plant's
"""


class DrakeEngine(PhysicsEngine[DrakeWorld]):
    """Drake: a convex approximation of the contact, solved at the level of velocities."""

    name = "drake"
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    variants = declared.VARIANTS
    colliders = declared.COLLIDERS
    capabilities = Capabilities(
        honours=frozenset({"slip", "compliance", "damping", "tilt", "shake", "point_mass"}),
        imposes={
            "compliance": "contact yields in about a timestep, and relaxes in as long",
            "stabilisation": "penetration is taken away by a speed that stays, which adds energy",
            "lift": "under SAP what slides is lifted, in proportion to its speed and the timestep",
            "friction of another load": "under `lagged`, which it ships with, the load of the step "
            "before bounds friction: a rim that was just off the ground meets none",
            "turn in a step": "is twice the arc tangent of the half that its spin asks for",
            "gyroscopic term": "taken explicitly, and a free spin gains energy",
        },
    )

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("drake")

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide."""
        del timestep
        return dict(declared.for_effects(case))

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which Drake goes its own way in a case.

        As shipped the load of the step before bounds friction: in a first step it is any other.
        """
        chosen, can = self.resolve(case), case.scene.can
        lagged = chosen["discrete_contact_approximation"] == "lagged"
        rows = dict.fromkeys(FRICTIONS, math.inf) if lagged and case.profile == "default" else {}
        if declared.is_hydroelastic(chosen):
            gap = outline_gap(declared.hydroelastic_mesh(can, chosen))
            rows |= rim_within(can, gap * can.radius)
        return rows

    def open(self, case: Case) -> DrakeWorld:
        """Open a world with the scene of a case."""
        return DrakeWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: DrakeWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return walk(world, schedule, size, sparsely=True)

    def export_settings(self, case: Case) -> str:
        """Return a case's settings as a program that builds a plant with the ground."""
        timestep, chosen = self.timestep(case), self.resolve(case)
        head = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        config = {"time_step": timestep} | {name: chosen[name] for name in declared.OF_THE_PLANT}
        return head + declared.as_python(case, chosen, config)
