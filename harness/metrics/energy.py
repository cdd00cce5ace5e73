"""Energy, which rolling conserves: an engine's dissipation and gain show here first.

The energy is that of the can and its point mass, kinetic and in gravity relative to the plane: on a
tilted plane also that of the way down. Where an effect takes energy away or the plane's shaking
brings energy, a drift would mix the scene's own change with the engine's, and there is no drift. A
plane without friction takes nothing, and neither does an elastic impact.
"""

import numpy as np

from harness.core.trajectory import Floats, Trajectory
from models.gravity import gravity_vector
from models.kinematics import to_body
from models.scene import Scene

_TAKE_OR_BRING = frozenset(
    {"damping", "drilling", "rolling_resistance", "contour_friction", "air_film", "shake"}
)


def conserves_energy(scene: Scene) -> bool:
    """Return whether the exact motion of a scene conserves its energy.

    Compliance counts as taking: even without damping the contact stores energy, which is not in
    `energy`.
    """
    effects = scene.effects
    if _TAKE_OR_BRING.intersection(effects.declared()) or effects.compliance is not None:
        return False
    if effects.slip is not None and effects.slip.mu > 0.0:
        return False
    return effects.restitution is None or effects.restitution.coefficient == 1.0


def energy(trajectory: Trajectory, scene: Scene) -> Floats:
    """Return kinetic plus potential energy, shape (n,), J; zero height is the plane's origin."""
    can, point, gravity = scene.can, scene.effects.point_mass, gravity_vector(scene)
    omega = to_body(trajectory.quaternion, trajectory.angular_velocity)
    moments = np.array((can.transverse_inertia, can.transverse_inertia, can.axial_inertia))
    total: Floats = 0.5 * can.mass * np.sum(trajectory.velocity**2, axis=1)
    total += 0.5 * np.sum(moments * omega**2, axis=1)
    total -= can.mass * (trajectory.position @ gravity)
    if point is not None:
        back = trajectory.quaternion * np.array((1.0, -1.0, -1.0, -1.0))
        place = to_body(back, np.array((point.x, point.y, point.z)))
        velocity = trajectory.velocity + np.cross(trajectory.angular_velocity, place)
        total += 0.5 * point.mass * np.sum(velocity**2, axis=1)
        total -= point.mass * ((trajectory.position + place) @ gravity)
    return total


def energy_drift(trajectory: Trajectory, scene: Scene) -> float | None:
    """Return the largest departure of the energy from its first value, signed, over m g R.

    None without gravity, which gives the scale, and where the scene does not conserve energy.
    """
    if scene.gravity == 0.0 or not conserves_energy(scene):
        return None
    change = energy(trajectory, scene)
    change = change - change[0]
    largest = float(change[np.argmax(np.abs(change))])
    return largest / (scene.can.mass * scene.gravity * scene.can.radius)
