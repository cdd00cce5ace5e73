"""Where an engine puts the contact points of a can on its rim, asked of its collider.

A can that is tilted by phi towards the heading alpha has its axis along

    u = (sin phi cos alpha, sin phi sin alpha, cos phi)

and the lowest point of its rim, from its centre, at -H u + R (cos phi cos alpha, cos phi sin alpha,
-sin phi), H cos phi + R sin phi below it. A can has the same shape upside down and turned about its
axis, and a plane has no direction and no origin, so that this holds in every stance.
"""

import cmath
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import HarnessError
from harness.engines.contract import describe_exception
from harness.engines.stepping.settling import AT_REST
from harness.engines.world import Collision, Floats, World
from models import Can, Pose

_LYING = math.pi / 2.0
"""rad: a can that touches along a line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stance:
    """How a can is put on the ground.

    Parameters
    ----------
    tilt, heading, spin : float
        Angle of the axis to the vertical, azimuth to which it leans, turn about the axis, rad.
    upside_down : bool
    depth : float
        Of the lowest point below the ground, m; negative above it.
    distance : float
        From the origin, m.
    """

    tilt: float
    heading: float
    spin: float
    upside_down: bool
    depth: float
    distance: float = 0.0

    def put(self, can: Can) -> tuple[Pose, Floats]:
        """Return the pose, and the lowest point of the rim, shape (3,), m."""
        # q_z(heading) q_y(tilt) q_z(spin), scalar first
        upright = cmath.rect(math.cos(0.5 * self.tilt), 0.5 * (self.heading + self.spin))
        tilted = cmath.rect(math.sin(0.5 * self.tilt), 0.5 * (self.heading - self.spin))
        q = upright.real, -tilted.imag, tilted.real, upright.imag
        if self.upside_down:  # half a turn about the first of its own axes
            q = -q[1], q[0], q[3], -q[2]
        along, down = math.cos(self.tilt), math.sin(self.tilt)
        level = -can.half_height * down + can.radius * along
        below = can.half_height * along + can.radius * down
        x, y = 0.8 * self.distance, 0.6 * self.distance
        rim = x + level * math.cos(self.heading), y + level * math.sin(self.heading), 0.0
        centre = np.array((x, y, below - self.depth))
        return Pose(position=centre, quaternion=np.array(q)), np.array(rim)


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a collider finds of a can in one stance, against what is exact.

    Parameters
    ----------
    stance : Stance
    radius : float
        Of the can, m.
    count : int
        Contact points.
    place_error : float
        Horizontal distance from the deepest of them to the lowest point of the rim, m; NaN without
        any.
    depth_error : float
        Of the deepest, m; NaN where depths are not told.
    normal_error : float
        Angle to the vertical, rad; NaN where normals are not told, a right angle of one that is
        zero.
    """

    stance: Stance
    radius: float
    count: int
    place_error: float = math.nan
    depth_error: float = math.nan
    normal_error: float = math.nan


class NoAnswerError(Exception):
    """An engine raised an exception where it was asked for its contacts."""


@contextmanager
def asking(verb: str) -> Iterator[None]:
    """Tell what an engine raises by the name of what was asked of it.

    Raises
    ------
    NoAnswerError
        Instead of any exception but those of wrong use and of the machine.
    """
    try:
        yield
    except (HarnessError, MemoryError, OSError):
        raise
    except Exception as error:
        raise NoAnswerError(describe_exception(error, verb)) from error


def collision(world: World) -> Collision:
    """Return the contact points where the can is.

    Without a step where the world has a method `collision`; else those with which one step is
    solved, as one resultant.
    """
    if hasattr(world, "collision"):
        found: Collision = world.collision()
        return found
    world.step()
    contact = world.contact()
    return Collision(
        points=np.repeat(contact.point[None], contact.count, axis=0),
        normals=np.full((contact.count, 3), math.nan),
        depths=np.full(contact.count, contact.penetration),
    )


_TIED = 1e-12
"""Of the size of the can: depths that differ by less are equal."""
_BEYOND_DOUBLES = 1e308
"""Components whose length may be none of the doubles."""


def ask(world: World, can: Can, stance: Stance) -> Answer:
    """Return what a world finds of its can in a stance."""
    pose, lowest = stance.put(can)
    with asking("place"):
        world.place(pose, AT_REST)
    with asking("collision"):
        found = collision(world)
    if not len(found.depths):  # as wherever the can is above the ground
        return Answer(stance=stance, radius=can.radius, count=0)
    # number by number: of so few, Python asks in a fifth of the time that numpy takes
    points, normals, depths = found.points.tolist(), found.normals.tolist(), found.depths.tolist()
    # some colliders tell of points above the ground; numbers that break are no contact
    untold = all(map(math.isnan, depths))
    touching = [
        number
        for number, (point, depth) in enumerate(zip(points, depths, strict=True))
        if (untold or depth > 0.0) and all(map(math.isfinite, point))
    ]
    if not touching:
        return Answer(stance=stance, radius=can.radius, count=0)
    if math.isclose(stance.tilt, _LYING):  # it touches along a line
        off = dict(
            zip(touching, _off_line(found.points[touching], lowest, can, stance), strict=True)
        )
    else:
        x, y, _ = lowest.tolist()
        off = {each: _length(points[each][0] - x, points[each][1] - y) for each in touching}
    least = max(depths[each] for each in touching) - _TIED * can.bounding_radius
    deepest = [each for each in touching if untold or depths[each] >= least]
    chosen = min(deepest, key=off.__getitem__)
    x, y, z = normals[chosen]
    return Answer(
        stance=stance,
        radius=can.radius,
        count=len(touching),
        place_error=float(off[chosen]),
        depth_error=abs(depths[chosen] - stance.depth),
        normal_error=math.atan2(math.hypot(x, y), z) if x or y or z else math.pi / 2.0,
    )


def _length(x: float, y: float) -> float:
    """Return the length of a vector as C's `hypot` has it, and numpy's, which Python's is not."""
    return abs(complex(x, y)) if max(abs(x), abs(y)) < _BEYOND_DOUBLES else math.inf


def _off_line(points: Floats, lowest: Floats, can: Can, stance: Stance) -> Floats:
    """Return the horizontal distances of points from the line on which a can lies, m."""
    axis = np.array((math.cos(stance.heading), math.sin(stance.heading)))
    away = (points - lowest)[:, :2]
    along = (away @ axis).clip(0.0, 2.0 * can.half_height)
    off: Floats = np.hypot(*(away - along[:, None] * axis).T)
    return off


HEADINGS = (0.3, 0.3 + math.pi, 1.9, 5.2)
"""rad: both sides of one, and none of them along an axis of the world or a polygon's corner."""

_SPIN = 1.3  # rad for each turn further


def turns(tilt: float, depths: Sequence[float]) -> Iterator[Stance]:
    """Yield a tilt at every heading and depth (m), upright and upside down."""
    for place, (heading, upside_down) in enumerate(
        (heading, flipped) for heading in HEADINGS for flipped in (False, True)
    ):
        for depth in depths:
            yield Stance(
                tilt=tilt,
                heading=heading,
                spin=_SPIN * (1 + place),
                upside_down=upside_down,
                depth=depth,
            )


def answers(world: World, can: Can, stances: Sequence[Stance]) -> list[Answer]:
    """Return what a world finds in each stance."""
    return [ask(world, can, stance) for stance in stances]


def moved(stances: Sequence[Stance], distance: float) -> list[Stance]:
    """Return stances at a distance from the origin, m."""
    return [replace(stance, distance=distance) for stance in stances]
