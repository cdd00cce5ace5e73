"""Stabilisation: the motion that an engine makes of an overlap, and what is left of an impact.

Without gravity a can at rest stays at rest. Placed a little inside the plane, balanced so that the
contact force goes through its centre, it is pushed out by a contact that corrects positions by
velocities: speed and energy out of nothing. A true plane that takes up an impact without rebound
leaves no speed at all.
"""

from collections.abc import Iterator

import numpy as np

from harness.case import Case
from harness.engines.horizon import natural_time
from harness.engines.probes.evidence import Evidence, Finding
from harness.engines.probes.opening import STILL, Opener, aloft, follow
from models.kinematics import quaternion
from models.rim import contact_offset
from models.state import Pose, Twist

OVERLAPS = (1e-5, 1e-4, 1e-3)
"""Shares of the radius: from an engine's slop up to the margin that one ships with."""

IMPACT = 0.3
"""Speed of the impact, over sqrt(g R): that of a fall from a twentieth of the radius."""

_WAIT = 0.5
"""Natural times: ten time constants of a contact of 3 ms, one and a half of one of 20 ms."""


def stabilisation(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the speed and the energy that an overlap makes, and the rebound of an impact."""
    can, T = case.scene.can, natural_time(case.scene)
    scale = can.mass * case.scene.gravity * can.radius
    for share in OVERLAPS:
        speed = _fastest_rise(engine, case, share * can.radius, STILL)
        how = f"at rest without gravity, {share:g} R inside the plane"
        for quantity, unit, value in (
            (f"speed from an overlap of {share:g} R", "m/s", speed),
            (
                f"energy from an overlap of {share:g} R, over m g R",
                "1",
                0.5 * can.mass * speed**2 / scale,
            ),
        ):
            yield Finding(
                effect="stabilisation",
                quantity=quantity,
                unit=unit,
                value=value,
                expected=0.0,
                how=how,
            )
    given = IMPACT * can.radius / T
    down = Twist(velocity=np.array((0.0, 0.0, -given)), angular_velocity=np.zeros(3))
    yield Finding(
        effect="stabilisation",
        quantity="rebound over impact",
        unit="1",
        value=_fastest_rise(engine, case, 0.0, down) / given,
        expected=0.0,
        how="balanced on its rim without gravity, falling at 0.3 sqrt(g R)",
    )


def _fastest_rise(engine: Opener, case: Case, overlap: float, twist: Twist) -> float:
    """Return the greatest upward speed of a can released so deep inside the plane, m/s."""
    can, T = case.scene.can, natural_time(case.scene)
    world = aloft(engine, case)
    phi = can.balancing_angle
    tilted = quaternion(phi, 0.0, 0.0)
    low = -float(contact_offset(can, phi, 0.0)[2])
    world.place(Pose(position=np.array((0.0, 0.0, low)), quaternion=tilted), STILL)
    height = low - world.gap() - overlap  # from where this collider touches
    world.place(Pose(position=np.array((0.0, 0.0, height)), quaternion=tilted), twist)
    steps = max(4, round(_WAIT * T / engine.timestep(case)))
    return max(0.0, *(float(i.twist.velocity[2]) for i in follow(world, steps)))
