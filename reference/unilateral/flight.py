"""Free flight of a can: exact at every instant, up to the next contact of a rim.

The centre of mass G moves under constant and shaken gravity and linear drag,

    v' = g + s sin(W t + p) - l v,

and the can turns about it with I w' = -w x I w - n I w. Both have closed forms. Angular drag is the
torque-free motion in the time (1 - exp(-n t))/n, with all rates times exp(-n t). A body that is
symmetric about its axis turns about its angular momentum L at the rate |L|/A and about its own axis
at (1 - C/A) w3 (Landau and Lifshitz, Mechanics, section 33). A point mass beside the axis makes it
an asymmetric top, whose equations are quadratic: its Taylor series have a recurrence, and are
summed to round-off, step by step.

The vector e of the axis, of vertical part C and horizontal length S, and the height z of the middle
decide on contact. A rim touches where F = d^2 - (1 - r)^2 S^2 falls to zero, with d = z - (h - r) C
- r, and C negated for the other rim. Unlike the gap d - (1 - r) S this F is smooth where the axis
passes the vertical. F'' is interpolated at Chebyshev points and integrated twice from the exact
beginning, so that a flight of a nanosecond is as exact as a long one; all roots of the polynomial
are computed (Boyd's colleague matrix), so that none is missed between samples.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from reference.problem.states import Floats
from reference.unilateral.free_body import Body, Launch

NODES = 26
# Chebyshev coefficients of F'' fall geometrically; the last two below this are round-off.
RESOLVED = 1e-13
# In units of the fastest rate of the motion; a piece of this length is mostly resolved.
USUAL = 2.0
# A piece shorter than this share of its rate no longer moves a double.
SHORTEST = 1e-15
# After the normal force has fallen to zero the gap grows as t^3: sooner than this, in units of the
# fastest rate, it is below round-off, and a root of it means nothing.
BLURRED = 1e-4
# Of the horizontal part of the axis: a can that stands on its face.
FACE = 1e-20
# A flight shorter than this, in units of the fastest rate, is over at its beginning.
BRIEFEST = 1e-12
# In R: a gap below minus this is no round-off.
PENETRATES = 1e-14
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
            # integrals of the sine and the cosine, which subtract nothing
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

    def margin(self, states: FreeStates, side: int = 1) -> tuple[Floats, Floats, Floats]:
        """Return F, F' and F'' of a rim, each of shape (n,); side -1 is the other rim."""
        r, h = self.body.effects.rim, self.body.parameters.h
        e = states.frame[:, :, 2]
        first = np.cross(states.turning, e)
        second = np.cross(states.turning_rate, e) + np.cross(states.turning, first)
        lever = side * (h - r)
        d = states.middle[:, 2] - lever * e[:, 2] - r
        v = states.velocity[:, 2] - lever * first[:, 2]
        a = states.acceleration[:, 2] - lever * second[:, 2]
        if r == 1.0:
            return d, v, a
        square = (1 - r) ** 2
        S = np.hypot(e[:, 0], e[:, 1])
        level, bend = (e[:, :2] * first[:, :2]).sum(1), (e[:, :2] * second[:, :2]).sum(1)
        bend += (first[:, :2] ** 2).sum(1)
        F = (d - (1 - r) * S) * (d + (1 - r) * S)
        return F, 2 * (d * v - square * level), 2 * (v * v + d * a - square * bend)

    def meets(self, most: float, *, lifted: bool = False) -> tuple[float, bool] | None:
        """Return when the next contact is, after the launch, and whether it is the lower rim's.

        Parameters
        ----------
        most : float
            How far to look; None is returned if there is no contact until then.
        lifted : bool
            Whether the flight begins because the normal force has fallen to zero.
        """
        rate = self.rates()
        start, length = 0.0, min(USUAL / rate, most)
        begun = self.margin(self.at(np.zeros(1)))
        F0 = 0.0 if self.launch.gap == 0.0 else float(begun[0][0])
        slope, bend = float(begun[1][0]), float(begun[2][0])
        if F0 == 0.0:
            S = float(np.hypot(*self.launch.frame[:2, 2]))
            r = self.body.effects.rim
            # the exact rise of the rim, which F' gives with its round-off
            slope = self.launch.rise * (2 * (1 - r) * S if r < 1.0 else 1.0)
            if S < FACE and r < 1.0:
                # both sides of the face leave the plane: F begins with the product of their rises
                slope = 0.0
                length = min(length, 6.0 * float(np.sqrt(max(bend, 0.0) / 2)))
            elif slope > 0 and bend < 0:
                length = min(length, 3.0 * slope / -bend)
        touching = F0 == 0.0
        while start < most:
            length = min(length, most - start)
            piece = self._piece(start, length)
            while piece is None:
                length /= 2
                if length * rate < SHORTEST:
                    return None
                piece = self._piece(start, length)
            states, bends = piece
            # C < 0 of a can that has tumbled: the other rim may be lower
            sides = (1, -1) if states.frame[:, 2, 2].min() < 0 else (1,)
            for_next: list[float] = []
            found: list[tuple[float, bool]] = []
            for side in sides:
                if side == 1:
                    own = bends
                    at_start, rise = F0, slope
                else:
                    other = self.margin(states, -1)
                    own = _fit(other[2])
                    at_start, rise = float(other[0][-1]), float(other[1][-1])
                once = chebyshev.chebint(own, lbnd=-1.0) * (length / 2)
                once[0] += rise
                twice = chebyshev.chebint(once, lbnd=-1.0) * (length / 2)
                twice[0] += at_start
                least = 0.0
                if touching and side == 1:
                    least = _first_possible(slope, own, length)
                    if lifted or slope == 0.0:
                        least = max(least, BLURRED / rate)
                root = _first_root(twice, length, least)
                if root is not None:
                    found.append((start + root, side == 1))
                if side == 1:
                    for_next = [float(twice.sum()), float(once.sum())]
            if found:
                return min(found)
            if self._below(states):
                # two roots too near to each other, or to the beginning, for a piece of this length
                length /= 4
                if length * rate < BRIEFEST:
                    return start, True
                continue
            start, touching = start + length, False
            F0, slope = for_next
            length = min(2 * length, USUAL / rate)
        return None

    def _below(self, states: FreeStates) -> bool:
        """Return whether the lowest point is below the plane at the end of a piece."""
        lowest = self.body.lowest(states.frame[:1, :, 2])[0, 2]
        return float(states.middle[0, 2] + lowest) < -PENETRATES

    def _piece(self, start: float, length: float) -> tuple[FreeStates, Floats] | None:
        """Return states at the nodes of a piece, and coefficients of F''; None if too long."""
        states = self.at(start + length * (_nodes() + 1) / 2)
        series = _fit(self.margin(states)[2])
        size = 1.0 + float(np.abs(series).max())
        return (states, series) if np.abs(series[-2:]).max() < RESOLVED * size else None


def _first_possible(slope: float, bends: Floats, length: float) -> float:
    """Return a time before which F, which begins at zero and rises, is not zero again."""
    largest = float(np.abs(bends).sum())
    if slope > 0:
        return 1.9 * slope / largest if largest > 0 else length
    # F begins with F''/2 t^2, as of a can that leaves the plane with its whole face
    start = float(chebyshev.chebval(-1.0, bends))
    change = float(np.abs(chebyshev.chebder(bends)).sum()) * 2 / length
    return 2.9 * max(start, 0.0) / change if change > 0 else length


def _first_root(series: Floats, length: float, least: float) -> float | None:
    """Return the first zero after `least` of a polynomial on [0, length] that is positive there."""
    tails = np.abs(series[1:]).sum()
    if series[0] > tails and least == 0.0:
        return None
    scale = float(np.abs(series).max())
    keep = np.flatnonzero(np.abs(series) > 1e-18 * scale)
    if not keep.size or keep[-1] == 0:
        return None
    trimmed = series[: keep[-1] + 1]
    roots = chebyshev.chebroots(trimmed)
    real = np.sort(roots[np.abs(roots.imag) < 1e-7].real)
    slopes = chebyshev.chebder(trimmed)
    for x in real.tolist():
        if not -1.0 - 1e-7 <= x <= 1.0 + 1e-7:
            continue
        for _ in range(4):
            slope = float(chebyshev.chebval(x, slopes))
            if slope == 0.0:
                break
            x = min(max(x - float(chebyshev.chebval(x, trimmed)) / slope, -1.0), 1.0)
        after = length * (x + 1) / 2
        # F falls through zero: a root where it rises is where a blurred beginning ends
        if after > least and float(chebyshev.chebval(x, slopes)) <= 0.0:
            return after
    return None


@lru_cache(maxsize=1)
def _nodes() -> Floats:
    """Return Chebyshev points of the second kind on [-1, 1], falling."""
    return np.cos(np.pi * np.arange(NODES + 1) / NODES)


@lru_cache(maxsize=1)
def _to_series() -> Floats:
    return np.asarray(np.linalg.inv(chebyshev.chebvander(_nodes(), NODES)))


def _fit(values: Floats) -> Floats:
    """Return Chebyshev coefficients of values at the nodes."""
    return _to_series() @ values


def _skew(w: Floats) -> Floats:
    """Return the matrix of the vector product with w."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def _about(axis: Floats, angles: Floats) -> Floats:
    """Return rotations about an axis of length 1, shape (n, 3, 3)."""
    matrix = _skew(axis)
    half = np.sin(angles / 2)
    turned = np.sin(angles)[:, None, None] * matrix
    return np.asarray(np.eye(3) + turned + (2 * half * half)[:, None, None] * (matrix @ matrix))
