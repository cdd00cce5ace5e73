"""Laws that oppose theta': a rigid body of six degrees of freedom, and the balance of energy."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from reference import Effects, Parameters, Solution
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import DISSIPATED, SUPPLIED
from reference.nonsmooth.segments import SegmentsPath

UP = np.array([0.0, 0.0, 1.0])


def cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def force_on_theta(e: Effects, rate: float, sine: float) -> tuple[float, float]:
    """Return the part of F that is proportional to N, and the rest, from the laws themselves."""
    fluid = e.contour_damping * rate + e.film * rate / sine
    fluid += e.boundary_layer * math.sqrt(abs(rate)) * rate
    return -e.contour * math.copysign(1.0, rate), -fluid


def body(y: np.ndarray, e: Effects, p: Parameters) -> np.ndarray:
    """Rates of centre, quaternion, velocity and angular velocity in the world.

    The rim's material rests at the contact (three constraints on accelerations, their multipliers
    the force); the virtual work of F on theta is a moment along a horizontal line.
    """
    rotation = Rotation.from_quat(y[3:7])
    axis, w = rotation.apply(UP), y[10:13]
    cosine, sine = axis[2], math.hypot(axis[0], axis[1])
    turned = np.cross(w, axis)
    in_plane, sine_rate = (UP - cosine * axis) / sine, -cosine * turned[2] / sine
    in_plane_rate = (-turned[2] * axis - cosine * turned - sine_rate * in_plane) / sine
    arm, arm_rate = -in_plane - p.h * axis, -in_plane_rate - p.h * turned
    level = (cosine * UP - axis) / sine
    # w = psi' z + phi' e + theta' axis with e and z across `level`, and axis.level = -sin(phi)
    rate = -float(w @ level) / sine
    dry, fluid = force_on_theta(e, rate, sine)
    frame = rotation.as_matrix()
    inertia = frame @ np.diag([p.a, p.a, p.c]) @ frame.T
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    matrix[:3, :3], matrix[:3, 6:] = np.eye(3), -np.eye(3)
    right[:3] = -UP
    matrix[3:6, 3:6], matrix[3:6, 6:] = inertia, -cross(arm)
    matrix[3:6, 8] += level * dry / sine
    right[3:6] = -np.cross(w, inertia @ w) - level * fluid / sine
    matrix[6:, :3], matrix[6:, 3:6] = np.eye(3), -cross(arm)
    right[6:] = -np.cross(w, arm_rate)
    solved = np.linalg.solve(matrix, right)
    x, yy, z, s = y[3:7]
    spin = np.array([[s, z, -yy], [-z, s, x], [yy, -x, s], [-x, -yy, -z]])
    return np.concatenate([y[7:10], 0.5 * spin @ w, solved[:6]])


def balance(found: Solution) -> float:
    """Return how much of the energy is neither there nor lost."""
    assert isinstance(found.path, SegmentsPath)
    rows, _ = found.path.rows(np.linspace(0.0, found.t_end, 300))
    equations = GeneralEquations(parameters=found.problem.parameters, effects=found.problem.effects)
    energy = equations.energy(rows, Mode(slips=found.problem.effects.mu is not None))
    assert (np.diff(rows[DISSIPATED]) > -1e-16).all()
    return float(np.ptp(energy + rows[DISSIPATED] - rows[SUPPLIED]))
