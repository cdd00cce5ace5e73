"""Probes without gravity: damping, clamps, the turn in a step, gyroscopic term, stabilisation.

Without gravity and contact a velocity v is kept for ever. What one step of dt takes from it,
(v - v')/(v dt), is the rate of a damping; a law k_1 + k_2 |v| is linear and quadratic damping. The
spin about the symmetry axis, a principal axis, is kept likewise, and turns the can in a step by
omega dt, however much that is.

Without torque the angular momentum L and the energy E are kept too. For a can with moments A, A, C
the spin n about its axis is kept, so with w the rest of the angular velocity

    L = A w + C n axis,        axis' = omega x axis = (L / A) x axis

and the axis goes round L at the constant rate |L|/A, at a constant angle: Euler's top. In the frame
of the body w turns at k = n (A - C)/A. An explicit step of dt multiplies it by sqrt(1 + (k dt)^2),
so |w|^2 grows at the rate k^2 dt; an implicit step shrinks it at the same rate.

A spin about the axis alone has no gyroscopic term. What such a flight loses is damping, and it is
divided out of the energy of the other.

Stabilisation. Without gravity a can at rest stays at rest. Placed a little inside the plane,
balanced so that the contact force goes through its centre, it is pushed out by a contact that
corrects positions by velocities: speed and energy out of nothing. A true plane that takes up an
impact without rebound leaves no speed at all.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from harness.core.case import Case
from harness.core.errors import RefusedModelError
from harness.core.trajectory import Floats
from harness.engines.probes.survey import Opener, Reading, aloft, alternatives, follow, probe
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import (
    ALOFT,
    AT_REST,
    LYING,
    TURNED,
    UP,
    X,
    above_origin,
    lowered,
    moving,
    stepped,
    touching_pose,
)
from harness.engines.world import World
from models import InvalidValueError, Twist, to_body
from models.kinematics import to_world

RATES = (1.0, 3.0, 10.0, 30.0)
"""m/s and rad/s: below every clamp known."""

FAST = 1e4
"""m/s and rad/s: beyond what a scene of a metre reaches short of 1 mm cans."""

LADDER = tuple(FAST * share for share in (0.003, 0.01, 0.03, 0.1, 0.3, 1.0))
"""m/s and rad/s: a strong damping takes the greatest away in one step, a clamp does not."""

TURNS = (0.1, 0.3, 0.5, 0.7, 0.8, 1.0, 1.5, 2.0, 3.0)
"""rad in one step; past pi a turn is indistinguishable from its complement."""

_EXACT = 1e-9
"""Relative error up to which a turn counts as exact: round-off is 1e-15, a law of second order at
a tenth of a radian 1e-3."""

_KINDS = (("velocity", "m/s", "1/m"), ("spin", "rad/s", "1/rad"))


@probe("damping")
def damping(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the rates of linear and quadratic damping of velocity and of spin."""
    world = aloft(engine, case)
    dt = world.timestep
    for kind, unit, per in _KINDS:
        rates = [(given - _after(world, kind, given)) / (given * dt) for given in RATES]
        quadratic, linear = np.polyfit(RATES, rates, 1)
        # a rate is known to an ulp of the velocity over the timestep
        noise = 8.0 * 2.0**-52 / dt
        how = f"loss in one step of free flight at 1 to 30 {unit}"
        for law, rate, in_unit in (("linear", linear, "1/s"), ("quadratic", quadratic, per)):
            known = 0.0 if abs(rate) <= noise else float(rate)
            yield f"{law} damping of {kind}", in_unit, known, 0.0, how


@probe("velocity clamp")
def clamp(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the greatest velocity and the greatest spin that a step leaves."""
    world = aloft(engine, case)
    for kind, unit, _ in _KINDS:
        greatest = float(np.nanmax([abs(_after(world, kind, given)) for given in LADDER]))
        how = f"one step of free flight at 30 to 10,000 {unit}"
        yield f"greatest {kind} left by a step", unit, greatest, FAST, how


@probe("orientation update")
def turn(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the turn of the can in one step at a large spin."""
    world = aloft(engine, case)
    dt = world.timestep
    asked, turned = [], []
    for angle in TURNS:
        asked.append(_after(world, "spin", angle / dt) * dt)
        turned.append(math.nan if math.isnan(asked[-1]) else _turned(world.pose().quaternion))
    largest = int(np.nanargmax(asked))
    exact = [a for a, t in zip(asked, turned, strict=True) if abs(t / a - 1.0) <= _EXACT]
    how = "one step of free flight at a spin that the engine lets pass"
    yield "turn of the orientation in a step", "rad", turned[largest], asked[largest], how
    greatest = max(exact, default=0.0)
    yield "largest turn in a step that is exact", "rad", greatest, asked[largest], how


AXIS = to_world(LYING, UP)
"""Of a can that lies, in the world: so that its frame is not taken for the world's."""


def _after(world: World, kind: str, given: float) -> float:
    """Return what one step of free flight leaves of a velocity (m/s) or of a spin (rad/s).

    NaN where the step fails.
    """
    motion = moving(velocity=given * X) if kind == "velocity" else moving(spin=given * AXIS)
    try:
        after = stepped(world, above_origin(ALOFT, LYING), motion).twist()
    except InvalidValueError:
        return math.nan
    return float(after.velocity @ X if kind == "velocity" else after.angular_velocity @ AXIS)


def _turned(quaternion: Floats) -> float:
    """Return by how much a can has turned about its axis since it was placed; NaN if it tilted."""
    before, after = (Rotation.from_quat(each, scalar_first=True) for each in (LYING, quaternion))
    *vector, scalar = (after * before.inv()).as_quat().tolist()
    about = float(np.array(vector) @ AXIS)
    tilted = math.hypot(about, scalar) < _UPRIGHT
    return math.nan if tilted else 2.0 * math.atan2(about, scalar) % (2.0 * math.pi)


_UPRIGHT = math.cos(0.5)
"""Share of a turn that is about the axis while this has tilted by less than a radian."""


SPIN = (0.3, 0.0, 2.0)
"""Angular velocity at first, in the body's frame, over the natural rate sqrt(g/R)."""

DURATION = 20.0
"""Natural times: some six turns of the axis about L."""

_MOST_STEPS = 100_000
"""Beyond it the flight is cut short: a tenth of a second of a timestep of a microsecond."""

_SAMPLES = 200


def flight(world: World, spin: Floats, duration: float) -> Floats:
    """Return the flight of a spinning can in a world without gravity.

    Parameters
    ----------
    world : World
    spin : ndarray, shape (3,)
        Angular velocity at first, in the body's frame, rad/s.
    duration : float
        s.

    Returns
    -------
    ndarray, shape (n, 5)
        Of each sample the time (s), the gain of the energy and of |L|, relative, the angle of L to
        what it was, and the angle of the axis to the closed form (rad).
    """
    moments = np.asarray(world.inertia, dtype=np.float64)  # as compiled, right or wrong
    world.place(above_origin(ALOFT, TURNED), moving(spin=to_world(TURNED, spin)))
    steps = min(_MOST_STEPS, max(1, round(duration / world.timestep)))
    stride = max(1, steps // _SAMPLES)
    L_0, E_0 = to_world(TURNED, moments * spin), 0.5 * float(moments @ spin**2)
    size = float(np.linalg.norm(L_0))
    precession = L_0 / size * (size / float((moments[0] + moments[1]) / 2.0))
    rows = []
    for step in range(0, steps + 1, stride):
        pose, twist = world.pose(), world.twist()
        omega, time = to_body(pose.quaternion, twist.angular_velocity), step * world.timestep
        L, axis = (to_world(pose.quaternion, vector) for vector in (moments * omega, UP))
        closed = Rotation.from_rotvec(precession * time).apply(to_world(TURNED, UP))
        energy = 0.5 * float(moments @ omega**2) / E_0 - 1.0
        momentum = float(np.linalg.norm(L) / size) - 1.0
        rows.append((time, energy, momentum, _angle(L, L_0), _angle(axis, closed)))
        for _ in range(min(stride, steps - step)):
            world.step()
    return np.array(rows)


@probe("gyroscopic term")
def gyroscopic(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield energy and momentum gained in torque-free flight, and energy with other settings."""
    base = _beyond_damping(aloft(engine, case), case)
    time, *last = base[-1].tolist()
    how = f"free flight for {time:.3g} s at a spin of 2 and a wobble of 0.3 sqrt(g/R)"
    quantities = (
        ("energy gained", "1"),
        ("angular momentum gained", "1"),
        ("turn of the angular momentum", "rad"),
        ("angle of the axis to the closed form", "rad"),
    )
    for (quantity, unit), value in zip(quantities, last, strict=True):
        yield quantity, unit, value, 0.0, how
    for name, value in alternatives(engine.settings, case):
        other = replace(case, options=(*case.options, (name, value)))
        try:
            world = aloft(engine, other)
        except RefusedModelError:  # the engine does not take this value with the others
            continue
        energy = _beyond_damping(world, case)[:, 1]
        if not np.array_equal(energy, base[:, 1]):
            yield f"energy gained with {name}={value}", "1", float(energy[-1]), 0.0, how


def _beyond_damping(world: World, case: Case) -> Floats:
    """Return the flight of `SPIN`, its gains over those of a spin as fast about the axis alone."""
    T = natural_time(case.scene)
    spin = np.array(SPIN) / T
    free = flight(world, spin, DURATION * T)
    plain = flight(world, np.linalg.norm(spin) * UP, DURATION * T)
    free[:, 1:3] = (1.0 + free[:, 1:3]) / (1.0 + plain[:, 1:3]) - 1.0
    return free


def _angle(one: Floats, other: Floats) -> float:
    """Return the angle between two vectors, rad, exact for small ones."""
    return math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))


OVERLAPS = (1e-5, 1e-4, 1e-3)
"""Shares of the radius: from an engine's slop up to the margin that one ships with."""

IMPACT = 0.3
"""Speed of the impact, over sqrt(g R): that of a fall from a twentieth of the radius."""

_WAIT = 0.5
"""Natural times: ten time constants of a contact of 3 ms, one and a half of one of 20 ms."""


@probe("stabilisation", contact=True)
def stabilisation(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the speed and the energy that an overlap makes, and the rebound of an impact."""
    can, T = case.scene.can, natural_time(case.scene)
    scale = can.mass * case.scene.gravity * can.radius
    for share in OVERLAPS:
        speed = _fastest_rise(engine, case, share * can.radius, AT_REST)
        how = f"at rest without gravity, {share:g} R inside the plane"
        yield f"speed from an overlap of {share:g} R", "m/s", speed, 0.0, how
        energy = 0.5 * can.mass * speed**2 / scale
        yield f"energy from an overlap of {share:g} R, over m g R", "1", energy, 0.0, how
    given = IMPACT * can.radius / T
    rebound = _fastest_rise(engine, case, 0.0, moving(-given * UP)) / given
    how = "balanced on its rim without gravity, falling at 0.3 sqrt(g R)"
    yield "rebound over impact", "1", rebound, 0.0, how


def _fastest_rise(engine: Opener, case: Case, overlap: float, twist: Twist) -> float:
    """Return the greatest upward speed of a can released so deep inside the plane, m/s."""
    can, T = case.scene.can, natural_time(case.scene)
    world = aloft(engine, case)
    # from where this collider touches
    world.place(lowered(touching_pose(world, can, can.balancing_angle), overlap), twist)
    steps = max(4, round(_WAIT * T / world.timestep))
    return max(0.0, *(float(motion.velocity[2]) for _, motion, _ in follow(world, steps)))
