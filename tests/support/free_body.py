"""A can as a rigid body of six degrees of freedom in the world, to hold the equations against.

Its state is the centre, a quaternion (scalar last), the velocity and the angular velocity. The
contact is a constraint on accelerations: of the height alone where the rim slips, of all three
components where it sticks. Nothing here is of the package but the numbers of the can.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from reference import Problem

UP = np.array([0.0, 0.0, 1.0])

Wrench: TypeAlias = Callable[[np.ndarray, float], tuple[np.ndarray, float]]
"""Horizontal force and moment about the normal by a unit of normal force, of slip and turning."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Where the can touches, in the world: vectors from the centre, lengths in R."""

    frame: np.ndarray
    level: np.ndarray
    arm: np.ndarray
    arm_rate: np.ndarray


def skew(v: np.ndarray) -> np.ndarray:
    """Return the matrix of a vector product."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def posed(y: np.ndarray, h: float) -> Pose:
    """Return the contact of a state."""
    frame = Rotation.from_quat(y[3:7]).as_matrix()
    axis, w = frame[:, 2], y[10:13]
    cosine, sine = axis[2], math.hypot(axis[0], axis[1])
    turned = np.cross(w, axis)
    in_plane, sine_rate = (UP - cosine * axis) / sine, -cosine * turned[2] / sine
    in_plane_rate = (-turned[2] * axis - cosine * turned - sine_rate * in_plane) / sine
    return Pose(
        frame=frame,
        level=(cosine * UP - axis) / sine,
        arm=-in_plane - h * axis,
        arm_rate=-in_plane_rate - h * turned,
    )


def slip_of(y: np.ndarray, h: float) -> np.ndarray:
    """Return the velocity of the rim's material at the contact, shape (3,)."""
    return np.asarray(y[7:10] + np.cross(y[10:13], posed(y, h).arm))


def accelerated(
    y: np.ndarray, problem: Problem, wrench: Wrench | None, slip: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the rates of a state, shape (13,), and the force of the plane, shape (3,).

    A rim without a wrench sticks; the slip of one that slips may be given, where it only begins.
    """
    p, w = problem.parameters, y[10:13]
    here = posed(y, p.h)
    inertia = here.frame @ np.diag([p.a, p.a, p.c]) @ here.frame.T
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    matrix[:3, :3], matrix[3:6, 3:6] = np.eye(3), inertia
    right[:3], right[3:6] = -UP, -np.cross(w, inertia @ w)
    matrix[6:, :3], matrix[6:, 3:6] = np.eye(3), -skew(here.arm)
    right[6:] = -np.cross(w, here.arm_rate)
    if wrench is None:
        matrix[:3, 6:], matrix[3:6, 6:] = -np.eye(3), -skew(here.arm)
    else:
        u = y[7:10] + np.cross(w, here.arm) if slip is None else slip
        force, moment = wrench(u[:2], float(w[2]))
        of_normal = np.array([*force, 1.0])
        matrix[:3, 8] = -of_normal
        matrix[3:6, 8] = -np.cross(here.arm, of_normal) - moment * UP
        # the rest of the force is the law's: of three unknowns one is left
        matrix[6:8], right[6:8] = 0.0, 0.0
        matrix[6, 6] = matrix[7, 7] = 1.0
    solved = np.linalg.solve(matrix, right)
    plane = solved[6:] if wrench is None else solved[8] * of_normal
    x, yy, z, s = y[3:7]
    spin = np.array([[s, z, -yy], [-z, s, x], [yy, -x, s], [-x, -yy, -z]])
    return np.concatenate([y[7:10], 0.5 * spin @ w, solved[:6]]), plane


def released(problem: Problem) -> np.ndarray:
    """Return the state of the release of a problem, with psi = theta = 0."""
    S, C = math.sin(problem.phi), math.cos(problem.phi)
    level, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    axis = C * UP - S * level
    w = problem.psi_dot * UP - problem.phi_dot * across + problem.theta_dot * axis
    arm = -(UP - C * axis) / S - problem.parameters.h * axis
    attitude = Rotation.from_rotvec(-problem.phi * across)
    slip = np.array([*problem.slip, 0.0])
    return np.concatenate([-arm, attitude.as_quat(), slip - np.cross(w, arm), w])


def angles(states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return phi and psi of states, shape (13, n)."""
    axis = Rotation.from_quat(states[3:7].T).apply(UP)
    phi = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])
    return phi, np.unwrap(np.arctan2(-axis[:, 1], -axis[:, 0]))
