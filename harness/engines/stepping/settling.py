"""A can placed in a world, stepped once, and settled where its contact bears its load.

Settling, the parity table, the probes and the clauses of the contract place a can at rest or
moving, aloft or where its collider touches.

Static penetration: how deep an engine's can must sit for its contact to start at rest.

A soft contact bears a load only when it is compressed; released with the rim just touching, the can
falls into its own contact and the run starts with a bounce that is not in the scene. The depth
sought is the one at which the touching point of the rim has no vertical velocity after one step:
the contact then bears just the load that rolling puts on it.
"""

import math
from collections.abc import Callable

import numpy as np
import scipy

from harness.engines.world import Floats, World, signed_distance
from models import Can, Pose, Scene, Twist, angles, contact_offset, quaternion
from models.rim import arc_of

ZERO = np.zeros(3)
X, Y, UP = np.eye(3)
UPRIGHT = np.array((1.0, 0.0, 0.0, 0.0))
TURNED = quaternion(0.7, 0.4, -1.1)
"""An orientation in which no axis of the can is one of the world, and no two frames are alike."""

LYING = quaternion(math.pi / 2.0, 0.0, -1.1)
"""The can's axis along one of the world, where a clamp of each component is told, and turned."""

ALOFT = 10.0
"""m: height at which no engine finds a contact."""

LIFT = 1e-3
"""Share of the radius at which a can hovers: measured by every engine, and a contact in none."""


def moving(velocity: Floats = ZERO, spin: Floats = ZERO) -> Twist:
    """Return a motion, m/s and rad/s in world coordinates; at rest if nothing is given."""
    return Twist(velocity=velocity, angular_velocity=spin)


AT_REST = moving()


def above_origin(height: float, orientation: Floats = UPRIGHT) -> Pose:
    """Return the pose of a can whose centre is at a height, m, above the origin."""
    return Pose(position=np.array((0.0, 0.0, height)), quaternion=orientation)


def lowered(pose: Pose, depth: float) -> Pose:
    """Return a pose, lower by a depth in m."""
    down = np.array((0.0, 0.0, depth))  # an infinite depth gives NaN, which is refused
    return Pose(position=pose.position - down, quaternion=pose.quaternion)


def low_point(can: Can, phi: float, arc: float = 0.0) -> float:
    """Return how far below the centre the lowest point of an ideal can is, tilted by phi, m."""
    return -float(contact_offset(can, phi, 0.0, arc=arc)[2])


def stepped(world: World, pose: Pose, twist: Twist) -> World:
    """Return the world after one step from a pose and a motion."""
    world.place(pose, twist)
    world.step()
    return world


def hovering_distance(world: World, can: Can, phi: float, theta: float) -> float:
    """Return the collider's signed distance to the plane where an ideal can is `LIFT` above it."""
    height = low_point(can, phi) + LIFT * can.radius
    world.place(above_origin(height, quaternion(phi, 0.0, theta)), AT_REST)
    return signed_distance(world)


_PRESSED = 2e-3
"""Of the radius: how much deeper a can is pressed until a collider sees it; more than `LIFT`, so
that once is enough there."""


def pressed_distance(depth: Callable[[float], float | None], can: Can) -> float:
    """Return the signed distance of a collider that tells how deep it overlaps, and no more, m.

    Such a can is pressed down until it overlaps; none within its radius is infinitely far.

    Parameters
    ----------
    depth : callable
        Returns the depth of the overlap of the can lowered by so much, m; None without any.
    can : Can
    """
    pressed, radius = 0.0, can.radius
    while (found := depth(pressed)) is None:
        if pressed >= radius:
            return math.inf
        pressed += _PRESSED * radius
    return pressed - found


def touching_pose(world: World, can: Can, phi: float, arc: float = 0.0) -> Pose:
    """Return the pose, tilted by phi, in which the collider of a world just touches the plane."""
    ideal = above_origin(low_point(can, phi, arc), quaternion(phi, 0.0, 0.0))
    world.place(ideal, AT_REST)
    return lowered(ideal, signed_distance(world))


_FIRST = 1e-13
"""m: first depth tried; the static penetration of a stiff contact at a timestep of 1e-8 s."""

_DEEPEST = 0.1
"""Share of the radius beyond which no depth is sought."""


def settle(world: World, scene: Scene, pose: Pose, twist: Twist) -> tuple[float, Pose]:
    """Return the static penetration of a release, m, and the pose lowered by it.

    Parameters
    ----------
    world : World
        Is placed and stepped many times; not to be used for the run itself.
    scene : Scene
    pose : Pose
        With the lowest point of the rim at z = 0.
    twist : Twist

    Returns
    -------
    depth : float
        Zero for a contact that is rigid, or that pushes the can away at any depth, and for a can
        that is released elsewhere than on its rim.
    pose : Pose
    """
    if scene.release.height != 0.0:
        return 0.0, pose
    world.place(pose, twist)
    # a collider larger than the can would start deep inside
    pose = lowered(pose, signed_distance(world))
    phi, psi, _ = angles(pose.quaternion)
    x, y, _ = contact_offset(scene.can, phi, psi, arc=arc_of(scene.effects)).tolist()
    load = scene.gravity * world.timestep  # what one step of falling free would gain, m/s

    # `brentq` keeps its function in a reference cycle; clearing this list frees the world at once
    worlds = [world]

    def rise(depth: float) -> float:
        """Return the upward velocity that a step gives to the material point that touches, m/s."""
        after = stepped(worlds[0], lowered(pose, depth), twist).twist()
        o_x, o_y, _ = after.angular_velocity.tolist()
        return float(after.velocity[2] + (o_x * y - o_y * x))

    # a velocity within round-off of the release's, or of that gained in one step, counts as rest
    rest = 1e-12 * float(np.linalg.norm(twist.velocity)) + 1e-9 * load
    if rise(0.0) >= -rest:
        return 0.0, pose
    upper, deepest = _FIRST, _DEEPEST * scene.can.radius
    while rise(upper) < 0.0:
        if upper >= deepest:
            return 0.0, pose
        upper = min(4.0 * upper, deepest)
    depth = float(scipy.optimize.brentq(rise, 0.0, upper, xtol=1e-6 * upper))
    worlds.clear()
    return depth, lowered(pose, depth)
