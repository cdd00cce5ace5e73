"""A can as a free rigid body: from its state on the rim to a state in space, and back.

On the rim a can has the 13 rows of `reference.equations.state_vector`. In the air it has the pose
of its centre of mass, its velocity and its angular velocity in the world, and angles that go on
counting turns.
"""

from dataclasses import dataclass
from math import atan2, hypot, pi

import numpy as np

from reference.equations.rigid_body import body_of
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    PSI,
    ROWS,
    SLIP,
    SUPPLIED,
    TIME,
    TOTAL,
    TURN,
    Angles,
    X,
    Y,
)
from reference.problem.can import Parameters
from reference.problem.effects import Effects
from reference.problem.problem import Problem
from reference.problem.states import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """The can and its point mass as one rigid body.

    Attributes
    ----------
    parameters : Parameters
    effects : Effects
    mass : float
    centre : ndarray, shape (3,)
        Centre of mass from the middle of the can, in axes fixed to the can.
    inertia : ndarray, shape (3, 3)
        About the centre of mass, in these axes.
    """

    parameters: Parameters
    effects: Effects
    mass: float
    centre: Floats
    inertia: Floats

    @classmethod
    def of(cls, parameters: Parameters, effects: Effects) -> "Body":
        """Return the body of a can and its effects."""
        mass, centre, inertia = body_of(parameters, effects, np.zeros(1))
        return cls(
            parameters=parameters,
            effects=effects,
            mass=mass,
            centre=centre[:, 0],
            inertia=inertia[..., 0],
        )

    def lowest(self, axis: Floats) -> Floats:
        """Return the lowest point of the can from its middle, for axes of shape (n, 3)."""
        r, h = self.effects.rim, self.parameters.h
        S = np.hypot(axis[:, 0], axis[:, 1])
        side = np.where(axis[:, 2] < 0, -1.0, 1.0)
        safe = np.where(S > 0, S, 1.0)
        # towards the side to which the axis leans, below by the height of that side's rim
        ahead = np.where(S > 0, axis[:, 0] / safe, -1.0), np.where(S > 0, axis[:, 1] / safe, 0.0)
        out = side * (1 - r) * np.abs(axis[:, 2]) - side * (h - r) * S
        down = (1 - r) * S + (h - r) * np.abs(axis[:, 2]) + r
        return np.stack([out * ahead[0], out * ahead[1], -down], axis=-1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Launch:
    """The beginning of a flight, in the world.

    Attributes
    ----------
    time : float
    frame : ndarray, shape (3, 3)
        Columns are the axes fixed to the can.
    turning, centre, velocity : ndarray, shape (3,)
        Angular velocity; place and velocity of the centre of mass.
    psi, total : float
        Precession, and its sum with the rotation, with all full turns.
    gap, rise : float
        Height of the lowest point of the rim, and its vertical velocity.
    dissipated, supplied : float
        Works since the release.
    """

    time: float
    frame: Floats
    turning: Floats
    centre: Floats
    velocity: Floats
    psi: float
    total: float
    gap: float = 0.0
    rise: float = 0.0
    dissipated: float = 0.0
    supplied: float = 0.0


def axes_of_b(y: Floats) -> Floats:
    """Return the axes of frame B in the world as columns, shape (3, 3), of a state (13,)."""
    at = Angles.of(y[LEAN])
    cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
    ahead, aside, up = np.array([cos, sin, 0.0]), np.array([-sin, cos, 0.0]), np.eye(3)[2]
    return np.stack([at.C * ahead + at.S * up, aside, at.C * up - at.S * ahead], axis=-1)


def launch_of(y: Floats, body: Body, *, rise: float = 0.0, gap: float = 0.0) -> Launch:
    """Return the flight that begins at a state on the rim, shape (13,).

    Parameters
    ----------
    y : ndarray, shape (13,)
        With the horizontal velocity of the rim's lowest point as its slip.
    body : Body
    rise, gap : float
        Vertical velocity and height of that point.
    """
    axes = axes_of_b(y)
    theta = y[TOTAL] - y[PSI]
    cos, sin = np.cos(theta), np.sin(theta)
    frame = axes @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    turning = axes @ y[TURN]
    lever = frame @ body.centre
    offset = body.lowest(axes[:, 2][None])[0]
    point = np.array([y[X], y[Y], gap])
    (ahead, aside), c, s = y[SLIP], np.cos(y[PSI]), np.sin(y[PSI])
    material = np.array([ahead * c - aside * s, ahead * s + aside * c, rise])
    return Launch(
        time=float(y[TIME]),
        frame=frame,
        turning=turning,
        centre=point - offset + lever,
        velocity=material - np.cross(turning, offset - lever),
        psi=float(y[PSI]),
        total=float(y[TOTAL]),
        gap=gap,
        rise=rise,
        dissipated=float(y[DISSIPATED]),
        supplied=float(y[SUPPLIED]),
    )


def at_lowest(y: Floats, body: Body) -> Floats:
    """Return a flat can's state, shape (13,), with the point that falls fastest as its contact.

    The precession grows by the angle to that point, by half a turn where it is the opposite one,
    and the rotation falls by as much. At that point the can does not roll along the rim: theta' is
    zero.
    """
    at = Angles.of(y[LEAN])
    w1, w2, w3 = y[TURN].tolist()
    vertical, radius, level = float(at.S * w1 + at.C * w3), 1 - body.effects.rim, hypot(w1, w2)
    if level == 0.0:
        return y
    cos, sin = -w2 / level, w1 / level
    moved = y.copy()
    moved[PSI] += atan2(sin, cos) if sin else (0.0 if cos > 0 else pi)
    # of a can so flat this moves nothing, but what friction holds on the rim starts from rest
    moved[TURN] = w3 * float(at.S / at.C), -level, w3
    # the point goes from -radius l1 to -radius l1', the axes l1 and l2 turn with the precession
    ahead, aside = (y[SLIP] + radius * vertical * np.array([sin, 1 - cos])).tolist()
    moved[SLIP] = cos * ahead + sin * aside, cos * aside - sin * ahead
    moved[X] += radius * (np.cos(y[PSI]) - np.cos(moved[PSI]))
    moved[Y] += radius * (np.sin(y[PSI]) - np.sin(moved[PSI]))
    return moved


def rises_of_face(y: Floats, rise: float, body: Body) -> tuple[float, float]:
    """Return the least and the largest vertical velocity of the rim of a flat can.

    Of a state, shape (13,), whose contact rises at the given velocity.
    """
    radius, (w1, w2, _) = 1 - body.effects.rim, y[TURN].tolist()
    middle, most = rise - radius * w2, radius * hypot(w1, w2)
    return middle - most, middle + most


def on_rim(launch: Launch, body: Body) -> Floats:
    """Return the state on the rim, shape (13,), of a can that touches the plane."""
    axis = launch.frame[:, 2]
    S, C = float(np.hypot(axis[0], axis[1])), float(axis[2])
    y = np.zeros(ROWS)
    y[LEAN] = np.log(S / (1 + C))
    y[PSI], y[TOTAL], y[TIME] = launch.psi, launch.total, launch.time
    y[TURN] = axes_of_b(y).T @ launch.turning
    offset = body.lowest(axis[None])[0]
    lever = launch.frame @ body.centre
    point = launch.centre - lever + offset
    material = launch.velocity + np.cross(launch.turning, offset - lever)
    cos, sin = np.cos(launch.psi), np.sin(launch.psi)
    y[SLIP] = cos * material[0] + sin * material[1], cos * material[1] - sin * material[0]
    y[X], y[Y] = point[:2]
    y[DISSIPATED], y[SUPPLIED] = launch.dissipated, launch.supplied
    return y


def rising(launch: Launch, body: Body) -> float:
    """Return the vertical velocity of the lowest point of the rim."""
    offset = body.lowest(launch.frame[:, 2][None])[0] - launch.frame @ body.centre
    return float((launch.velocity + np.cross(launch.turning, offset))[2])


def moves_in_a_plane(problem: Problem) -> bool:
    """Return whether nothing ever turns the can out of the vertical plane of its axis."""
    e = problem.effects
    pushed = (*e.gravity.constant[:2], *e.gravity.amplitude[:2])
    level = not any(pushed) or (problem.psi == 0.0 and not any(pushed[1::2]))
    beside = e.mass is not None and (e.mass.y != 0.0 or (e.mass.x != 0.0 and problem.theta != 0.0))
    turns = problem.psi_dot or problem.theta_dot or problem.slip[1]
    return level and not beside and not turns
