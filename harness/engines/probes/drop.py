"""Probe of a declared compliance by a drop: what an engine makes of its stiffness and damping.

The can is balanced on its rim, its centre above the contact point, and meets the plane with the
speed v: until it leaves, it is a mass on a spring and a damper along a line. With the depth d,

    m d'' = m g - k d - b d',    d(0) = 0,    d'(0) = v,

and the contact ends where its force k d + b d' does. Contact time, greatest depth and rebound are
what the engine's own map from the declared constants to its settings makes of them; how near they
come is the timestep's and the map's together, so that the timestep is stated.
"""

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy

from harness.core.case import Case
from harness.engines.probes.survey import Opener, Reading, follow, probe
from harness.engines.stepping.settling import UP, moving
from models import Release, release_state

SPEED = 10.0
"""Speed at the touch, in g sqrt(m/k): the can goes eleven times as deep as at rest."""

_LONGEST = 4.0 * math.pi
"""Of the undamped angle: a contact that has not ended by then stays."""

_LOOKS = 4000


@dataclass(frozen=True, slots=True, kw_only=True)
class Drop:
    """Contact of a mass that falls on a spring and a damper.

    Attributes
    ----------
    lasts : float
        s; NaN of one that stays.
    deepest : float
        m.
    rebound : float
        Speed at the end over that at the touch; NaN of one that stays.
    """

    lasts: float
    deepest: float
    rebound: float

    @classmethod
    def of(
        cls, mass: float, gravity: float, stiffness: float, damping: float, speed: float
    ) -> Self:
        """Return the drop in closed form, SI units."""
        loss, rest = damping / (2.0 * mass), mass * gravity / stiffness
        rate = cmath.sqrt(stiffness / mass - loss**2) or 1e-9 + 0j

        def depth(t: float) -> float:
            swing = (speed - loss * rest) / rate * cmath.sin(rate * t) - rest * cmath.cos(rate * t)
            return rest + math.exp(-loss * t) * swing.real

        def rise(t: float) -> float:
            swing = (speed - loss * rest) * cmath.cos(rate * t) + rest * rate * cmath.sin(rate * t)
            return loss * (depth(t) - rest) - math.exp(-loss * t) * swing.real

        def force(t: float) -> float:
            return stiffness * depth(t) - damping * rise(t)

        times = np.linspace(0.0, _LONGEST * math.sqrt(mass / stiffness), _LOOKS)
        ended = np.flatnonzero(np.array([force(t) for t in times.tolist()])[1:] <= 0.0)
        turned = int(np.flatnonzero(np.array([rise(t) for t in times.tolist()]) >= 0.0)[0])
        top = float(scipy.optimize.brentq(rise, times[turned - 1], times[turned]))
        if not ended.size:
            return cls(lasts=math.nan, deepest=depth(top), rebound=math.nan)
        last = int(ended[0])
        end = float(scipy.optimize.brentq(force, times[last] or 1e-9 * times[1], times[last + 1]))
        return cls(lasts=end, deepest=depth(top), rebound=rise(end) / speed)


@probe("declared compliance", contact=True)
def drop(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield contact time, greatest depth and rebound of a drop, where the scene declares a spring.

    Nothing of an engine that does not honour it.
    """
    law, can, gravity = case.scene.effects.compliance, case.scene.can, case.scene.gravity
    if law is None or not law.linear or "compliance" not in engine.capabilities.honours:
        return
    world = engine.open(case)
    mass = world.mass
    speed = SPEED * gravity * math.sqrt(mass / law.stiffness)
    expected = Drop.of(mass, gravity, law.stiffness, law.damping, speed)
    pose, _ = release_state(can, Release(phi=can.balancing_angle))
    world.place(pose, moving(-speed * UP))
    most = 2.0 * math.pi * math.sqrt(mass / law.stiffness)
    steps = math.ceil(most / world.timestep)
    heights, pushed, speeds = [], [], []
    for placed, twist, contact in follow(world, steps):
        heights.append(float(placed.position[2]))
        speeds.append(float(twist.velocity[2]))
        pushed.append(bool(contact.force[2] > 0.0))
    ends = pushed.index(False, 1) if False in pushed[1:] else len(pushed)
    how = (
        f"balanced on its rim, touching at {speed:.3g} m/s, by steps of {world.timestep:.2g} s, "
        f"{expected.lasts / world.timestep:.3g} of them a contact"
    )
    yield "contact time of a drop", "s", ends * world.timestep, expected.lasts, how
    deepest = float(pose.position[2]) - min(heights)
    yield "greatest depth of a drop", "m", deepest, expected.deepest, how
    rebound = speeds[min(ends, len(speeds) - 1)] / speed
    yield "rebound of a drop over its approach", "1", rebound, expected.rebound, how
