"""A can placed in a world, at rest or moving, aloft or where its collider touches, and stepped.

Settling, the parity table, the probes and the clauses of the contract all begin so.
"""

import numpy as np

from harness.engines.base import Floats, World, signed_distance
from models import Can, Pose, Twist, contact_offset, quaternion

ZERO = np.zeros(3)
X, Y, UP = np.eye(3)
UPRIGHT = np.array((1.0, 0.0, 0.0, 0.0))

LIFT = 1e-3
"""Share of the radius at which a can hovers: within every engine's reach, and out of contact."""


def moving(velocity: Floats = ZERO, spin: Floats = ZERO) -> Twist:
    """Return a motion, m/s and rad/s in world coordinates; at rest if nothing is given."""
    return Twist(velocity=velocity, angular_velocity=spin)


AT_REST = moving()


def above_origin(height: float, orientation: Floats = UPRIGHT) -> Pose:
    """Return the pose of a can whose centre is at a height, m, above the origin."""
    return Pose(position=np.array((0.0, 0.0, height)), quaternion=orientation)


def lowered(pose: Pose, depth: float) -> Pose:
    """Return a pose, lower by a depth in m."""
    down = np.array((0.0, 0.0, depth))  # an infinite depth is no number in the result, and told so
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


def touching_pose(world: World, can: Can, phi: float, arc: float = 0.0) -> Pose:
    """Return the pose, tilted by phi, in which the collider of a world just touches the plane."""
    ideal = above_origin(low_point(can, phi, arc), quaternion(phi, 0.0, 0.0))
    world.place(ideal, AT_REST)
    return lowered(ideal, signed_distance(world))
