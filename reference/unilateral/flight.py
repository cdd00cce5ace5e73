"""Free flight of a can: exact at every instant.

The centre of mass G moves under constant and shaken gravity and linear drag,

    v' = g + s sin(W t + p) - l v,

and the can turns about it with I w' = -w x I w - n I w. Both have closed forms. Angular drag is the
torque-free motion in the time (1 - exp(-n t))/n, with all rates times exp(-n t). A body that is
symmetric about its axis turns about its angular momentum L at the rate |L|/A and about its own axis
at (1 - C/A) w3 (Landau and Lifshitz, Mechanics, section 33). A point mass beside the axis makes it
an asymmetric top, whose equations are quadratic: its Taylor series have a recurrence, and are
summed to round-off, step by step.
"""

from dataclasses import dataclass

import numpy as np

from reference.equations.frames import to_level
from reference.equations.state_vector import LEAN, TURN, Angles
from reference.problem.states import Floats
from reference.unilateral.free_body import Body, Launch, launch_of

TAYLOR = 24
# A step of the Taylor series covers this share of its radius of convergence: 0.2^25 is 3e-18.
SHARE = 0.2
SMALL = 0.1


def _phi_1(x: Floats) -> Floats:
    """Return (exp(x) - 1)/x."""
    tiny = np.abs(x) < np.finfo(float).tiny
    return np.where(tiny, 1.0, np.expm1(x) / np.where(tiny, 1.0, x))


def _phi_2(x: Floats) -> Floats:
    """Return (exp(x) - 1 - x)/x^2."""
    small = np.abs(x) < SMALL
    series = np.zeros_like(x)
    for k in range(13, 1, -1):
        series = (series * x + 1.0) / k
    # of 1/2! + x/3! + ...: the nested sum above
    safe = np.where(small, 1.0, x)
    return np.where(small, series, (np.expm1(safe) - safe) / safe**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeStates:
    """A flying can at n instants, in the world.

    Attributes
    ----------
    frame : ndarray, shape (n, 3, 3)
        Columns are the axes fixed to the can.
    turning, turning_rate : ndarray, shape (n, 3)
        Angular velocity and its derivative.
    middle, velocity, acceleration : ndarray, shape (n, 3)
        Of the middle of the can.
    """

    frame: Floats
    turning: Floats
    turning_rate: Floats
    middle: Floats
    velocity: Floats
    acceleration: Floats


class _SymmetricTop:
    """Torque-free turning of a body with two equal moments of inertia."""

    def __init__(self, body: Body, frame: Floats, turning: Floats) -> None:
        A, C = float(body.inertia[0, 0]), float(body.inertia[2, 2])
        momentum = frame @ (body.inertia @ (frame.T @ turning))
        self._frame, self._excess = frame, 1.0 - C / A
        self._axial = float(frame[:, 2] @ turning)
        self._precession = momentum / A

    def at(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return axes (n, 3, 3), angular velocity and its derivative (n, 3)."""
        rate = float(np.linalg.norm(self._precession))
        axis = self._precession / rate if rate > 0 else np.array([0.0, 0.0, 1.0])
        own = _about(np.array([0.0, 0.0, 1.0]), self._excess * self._axial * times)
        frame = _about(axis, rate * times) @ self._frame @ own
        e = frame[:, :, 2]
        turning = self._precession + self._excess * self._axial * e
        slope = self._excess * self._axial * np.cross(np.broadcast_to(self._precession, e.shape), e)
        return frame, turning, slope


class _AsymmetricTop:
    """Torque-free turning of any rigid body, by Taylor series."""

    def __init__(self, body: Body, frame: Floats, turning: Floats) -> None:
        self._inertia, self._inverse = body.inertia, np.linalg.inv(body.inertia)
        self._starts, self._series = [0.0], [self._expanded(frame, frame.T @ turning)]

    def _expanded(self, frame: Floats, w: Floats) -> tuple[Floats, Floats, float]:
        """Return Taylor coefficients (TAYLOR + 1, 3, 3) and (TAYLOR + 1, 3), and their step."""
        frames, turns = np.zeros((TAYLOR + 1, 3, 3)), np.zeros((TAYLOR + 1, 3))
        frames[0], turns[0] = frame, w
        momenta = np.zeros((TAYLOR + 1, 3))
        spins = np.zeros((TAYLOR + 1, 3, 3))
        for k in range(TAYLOR):
            momenta[k], spins[k] = self._inertia @ turns[k], _skew(turns[k])
            torque = np.cross(momenta[k::-1], turns[: k + 1]).sum(axis=0)
            turns[k + 1] = self._inverse @ torque / (k + 1)
            frames[k + 1] = np.einsum("jab,jbc->ac", frames[k::-1], spins[: k + 1]) / (k + 1)
        rate = float(np.linalg.norm(w))
        ends = max(
            float(np.abs(turns[-1]).max() / max(rate, 1e-300)) ** (1 / TAYLOR),
            float(np.abs(frames[-1]).max()) ** (1 / TAYLOR),
            1e-300,
        )
        return frames, turns, SHARE / ends

    def at(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return axes (n, 3, 3), angular velocity and its derivative (n, 3)."""
        while self._starts[-1] + self._series[-1][2] < times.max(initial=0.0):
            frames, turns, step = self._series[-1]
            powers = step ** np.arange(TAYLOR + 1)
            frame, w = np.tensordot(powers, frames, 1), powers @ turns
            self._starts.append(self._starts[-1] + step)
            self._series.append(self._expanded(frame, w))
        number = np.searchsorted(self._starts, times, side="right") - 1
        powers = (times - np.array(self._starts)[number])[:, None] ** np.arange(TAYLOR + 1)
        frame = np.einsum("nk,nkab->nab", powers, np.stack([s[0] for s in self._series])[number])
        w = np.einsum("nk,nka->na", powers, np.stack([s[1] for s in self._series])[number])
        torque = np.cross(w @ self._inertia, w)
        slope = np.einsum("nab,nb->na", frame, torque @ self._inverse)
        return frame, np.einsum("nab,nb->na", frame, w), slope


class Flight:
    """One flight, from its launch to any later time."""

    def __init__(self, body: Body, launch: Launch) -> None:
        self.body, self.launch = body, launch
        symmetric = body.centre[0] == body.centre[1] == 0.0
        top = _SymmetricTop if symmetric else _AsymmetricTop
        self._top = top(body, launch.frame, launch.turning)

    def at(self, after: Floats) -> FreeStates:
        """Return states at times after the launch, shape (n,)."""
        body, own = self.body, self.launch
        after = np.asarray(after, dtype=float)
        nu = body.effects.angular_damping
        fade = np.exp(-nu * after)[:, None]
        frame, turning, slope = self._top.at(after * _phi_1(-nu * after))
        turning, slope = fade * turning, fade * (fade * slope - nu * turning)
        place, velocity, acceleration = self._centre(after)
        lever = frame @ body.centre
        swing = np.cross(turning, lever)
        return FreeStates(
            frame=frame,
            turning=turning,
            turning_rate=slope,
            middle=own.centre + place - lever,
            velocity=velocity - swing,
            acceleration=acceleration - np.cross(slope, lever) - np.cross(turning, swing),
        )

    def _centre(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the way, velocity and acceleration of the centre of mass, each of shape (n, 3)."""
        gravity, drag = self.body.effects.gravity, self.body.effects.linear_damping
        constant, shaken = np.array(gravity.constant), np.array(gravity.amplitude)
        start = gravity.rate * self.launch.time + gravity.phase
        if gravity.rate == 0.0:
            constant, shaken = constant + shaken * np.sin(gravity.phase), 0.0 * shaken
        one, two = s * _phi_1(-drag * s), s * s * _phi_2(-drag * s)
        velocity = self.launch.velocity
        way = np.outer(one, velocity) + np.outer(two, constant)
        speed = np.outer(np.exp(-drag * s), velocity) + np.outer(one, constant)
        wave = np.zeros_like(s)
        if shaken.any():
            rate = gravity.rate
            wave, half, mean = np.sin(start + rate * s), rate * s / 2, start + rate * s / 2
            # integrals of the sine and the cosine, without a difference; with drag, and of `move`,
            # differences are taken, whose round-off is that of 1/rate^2, not of the way
            sines = s * np.sinc(half / np.pi) * np.sin(mean)
            cosines = s * np.sinc(half / np.pi) * np.cos(mean)
            size = drag * drag + rate * rate
            push = (
                drag * wave
                - rate * np.cos(start + rate * s)
                - np.exp(-drag * s) * (drag * np.sin(start) - rate * np.cos(start))
            ) / size
            if drag == 0.0:
                push = sines
            move = drag * sines - rate * cosines
            move = (move - one * (drag * np.sin(start) - rate * np.cos(start))) / size
            way, speed = way + np.outer(move, shaken), speed + np.outer(push, shaken)
        return way, speed, constant + np.outer(wave, shaken) - drag * speed

    def rates(self) -> float:
        """Return the fastest rate of the motion, with 1 of the fall."""
        turning = float(np.linalg.norm(self.launch.turning))
        largest = float(np.diag(self.body.inertia).max() / np.diag(self.body.inertia).min())
        return 1.0 + turning * max(largest, 1.0) + self.body.effects.gravity.rate


def fall_of(body: Body, y: Floats, psi_dot: float) -> float:
    """Return phi'' of a can in the air, of a state (13,) that is released there."""
    launch = launch_of(y, body)
    there = Flight(body, launch).at(np.zeros(1))
    level = to_level(y[TURN, None], Angles.of(y[LEAN, None]))[:, 0]
    aside = np.array([-np.sin(launch.psi), np.cos(launch.psi), 0.0])
    return float(psi_dot * level[0] - there.turning_rate[0] @ aside)


def _skew(w: Floats) -> Floats:
    """Return the matrix of the vector product with w."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def _about(axis: Floats, angles: Floats) -> Floats:
    """Return rotations about an axis of length 1, shape (n, 3, 3)."""
    matrix = _skew(axis)
    half = np.sin(angles / 2)
    turned = np.sin(angles)[:, None, None] * matrix
    return np.asarray(np.eye(3) + turned + (2 * half * half)[:, None, None] * (matrix @ matrix))
