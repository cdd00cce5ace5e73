"""The static penetration: how deep an engine's can must sit for its contact to start at rest.

A soft contact bears a load only when it is compressed; released with the rim just touching, the can
falls into its own contact and the run starts with a bounce that is not in the scene. The depth
sought is the one at which the touching point of the rim has no vertical velocity after one step:
the contact then bears just the load that rolling puts on it.
"""

import numpy as np
from scipy.optimize import brentq

from harness.engines.base import World, signed_distance
from harness.engines.stepping.placement import lowered, stepped
from models import Pose, Scene, Twist, angles, contact_offset
from models.rim import arc_of

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
    offset = contact_offset(scene.can, phi, psi, arc=arc_of(scene.effects))
    load = scene.gravity * world.timestep  # what one step of falling free would gain, m/s

    def rise(depth: float) -> float:
        """Return the upward velocity that a step gives to the material point that touches, m/s."""
        after = stepped(world, lowered(pose, depth), twist).twist()
        return float((after.velocity + np.cross(after.angular_velocity, offset))[2])

    # a velocity of round-off size beside that of the release or of one step is rest
    rest = 1e-12 * float(np.linalg.norm(twist.velocity)) + 1e-9 * load
    if rise(0.0) >= -rest:
        return 0.0, pose
    upper, deepest = _FIRST, _DEEPEST * scene.can.radius
    while rise(upper) < 0.0:
        if upper >= deepest:
            return 0.0, pose
        upper = min(4.0 * upper, deepest)
    depth = float(brentq(rise, 0.0, upper, xtol=1e-6 * upper))
    return depth, lowered(pose, depth)
