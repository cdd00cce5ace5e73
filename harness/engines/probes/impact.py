"""Probe of a declared restitution by drops: what an engine gives back of an impact.

The can meets the plane with the rim's lowest point, moving straight down without a spin. By
Newton's law the speed of that point after the impact is e times that before it, whatever the
effective mass there, which the tilt sets, and whatever friction does along the plane. The drops
begin at several shares of a step above the plane, since an engine sees a contact only at the ends
of its steps. What is told of a coefficient and a speed is the rebound that misses it by most.

Slipping through. A rim that slides so fast that friction cannot stop it within the impact still
gives back e along the normal; convex approximations of the contact throw it off the plane besides.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from harness.core.case import Case
from harness.engines.probes.survey import Opener, Reading, probe
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import UP, X, lowered, moving, touching_pose
from harness.engines.world import World
from models import Can, Effects, Restitution, Slip, contact_offset
from models.kinematics import to_body, to_world

COEFFICIENTS = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)

SPEEDS = (0.02, 0.2, 2.0)
"""Of the approach, over sqrt(g R)."""

_ABOVE = (0.1, 0.5, 0.9)
"""Shares of what the can falls in a step, from which it is dropped."""

_TILTED = (0.4, 1.0)
"""rad; beside the balancing angle, where the effective mass is that of the can."""

_MU = 0.5
"""Friction of a rim that a drop does not make slip, at these tilts."""

_SLIPPING = 6.0
"""Speed along the plane, over that of the approach, that this friction does not stop."""

_LONGEST = 40
"""Steps after which an impact is over, too: what gives nothing back stays."""


def rebound(world: World, can: Can, phi: float, approach: tuple[float, float, float]) -> float:
    """Return the speed of the rim at the end of an impact over that before its first step.

    Parameters
    ----------
    world : World
    can : Can
    phi : float
        Tilt, rad.
    approach : tuple of float
        Speed down, m/s, speed along the plane, m/s, and how far above the plane the can starts, of
        what it falls in a step.
    """
    down, along, above = approach
    start = touching_pose(world, can, phi)
    point = to_body(start.quaternion, contact_offset(can, phi, 0.0))
    world.place(lowered(start, -above * down * world.timestep), moving(along * X - down * UP))
    came = left = -down
    for _ in range(_LONGEST):
        world.step()
        pose, twist = world.pose(), world.twist()
        arm = to_world(pose.quaternion, point)
        speed = float((twist.velocity + np.cross(twist.angular_velocity, arm))[2])
        if world.contact().force[2] > 0.0:
            left = speed
        elif left != came:
            break
        else:
            came = left = speed
    return -left / came


@probe("declared restitution", contact=True)
def restitution(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the rebound of drops for several coefficients and speeds, of engines that honour it."""
    honours = engine.capabilities.honours
    if "restitution" not in honours:
        return
    can, unit = case.scene.can, case.scene.can.radius / natural_time(case.scene)
    frictions = (None, Slip(mu=_MU)) if "slip" in honours else (None,)
    tilts = (can.balancing_angle, *_TILTED)
    for coefficient in COEFFICIENTS:
        worlds = [_opened(engine, case, coefficient, slip) for slip in frictions]
        for speed in SPEEDS:
            found = [
                rebound(world, can, phi, (speed * unit, 0.0, above))
                for world, phi, above in product(worlds, tilts, _ABOVE)
            ]
            worst = max(found, key=lambda value: abs(value - coefficient))
            how = (
                f"dropped at {speed * unit:.3g} m/s at tilts of 0.4 rad to balance, steps of "
                f"{worlds[0].timestep:.2g} s: the rebound that is furthest off"
            )
            quantity = f"rebound of a declared {coefficient:g} at {speed:g} sqrt(g R)"
            yield quantity, "1", worst, coefficient, how
        if len(worlds) > 1:
            approach = (SPEEDS[-1] * unit, _SLIPPING * SPEEDS[-1] * unit, 0.5)
            value = rebound(worlds[-1], can, can.balancing_angle, approach)
            how = f"slides at {_SLIPPING:g} times the speed of approach, mu {_MU:g}, balanced"
            quantity = f"rebound of a declared {coefficient:g}, slipping through"
            yield quantity, "1", value, coefficient, how


def _opened(engine: Opener, case: Case, coefficient: float, slip: Slip | None) -> World:
    """Return a world whose can gives so much of an impact back."""
    law = Effects(restitution=Restitution(coefficient=coefficient), slip=slip)
    return engine.open(replace(case, scene=replace(case.scene, effects=law)))
