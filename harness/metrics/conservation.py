"""What rolling conserves: the energy. Dissipation and gain of an engine show here first."""

import numpy as np

from harness.trajectory import Floats, Trajectory
from models.kinematics import to_body
from models.scene import Scene


def energy(trajectory: Trajectory, scene: Scene) -> Floats:
    """Return kinetic plus potential energy, shape (n,), J; zero height is the plane."""
    can = scene.can
    omega = to_body(trajectory.quaternion, trajectory.angular_velocity)
    moments = np.array((can.transverse_inertia, can.transverse_inertia, can.axial_inertia))
    kinetic = 0.5 * can.mass * np.sum(trajectory.velocity**2, axis=1)
    kinetic += 0.5 * np.sum(moments * omega**2, axis=1)
    total: Floats = kinetic + can.mass * scene.gravity * trajectory.position[:, 2]
    return total


def energy_drift(trajectory: Trajectory, scene: Scene) -> float:
    """Return the largest departure of the energy from its first value, signed, over m g R."""
    change = energy(trajectory, scene)
    change = change - change[0]
    largest = float(change[np.argmax(np.abs(change))])
    return largest / (scene.can.mass * scene.gravity * scene.can.radius)
