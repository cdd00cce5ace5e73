"""Parity in free flight: gravity, time, damping, velocity clamps, and the shaking of the plane.

A can aloft at rest gains gravity in one step; thrown, it keeps its velocity; spun about a
principal axis with its centre of mass at rest, it keeps its spin. What damping takes away in one
step of dt is the declared rate to the first order in dt.
"""

import math
from collections.abc import Iterator

import numpy as np

from harness.core.simulation import ParityRow
from harness.engines.base import Floats, World
from harness.engines.stepping.generic_stepping import SteeredWorld
from models.gravity import gravity_vector, plane_velocity, shaking
from models.mass import body
from models.scene import Scene
from models.state import Pose, Twist

_UPRIGHT = np.array((1.0, 0.0, 0.0, 0.0))
_ALOFT = 10.0  # m, and as many reaches of the can: no contact within any engine's reach
_FAST = 1e4  # rad/s and m/s: beyond what a scene of a metre reaches short of 1 mm cans
_HOW = "one step of free flight"
_X, _Y, _Z = np.eye(3)
_NOTHING = np.zeros(3)

_IN_A_PERIOD = 16
"""Steps in a period of the shaking: enough to tell it from another frequency or phase."""


def compare(  # noqa: PLR0917 - the columns of a table, in their order
    quantity: str, unit: str, declared: float, found: float, tolerance: float, how: str
) -> ParityRow:
    """Return a row of the parity table, "equal" where both values are within the tolerance.

    Parameters
    ----------
    quantity, unit : str
    declared, found : float
        The value of the scene, and the value of the compiled engine.
    tolerance : float
        In the unit: what reading the value back, or probing it, may cost.
    how : str
        Where the value was found.
    """
    equal = abs(found - declared) <= tolerance
    return ParityRow(
        quantity=quantity,
        unit=unit,
        declared=declared,
        found=found,
        how=how,
        verdict="equal" if equal else "mismatch",
    )


def free_flight(world: World, scene: Scene, timestep: float) -> Iterator[ParityRow]:
    """Probe gravity, time, damping and clamps in single steps of flight without contact."""
    damping = scene.effects.damping
    linear, angular = (0.0, 0.0) if damping is None else (damping.linear, damping.angular)
    rest, fallen = _flown(world, scene, velocity=_NOTHING)
    thrown, after = _flown(world, scene, velocity=_X)
    axis = body(scene).principal()[1][:, 2]
    spun, _ = _flown(world, scene, spin=axis)
    # a velocity of 1 is known to an ulp, 2e-16, and a position of 0 likewise once it has moved
    ulp = 4.0 * 2.0**-52 / timestep
    left = float(thrown.velocity[0] - rest.velocity[0])
    # engines advance with the new velocity
    advance = float(after.position[0] - fallen.position[0]) / left if left else math.nan
    yield compare("timestep", "s", timestep, advance, 1e-9 * timestep + 1e-15, _HOW)
    yield from _gravity(scene, rest.velocity / timestep, timestep, ulp + linear * scene.gravity)
    spin = float(spun.angular_velocity @ axis)
    for quantity, rate, kept in (
        ("linear damping", linear, left),
        ("angular damping", angular, spin),
    ):
        yield compare(
            quantity,
            "1/s",
            rate,
            -math.log(kept) / timestep if kept > 0.0 else math.inf,
            ulp + rate**2 * timestep,
            _HOW,
        )
    fast, _ = _flown(world, scene, velocity=_FAST * _X)
    racing, _ = _flown(world, scene, spin=_FAST * axis)
    for quantity, unit, rate, found in (
        ("speed kept", "m/s", linear, float(fast.velocity[0] - rest.velocity[0])),
        ("spin kept", "rad/s", angular, float(racing.angular_velocity @ axis)),
    ):
        yield compare(
            quantity,
            unit,
            _FAST * math.exp(-rate * timestep),
            found,
            _FAST * (1e-9 + (rate * timestep) ** 2),
            "one step of free flight at this rate",
        )


def _gravity(scene: Scene, found: Floats, timestep: float, ulp: float) -> Iterator[ParityRow]:
    """Compare what a step of fall gains, shape (3,), m/s^2, with the scene's gravity."""
    declared = gravity_vector(scene) + shaking(scene, 0.0, timestep)
    directions = [("gravity", -_Z)]
    if scene.effects.tilt is not None or scene.effects.shake is not None:
        directions += [("gravity along x", _X), ("gravity along y", _Y)]
    for quantity, direction in directions:
        yield compare(
            quantity,
            "m/s^2",
            float(declared @ direction),
            float(found @ direction),
            1e-9 * scene.gravity + ulp,
            _HOW,
        )


def shaken_flight(world: SteeredWorld, scene: Scene) -> Iterator[ParityRow]:
    """Probe the shaking over a period: what the plane's velocity loses a can aloft gains."""
    shake, own = scene.effects.shake, world.timestep
    if shake is None:
        return
    period = 1.0 / shake.frequency
    world.place(_aloft(scene), Twist(velocity=_NOTHING, angular_velocity=_NOTHING))
    world.set_timestep(period / _IN_A_PERIOD)
    gained = []
    for _ in range(_IN_A_PERIOD):
        world.step()
        gained.append(world.twist().velocity)
    world.set_timestep(own)
    times = period / _IN_A_PERIOD * np.arange(1, _IN_A_PERIOD + 1)
    found = np.array(gained) - np.outer(times, gravity_vector(scene))
    expected = plane_velocity(scene, 0.0) - plane_velocity(scene, times)
    damping = scene.effects.damping
    size = float(np.abs(expected).max()) + scene.gravity * period
    # decimal text, and drag over the period where there is any
    tolerance = size * (1e-9 + period * (0.0 if damping is None else damping.linear))
    across = np.array((math.cos(shake.direction), math.sin(shake.direction), 0.0))
    rate = 2.0 * math.pi * shake.frequency
    shape = math.cos(shake.phase) - np.cos(rate * times + shake.phase)
    for quantity, direction, amplitude in (
        ("horizontal shaking", across, shake.horizontal),
        ("vertical shaking", _Z, shake.vertical),
    ):
        yield compare(
            quantity,
            "m",
            amplitude,
            float(shape @ (found @ direction)) / float(shape @ shape) / rate,
            tolerance / rate,
            "fit to the velocity gained in a period of free flight",
        )
    yield compare(
        "misfit of the shaking",
        "m/s",
        0.0,
        float(np.abs(found - expected).max()),
        tolerance,
        "largest over the same period",
    )


def _aloft(scene: Scene) -> Pose:
    height = _ALOFT * (1.0 + scene.can.bounding_radius)
    return Pose(position=np.array((0.0, 0.0, height)), quaternion=_UPRIGHT)


def _flown(
    world: World, scene: Scene, *, velocity: Floats = _NOTHING, spin: Floats = _NOTHING
) -> tuple[Twist, Pose]:
    """Return how and where the can is after a step, its centre of mass thrown at a velocity."""
    thrown = velocity - np.cross(spin, body(scene).centre)
    world.place(_aloft(scene), Twist(velocity=thrown, angular_velocity=spin))
    world.step()
    return world.twist(), world.pose()
