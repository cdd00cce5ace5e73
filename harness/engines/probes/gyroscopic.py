"""The gyroscopic term: a spinning can, free of torque, against its closed form.

Without torque the angular momentum L and the energy E are kept. For a can with moments A, A, C the
spin n about its axis is kept too, so with w the rest of the angular velocity

    L = A w + C n axis,        axis' = omega x axis = (L / A) x axis

and the axis goes round L at the constant rate |L|/A, at a constant angle: Euler's top. In the frame
of the body w turns at k = n (A - C)/A. An explicit step of dt multiplies it by sqrt(1 + (k dt)^2),
so |w|^2 grows at the rate k^2 dt; an implicit one shrinks it at the same rate.

A spin about the axis alone has no gyroscopic term. What such a flight loses is damping, and it is
divided out of the energy of the other.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.core.case import Case, Value
from harness.core.errors import RefusedModelError
from harness.core.trajectory import Floats
from harness.engines.base import Setting, World
from harness.engines.probes.fixture import (
    ALOFT,
    UPRIGHT,
    Evidence,
    Opener,
    ProbeFinding,
    Trace,
    aloft,
)
from harness.engines.stepping.horizon import natural_time
from models.kinematics import to_body
from models.state import Pose, Twist

SPIN = (0.3, 0.0, 2.0)
"""Angular velocity at first, in the body's frame, over the natural rate sqrt(g/R)."""

DURATION = 20.0
"""Natural times: some six turns of the axis about L."""

_MOST_STEPS = 100_000
"""Beyond it the flight is cut short: a tenth of a second of a timestep of a microsecond."""

_SAMPLES = 200

_EFFECT = "gyroscopic term"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """A torque-free flight against its closed form; every array has n samples.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    energy, momentum : ndarray, shape (n,)
        Gain of the energy and of |L|, relative.
    tilt_of_momentum : ndarray, shape (n,)
        Angle of L to what it was, rad.
    axis : ndarray, shape (n,)
        Angle of the axis to the closed form, rad.
    """

    time: Floats
    energy: Floats
    momentum: Floats
    tilt_of_momentum: Floats
    axis: Floats


def flight(world: World, spin: Floats, duration: float) -> Flight:
    """Return the flight of a spinning can in a world without gravity.

    Parameters
    ----------
    world : World
    spin : ndarray, shape (3,)
        Angular velocity at first, in the body's frame, rad/s.
    duration : float
        s.
    """
    moments = np.asarray(world.inertia, dtype=np.float64)  # the engine's own, whatever they are
    world.place(
        Pose(position=np.array((0.0, 0.0, ALOFT)), quaternion=UPRIGHT),
        Twist(velocity=np.zeros(3), angular_velocity=spin),
    )
    steps = min(_MOST_STEPS, max(1, round(duration / world.timestep)))
    stride = max(1, steps // _SAMPLES)
    # the body's frame is the world's at first
    L_0, E_0 = moments * spin, 0.5 * float(moments @ spin**2)
    precession = float(np.linalg.norm(L_0)) / float((moments[0] + moments[1]) / 2.0)
    rows = []
    for step in range(0, steps + 1, stride):
        pose, twist = world.pose(), world.twist()
        omega = to_body(pose.quaternion, twist.angular_velocity)
        L = _to_world(pose, moments * omega)
        closed = _turned(np.array((0.0, 0.0, 1.0)), L_0, precession * step * world.timestep)
        axis = _to_world(pose, np.array((0.0, 0.0, 1.0)))
        rows.append(
            (
                step * world.timestep,
                0.5 * float(moments @ omega**2) / E_0 - 1.0,
                float(np.linalg.norm(L) / np.linalg.norm(L_0)) - 1.0,
                _angle(L, L_0),
                _angle(axis, closed),
            )
        )
        for _ in range(min(stride, steps - step)):
            world.step()
    time, energy, momentum, tilt, off = np.array(rows).T
    return Flight(time=time, energy=energy, momentum=momentum, tilt_of_momentum=tilt, axis=off)


def gyroscopic(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield what a torque-free flight gains, and with which other settings it gains otherwise."""
    base = _beyond_damping(aloft(engine, case), case)
    how = f"free flight for {base.time[-1]:.3g} s at a spin of 2 and a wobble of 0.3 sqrt(g/R)"
    for quantity, unit, values in (
        ("energy gained", "1", base.energy),
        ("angular momentum gained", "1", base.momentum),
        ("turn of the angular momentum", "rad", base.tilt_of_momentum),
        ("angle of the axis to the closed form", "rad", base.axis),
    ):
        yield _finding(quantity, unit, float(values[-1]), how)
    yield Trace(
        effect=_EFFECT,
        x_label="time [s]",
        y_label="energy gained [1]",
        x=base.time,
        y=base.energy,
    )
    for name, value in alternatives(engine.settings, case):
        other = replace(case, options=(*case.options, (name, value)))
        try:
            world = aloft(engine, other)
        except RefusedModelError:  # the engine does not take this value with the others
            continue
        changed = _beyond_damping(world, case)
        if not np.array_equal(changed.energy, base.energy):
            quantity = f"energy gained with {name}={value}"
            yield _finding(quantity, "1", float(changed.energy[-1]), how)


def _beyond_damping(world: World, case: Case) -> Flight:
    """Return the flight of `SPIN`, its gains over those of a spin as fast about the axis alone."""
    T = natural_time(case.scene)
    spin = np.array(SPIN) / T
    free = flight(world, spin, DURATION * T)
    plain = flight(world, np.array((0.0, 0.0, np.linalg.norm(spin))), DURATION * T)
    return replace(
        free,
        energy=(1.0 + free.energy) / (1.0 + plain.energy) - 1.0,
        momentum=(1.0 + free.momentum) / (1.0 + plain.momentum) - 1.0,
    )


def alternatives(settings: tuple[Setting, ...], case: Case) -> Iterator[tuple[str, Value]]:
    """Yield each word or truth value that a setting can take, unless the case sets it itself."""
    for setting in settings:
        if setting.name in dict(case.options):
            continue
        values: tuple[Value, ...] = setting.choices
        if isinstance(setting.default, bool):
            values = (False, True)
        for value in values:
            yield setting.name, value


def _finding(quantity: str, unit: str, value: float, how: str) -> ProbeFinding:
    return ProbeFinding(
        effect=_EFFECT, quantity=quantity, unit=unit, value=value, expected=0.0, how=how
    )


def _to_world(pose: Pose, vector: Floats) -> Floats:
    """Return a vector of the body in world coordinates."""
    return to_body(pose.quaternion * np.array((1.0, -1.0, -1.0, -1.0)), vector)


def _turned(vector: Floats, about: Floats, angle: float) -> Floats:
    """Return a vector turned about another by an angle (Rodrigues)."""
    e = about / np.linalg.norm(about)
    turned: Floats = (
        vector * math.cos(angle)
        + np.cross(e, vector) * math.sin(angle)
        + e * float(e @ vector) * (1.0 - math.cos(angle))
    )
    return turned


def _angle(one: Floats, other: Floats) -> float:
    """Return the angle between two vectors, rad, exact for small ones."""
    return math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))
