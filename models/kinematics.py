"""The paper's angles and frames: angles and rates to quaternion and angular velocity, and back.

Precession psi about the vertical, nutation phi, then rotation theta about the symmetry axis take
the world to the body (eq01:rotation_matrices):

    R_WB = Rz(psi) Ry(-phi) Rz(theta)

so the symmetry axis points to (-sin phi cos psi, -sin phi sin psi, cos phi) in the world. The
paper's frame B takes no part in the spin; in it the angular velocity of the body is

    Omega = (psi' sin phi, -phi', psi' cos phi + theta')

In half angles, with sigma = psi + theta and delta = psi - theta, the quaternion is

    w + i z = cos(phi/2) exp(i sigma/2)        -y + i x = sin(phi/2) exp(i delta/2)

Both complex numbers are known to full relative precision however small phi is, so phi and delta,
hence psi and theta, come out right within round-off down to phi = 1e-300, where arccos(cos phi)
gives up at 1e-8. In the flat can (phi = 0) only sigma has a meaning; delta is zero by convention.

Arrays broadcast: angles have shape (...), vectors (..., 3), quaternions (..., 4), scalar first and
from body to world.
"""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.can import Can
from models.errors import RecordShapeError

Floats: TypeAlias = NDArray[np.float64]

TURN = 2.0 * np.pi


def quaternion(phi: ArrayLike, psi: ArrayLike, theta: ArrayLike) -> Floats:
    """Return the rotation from body to world.

    Parameters
    ----------
    phi, psi, theta : array_like, shape (...)
        Nutation, precession and rotation, rad.

    Returns
    -------
    ndarray, shape (..., 4)
        Unit quaternion, scalar first.
    """
    given: Any = phi, psi, theta
    if all(isinstance(angle, float) for angle in given):  # as probes ask: a fifteenth of the time
        return np.array(_quaternion(*given))
    return np.stack(_quaternion(*np.broadcast_arrays(*given)), axis=-1)


def _quaternion(phi: Floats, psi: Floats, theta: Floats) -> tuple[Floats, ...]:
    """Return the components of the rotation from body to world, of numbers or arrays."""
    half_sum, half_difference = (psi + theta) / 2.0, (psi - theta) / 2.0
    cos, sin = np.cos(phi / 2.0), np.sin(phi / 2.0)
    return (
        cos * np.cos(half_sum),
        sin * np.sin(half_difference),
        -sin * np.cos(half_difference),
        cos * np.sin(half_sum),
    )


def _components(array: ArrayLike) -> list[Any]:
    """Return the components of vectors or quaternions, floats of a single one.

    `numpy.moveaxis` takes ten times as long, and so does arithmetic with scalars of numpy.
    """
    array = np.asarray(array, dtype=np.float64)
    if array.ndim == 1:
        single: list[float] = array.tolist()
        return single
    return [array[..., place] for place in range(array.shape[-1])]


def half_angles(quaternion: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Return nutation, and the sum and difference of precession and rotation.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        From body to world, scalar first; its length and sign do not matter for `phi`.

    Returns
    -------
    phi, sigma, delta : ndarray, shape (...)
        phi in [0, pi], sigma = psi + theta and delta = psi - theta in [-2 pi, 2 pi], rad. The
        opposite quaternion, the same rotation, moves sigma and delta by 2 pi each.
    """
    w, x, y, z = _components(quaternion)
    phi = _nutation(w, x, y, z)
    sigma = 2.0 * np.arctan2(z, w)
    delta = 2.0 * np.arctan2(x, 0.0 - y)  # not -y: arctan2(0, -0.0) is pi, and flat means zero
    return phi, sigma, delta


def nutation(quaternion: ArrayLike) -> Floats:
    """Return nutation alone, rad, shape (...); see `half_angles`."""
    return _nutation(*_components(quaternion))


def _nutation(w: Floats, x: Floats, y: Floats, z: Floats) -> Floats:
    phi: Floats = 2.0 * np.arctan2(np.hypot(x, y), np.hypot(w, z))
    return phi


def angles(quaternion: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Return the paper's angles of a rotation, psi and theta each in (-pi, pi].

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        From body to world, scalar first.

    Returns
    -------
    phi, psi, theta : ndarray, shape (...)
        rad; phi in [0, pi]. For psi and theta without jumps see `angles_of_record`.
    """
    phi, sigma, delta = half_angles(quaternion)
    return phi, principal((sigma + delta) / 2.0), principal((sigma - delta) / 2.0)


def whole_turns(angle: ArrayLike) -> Floats:
    """Return the number of turns, an integer, that leads from the angle's equal in (-pi, pi].

    Parameters
    ----------
    angle : array_like, shape (...)
        rad.
    """
    return np.ceil(np.asarray(angle, dtype=np.float64) / TURN - 0.5)


def principal(angle: ArrayLike) -> Floats:
    """Return the angle's equal in (-pi, pi], shape (...), rad; itself where it is there already."""
    return np.asarray(angle, dtype=np.float64) - TURN * whole_turns(angle)


def angular_velocity(
    phi: ArrayLike, psi: ArrayLike, phi_dot: ArrayLike, psi_dot: ArrayLike, theta_dot: ArrayLike
) -> Floats:
    """Return the angular velocity of the body in world coordinates.

    Parameters
    ----------
    phi, psi : array_like, shape (...)
        rad.
    phi_dot, psi_dot, theta_dot : array_like, shape (...)
        rad/s.

    Returns
    -------
    ndarray, shape (..., 3)
        rad/s: psi' about the vertical, -phi' about the horizontal axis of nutation, theta' about
        the symmetry axis.
    """
    phi, psi, phi_dot, psi_dot, theta_dot = np.broadcast_arrays(
        phi, psi, phi_dot, psi_dot, theta_dot
    )
    inwards = theta_dot * np.sin(phi)  # of theta' the horizontal part, where the axis leans to
    return np.stack(
        (
            phi_dot * np.sin(psi) - inwards * np.cos(psi),
            -phi_dot * np.cos(psi) - inwards * np.sin(psi),
            psi_dot + theta_dot * np.cos(phi),
        ),
        axis=-1,
    )


_ROUNDINGS = 4.0
"""Of a sum of two products, relative to their size: the angle, its functions and the sum."""


def angle_rates(
    phi: ArrayLike, psi: ArrayLike, angular_velocity: ArrayLike
) -> tuple[Floats, Floats, Floats]:
    """Return the rates of the angles, the inverse of `angular_velocity`.

    Parameters
    ----------
    phi, psi : array_like, shape (...)
        rad.
    angular_velocity : array_like, shape (..., 3)
        In world coordinates, rad/s.

    Returns
    -------
    phi_dot, psi_dot, theta_dot : ndarray, shape (...)
        rad/s. Where sin phi is zero, psi' and theta' have no meaning apart from their sum: there
        psi' is zero and theta' is the whole spin. So it is where the part of the horizontal angular
        velocity that they share is round-off of that of phi'.
    """
    phi, psi = np.asarray(phi, dtype=np.float64), np.asarray(psi, dtype=np.float64)
    omega_x, omega_y, omega_z = _components(angular_velocity)
    cos_psi, sin_psi = np.cos(psi), np.sin(psi)
    outwards = omega_x * cos_psi + omega_y * sin_psi
    sin, cos = np.sin(phi), np.cos(phi)
    known = np.abs(outwards) > _ROUNDINGS * np.finfo(float).eps * np.hypot(omega_x, omega_y)
    outwards = np.where(known, outwards, 0.0)
    tilted = sin != 0.0
    ratio = np.divide(outwards, sin, out=np.zeros(np.broadcast(outwards, sin).shape), where=tilted)
    phi_dot = omega_x * sin_psi - omega_y * cos_psi
    psi_dot = np.where(tilted, omega_z + ratio * cos, 0.0)
    theta_dot = np.where(tilted, -ratio, omega_z * np.sign(cos))
    return phi_dot, psi_dot, theta_dot


def to_body(quaternion: ArrayLike, vector: ArrayLike) -> Floats:
    """Return a vector of the world in the coordinates of the body.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        From body to world, scalar first, of unit length.
    vector : array_like, shape (..., 3)
        In world coordinates.

    Returns
    -------
    ndarray, shape (..., 3)
    """
    return _turned(quaternion, vector, -1.0)


def to_world(quaternion: ArrayLike, vector: ArrayLike) -> Floats:
    """Return a vector of the body in world coordinates, shape (..., 3); see `to_body`."""
    return _turned(quaternion, vector, 1.0)


def _turned(quaternion: ArrayLike, vector: ArrayLike, sign: float) -> Floats:
    """Return vectors turned by a quaternion, or back: v + 2 w (n x v) + 2 n x (n x v)."""
    w, x, y, z = _components(quaternion)
    a, b, c = _components(vector)
    x, y, z = sign * x, sign * y, sign * z
    p, q, r = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    turned = (
        a + w * p + (y * r - z * q),
        b + w * q + (z * p - x * r),
        c + w * r + (x * q - y * p),
    )
    return np.array(turned) if isinstance(turned[0], float) else np.stack(turned, axis=-1)


RESOLVED_STEP = np.pi / 2.0
"""Change of psi from one sample to the next, rad, up to which its branch is beyond doubt."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Angles:
    """The paper's angles along a record, each an array of shape (n,), rad and rad/s.

    Parameters
    ----------
    phi, psi, theta : ndarray, shape (n,)
        Nutation in [0, pi]; precession and rotation without jumps.
    phi_dot, psi_dot, theta_dot : ndarray, shape (n,)
        Their rates, from the angular velocity (not by differences).
    unresolved : ndarray of bool, shape (n,)
        True at a sample that psi, hence theta, may have reached by another number of turns than
        stated, since it moved too far from the sample before. The first is False.
    """

    phi: Floats
    psi: Floats
    theta: Floats
    phi_dot: Floats
    psi_dot: Floats
    theta_dot: Floats
    unresolved: NDArray[np.bool_]


def angles_of_record(
    can: Can,
    time: ArrayLike,
    quaternion: ArrayLike,
    angular_velocity: ArrayLike,
    *,
    start: tuple[float, float] = (0.0, 0.0),
) -> Angles:
    """Return the angles of a whole record: psi and theta without jumps, and where it cannot tell.

    A quaternion fixes psi and theta to within whole turns only. Their sum sigma is always
    smooth, because the rate psi' + theta' stays moderate even where each of them runs away; so
    sigma is unwrapped first. With sigma known, psi is left with whole turns (sigma and delta =
    psi - theta change branch together), and in a bounce it may move through half a turn in a
    microsecond.

    The branch is the one nearest to what the rates on both sides of an interval predict. In a
    bounce phi exp(i chi), with chi = psi sqrt(a_p/(a_p + 1)), moves on a straight line at
    constant speed; its argument from one sample to the next follows from phi'/phi + i chi' at
    each. Away from the bounce the same expression is the trapezoidal rule. Where psi moves by
    more than a right angle between samples, by the chosen branch or by the rates, the record is
    too coarse to know and says so.

    A can that moves in a plane and passes the flat state goes on over the opposite point of its
    rim: psi changes by half a turn at once, with no sense of its own. By convention it grows.

    Parameters
    ----------
    can : Can
        Its moments set how far psi turns in a bounce.
    time : array_like, shape (n,)
        s, increasing.
    quaternion : array_like, shape (n, 4)
        From body to world, scalar first.
    angular_velocity : array_like, shape (n, 3)
        In world coordinates, rad/s.
    start : (psi, theta)
        The angles at the first sample are taken on the branch nearest to these, rad.

    Returns
    -------
    Angles

    Raises
    ------
    RecordShapeError
        If the shapes do not agree.
    """
    t = np.asarray(time, dtype=np.float64)
    n = t.size
    q = np.asarray(quaternion, dtype=np.float64)
    omega = np.asarray(angular_velocity, dtype=np.float64)
    if n == 0 or t.shape != (n,) or q.shape != (n, 4) or omega.shape != (n, 3):
        raise RecordShapeError(t.shape, q.shape, omega.shape)
    phi, sigma, delta = half_angles(q)
    phi_dot, psi_dot, theta_dot = angle_rates(phi, (sigma + delta) / 2.0, omega)

    dt = np.diff(t)
    mean_rate = (psi_dot + theta_dot)[:-1] / 2.0 + (psi_dot + theta_dot)[1:] / 2.0
    sigma_unwrapped = _unwrap(sigma, mean_rate * dt)
    flipped = np.rint((sigma_unwrapped - sigma) / TURN)  # delta changes branch with sigma
    psi_wrapped = (sigma_unwrapped + delta + TURN * flipped) / 2.0
    predicted = _predicted_turn(can, dt, phi, phi_dot, psi_dot)
    level = _stays_in_plane(phi, phi_dot, psi_dot)
    # of no turn and half a turn, either way, a quarter is nearest to none and to half a turn on
    psi = _unwrap(psi_wrapped, np.where(level, np.pi / 2.0, predicted))
    theta = sigma_unwrapped - psi

    too_far = np.maximum(np.abs(np.diff(psi)), np.abs(predicted)) > RESOLVED_STEP
    too_far &= ~level
    unresolved = np.concatenate((np.zeros(1, dtype=np.bool_), too_far))
    return Angles(
        phi=phi,
        psi=psi + TURN * whole_turns(start[0] - psi[0]),
        theta=theta + TURN * whole_turns(start[1] - theta[0]),
        phi_dot=phi_dot,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        unresolved=unresolved,
    )


_IN_PLANE = 1e-6
"""Of phi: how near to the flat state a straight line passes that passes through it."""


def _stays_in_plane(phi: Floats, phi_dot: Floats, psi_dot: Floats) -> NDArray[np.bool_]:
    """Return the intervals in which the can moves in a vertical plane, shape (n-1,)."""
    across = np.abs(phi * psi_dot) < _IN_PLANE * np.abs(phi_dot)
    return across[:-1] & across[1:]


def _predicted_turn(can: Can, dt: Floats, phi: Floats, phi_dot: Floats, psi_dot: Floats) -> Floats:
    """Return the change of psi that the rates at both ends of each interval predict, shape (n-1,).

    Half an interval ahead from its first end and half an interval back from its last, each along
    the straight line of a bounce.
    """
    slowness = can.slowness
    flat = phi == 0.0
    rate = np.divide(phi_dot, phi, out=np.zeros_like(phi), where=~flat)
    growth = rate + 1j * slowness * psi_dot
    ahead = np.angle(1.0 + dt / 2.0 * growth[:-1])
    behind = np.angle(1.0 - dt / 2.0 * growth[1:])
    turn: Floats = (ahead - behind) / slowness
    return turn


def _unwrap(wrapped: Floats, predicted: Floats) -> Floats:
    """Add whole turns to each sample so that it follows the one before as predicted."""
    turns = np.cumsum(whole_turns(predicted - np.diff(wrapped)))
    return wrapped + TURN * np.concatenate((np.zeros(1), turns))
