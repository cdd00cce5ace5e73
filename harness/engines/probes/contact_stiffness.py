"""Stabilisation: the motion that an engine makes of an overlap, and what is left of an impact.

Without gravity a can at rest stays at rest. Placed a little inside the plane, balanced so that the
contact force goes through its centre, it is pushed out by a contact that corrects positions by
velocities: speed and energy out of nothing. A true plane that takes up an impact without rebound
leaves no speed at all.

Compliance: how deep the rim sinks under a load, against a rigid plane that gives nothing.

The can is balanced on its rim, at rest with its centre above the contact point (eq:phistar), so
that the load is its weight exactly; gravity is varied to vary it. The depth is the one at which one
step leaves the contact at rest, and it is read again from the engine's contact after a while.
"""

from collections.abc import Iterator

import numpy as np

from harness.core.case import Case
from harness.engines.probes.fixture import (
    STILL,
    Evidence,
    Opener,
    ProbeFinding,
    Trace,
    aloft,
    follow,
    leaning,
    with_gravity,
)
from harness.engines.stepping.horizon import natural_time
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
            yield ProbeFinding(
                effect="stabilisation",
                quantity=quantity,
                unit=unit,
                value=value,
                expected=0.0,
                how=how,
            )
    given = IMPACT * can.radius / T
    down = Twist(velocity=np.array((0.0, 0.0, -given)), angular_velocity=np.zeros(3))
    yield ProbeFinding(
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


LOADS = (0.25, 0.5, 1.0, 1.5)
"""Weights of the can."""

_HELD = 0.1
"""Natural times for which the load is held: a balanced can has tipped by a thousandth of its
deviation's growth, exp(0.1), so that it still stands where it was put."""


def compliance(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield static penetration, its slope over the load, and how it stays under a load held."""
    can, gravity = case.scene.can, case.scene.gravity
    phi = can.balancing_angle
    depths, held, borne = [], [], []
    for load in LOADS:
        loaded = with_gravity(case, load * gravity)
        world, depth = leaning(engine, loaded, phi)
        steps = max(2, round(_HELD * natural_time(case.scene) / engine.timestep(case)))
        contacts = [instant.contact for instant in follow(world, steps)]
        depths.append(depth)
        held.append(contacts[-1].penetration)
        borne.append(float(np.mean([contact.force[2] for contact in contacts])))
    loads = can.mass * gravity * np.array(LOADS)
    slope, _ = np.polyfit(loads, depths, 1)
    one = LOADS.index(1.0)
    how = "balanced on its rim, at 0.25 to 1.5 times its weight"
    for quantity, unit, value, expected in (
        ("static penetration under its weight", "m", depths[one], 0.0),
        ("depth under its weight held for 0.1 sqrt(R/g)", "m", held[one], 0.0),
        ("depth for a load", "m/N", float(slope), 0.0),
        ("mean load borne over the weight", "1", borne[one] / loads[one], 1.0),
    ):
        yield ProbeFinding(
            effect="compliance",
            quantity=quantity,
            unit=unit,
            value=value,
            expected=expected,
            how=how,
        )
    yield Trace(
        effect="compliance",
        x_label="load [N]",
        y_label="static penetration [m]",
        x=loads,
        y=np.array(depths),
    )
