"""The angles of a whole record: psi and theta without jumps, and where the record cannot tell.

A quaternion fixes psi and theta to within whole turns only. Their sum sigma is always smooth,
because the rate psi' + theta' stays moderate even where each of them runs away; so sigma is
unwrapped first. With sigma known, psi is left with whole turns (sigma and delta = psi - theta
change branch together), and in a bounce it may move through half a turn in a microsecond.

The branch is the one nearest to what the rates on both sides of an interval predict. In a bounce
phi exp(i chi), with chi = psi sqrt(a_p/(a_p + 1)), moves on a straight line at constant speed; its
argument from one sample to the next follows from phi'/phi + i chi' at each. Away from the bounce
the same expression is the trapezoidal rule. Where psi moves by more than a right angle between
samples, by the chosen branch or by the rates, the record is too coarse to know and says so.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.can import Can
from models.errors import ModelError
from models.kinematics import TURN, Floats, angle_rates, half_angles, whole_turns

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
    """Return the angles of a record, unwrapped.

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
    ModelError
        If the shapes do not agree.
    """
    t = np.asarray(time, dtype=np.float64)
    n = t.size
    q = np.asarray(quaternion, dtype=np.float64)
    omega = np.asarray(angular_velocity, dtype=np.float64)
    if n == 0 or t.shape != (n,) or q.shape != (n, 4) or omega.shape != (n, 3):
        raise ModelError(
            f"a record needs `time` of shape (n,), `quaternion` (n, 4) and `angular_velocity` "
            f"(n, 3), n at least 1; found {t.shape}, {q.shape} and {omega.shape}"
        )
    phi, sigma, delta = half_angles(q)
    phi_dot, psi_dot, theta_dot = angle_rates(phi, (sigma + delta) / 2.0, omega)

    dt = np.diff(t)
    mean_rate = (psi_dot + theta_dot)[:-1] / 2.0 + (psi_dot + theta_dot)[1:] / 2.0
    sigma_unwrapped = _unwrap(sigma, mean_rate * dt)
    flipped = np.rint((sigma_unwrapped - sigma) / TURN)  # delta changes branch with sigma
    psi_wrapped = (sigma_unwrapped + delta + TURN * flipped) / 2.0
    predicted = _predicted_turn(can, dt, phi, phi_dot, psi_dot)
    psi = _unwrap(psi_wrapped, predicted)
    theta = sigma_unwrapped - psi

    too_far = np.maximum(np.abs(np.diff(psi)), np.abs(predicted)) > RESOLVED_STEP
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
