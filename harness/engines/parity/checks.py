"""Model parity: is the can in the engine the can of the scene? Asked before any trajectory.

Every property is read back from the compiled engine or probed in it: mass and moments are read;
gravity, timestep, damping, velocity clamps and the shaking of the plane are probed in free flight;
radius, height and the roundness of the rim by distance queries at several tilts, as the collider
sees them; friction and every other law of the contact as `harness.engines.parity.contact` says. The
probes know a `World` and no engine.

Free flight. A can aloft at rest gains gravity in one step; thrown, it keeps its velocity; spun
about a principal axis with its centre of mass at rest, it keeps its spin. What damping takes away
in one step of dt is the declared rate to the first order in dt.
"""

import math
from collections.abc import Iterator
from typing import Protocol

import numpy as np

from harness.core.simulation import ParityRow
from harness.engines.base import Floats, World
from harness.engines.parity.contact import Compared, Stand, contact_laws, friction
from harness.engines.stepping.settling import (
    AT_REST,
    LIFT,
    UP,
    ZERO,
    X,
    Y,
    above_origin,
    hovering_distance,
    low_point,
    moving,
    stepped,
)
from models import Pose, Scene, Twist
from models.gravity import gravity_vector, plane_velocity, shaking
from models.mass import body

_TILTS = (0.02, 0.1, 0.3, 0.6, 0.9, 1.2, 1.5)  # rad
_SPINS = (0.0, 0.05, 0.1, 1.0)  # rad: corners of a polygon with 32 sides lie 0.2 rad apart
_ALOFT = 10.0  # m, and as many reaches of the can: no contact within any engine's reach
_FAST = 1e4  # rad/s and m/s: beyond what a scene of a metre reaches short of 1 mm cans
_HOW = "one step of free flight"

_IN_A_PERIOD = 16
"""Steps in a period of the shaking: enough to distinguish it from another frequency or phase."""


def parity(
    world: World, scene: Scene, timestep: float, imposed: frozenset[str]
) -> tuple[ParityRow, ...]:
    """Return the table of what the scene declares against what the engine has compiled.

    Parameters
    ----------
    world : World
        Is placed and stepped; not to be used for the run itself.
    scene : Scene
    timestep : float
        The timestep that the case asks for, s.
    imposed : frozenset of str
        Quantities in which this engine in this profile is known to go its own way: a difference
        there is "imposed" and reported; any other is a "mismatch", and the run does not start.
    """
    rows = []
    for quantity, unit, declared, value, tolerance, how in _probed(world, scene, timestep):
        verdict = "imposed" if quantity in imposed else "mismatch"
        if abs(value - declared) <= tolerance:
            verdict = "equal"
        rows.append(ParityRow(quantity, unit, declared, value, how, verdict))
    return tuple(rows)


def _probed(world: World, scene: Scene, timestep: float) -> Iterator[Compared]:
    """Yield every quantity as the scene declares it and as the engine has it."""
    yield from _mass_properties(world, scene)
    yield from _free_flight(world, scene, timestep)
    yield from _shaken_flight(world, scene)
    yield from _collider(world, scene)
    stand = Stand(world, scene, timestep)
    yield friction(stand)
    yield from contact_laws(stand)


class WeighedWorld(World, Protocol):
    """A world whose engine honours a point mass: it has the whole tensor and the centre of mass."""

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""


def _mass_properties(world: World, scene: Scene) -> Iterator[Compared]:
    """Read mass and moments back."""
    can = scene.can
    rows = [("mass", "kg", body(scene).mass, world.mass)]
    if scene.effects.point_mass is not None:
        rows += _off_centre(world, scene)  # type: ignore[arg-type] # of engines that honour it
    else:
        A1, A2, C = world.inertia
        rows += [
            ("transverse inertia A", "kg m^2", can.transverse_inertia, (A1 + A2) / 2.0),
            ("inertia asymmetry", "kg m^2", 0.0, A1 - A2),
            ("axial inertia C", "kg m^2", can.axial_inertia, C),
        ]
    # decimal text and a change of frame cost a few roundings
    scales = {"kg": can.mass, "m": can.bounding_radius, "kg m^2": can.transverse_inertia}
    for quantity, unit, declared, value in rows:
        yield quantity, unit, declared, float(value), 1e-12 * scales[unit], "read back"


def _off_centre(world: WeighedWorld, scene: Scene) -> Iterator[tuple[str, str, float, float]]:
    """Yield where the centre of mass lies, and the six moments about it."""
    solid, centre, tensor = body(scene), world.centre_of_mass, world.inertia_tensor
    for place, axis in enumerate("xyz"):
        yield f"centre of mass {axis}", "m", float(solid.centre[place]), float(centre[place])
    for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        name, declared = f"inertia {'xyz'[row]}{'xyz'[column]}", float(solid.inertia[row, column])
        yield name, "kg m^2", declared, float(tensor[row, column])


def _free_flight(world: World, scene: Scene, timestep: float) -> Iterator[Compared]:
    """Probe gravity, time, damping and clamps in single steps of flight without contact."""
    damping, solid = scene.effects.damping, body(scene)
    axis = solid.principal()[1][:, 2]

    def flown(velocity: Floats = ZERO, spin: Floats = ZERO) -> tuple[Twist, Pose]:
        thrown = velocity - np.cross(spin, solid.centre)  # so that the centre of mass has it
        after = stepped(world, _aloft(scene), moving(thrown, spin))
        return after.twist(), after.pose()

    rest, fallen = flown()

    def speed_left(speed: float) -> float:
        return float(flown(velocity=speed * X)[0].velocity[0] - rest.velocity[0])

    def spin_left(spin: float) -> float:
        return float(flown(spin=spin * axis)[0].angular_velocity @ axis)

    left, (_, after) = speed_left(1.0), flown(velocity=X)
    # a velocity of 1 is known to an ulp, 2e-16, and a position of 0 likewise once it has moved
    ulp = 4.0 * 2.0**-52 / timestep
    # engines advance with the new velocity
    advance = float(after.position[0] - fallen.position[0]) / left if left else math.nan
    yield "timestep", "s", timestep, advance, 1e-9 * timestep + 1e-15, _HOW
    gravity = gravity_vector(scene) + shaking(scene, 0.0, timestep)
    directions = [("gravity", -UP)]
    if scene.effects.tilt is not None or scene.effects.shake is not None:
        directions += [("gravity along x", X), ("gravity along y", Y)]
    linear, angular = (0.0, 0.0) if damping is None else (damping.linear, damping.angular)
    tolerance = 1e-9 * scene.gravity + (ulp + linear * scene.gravity)
    for quantity, direction in directions:
        value = float(rest.velocity / timestep @ direction)
        yield quantity, "m/s^2", float(gravity @ direction), value, tolerance, _HOW
    kinds = (
        ("linear damping", "speed kept", "m/s", linear, speed_left),
        ("angular damping", "spin kept", "rad/s", angular, spin_left),
    )
    for quantity, _, _, rate, left_of in kinds:
        share = left_of(1.0)
        value = -math.log(share) / timestep if share > 0.0 else math.inf
        yield quantity, "1/s", rate, value, ulp + rate**2 * timestep, _HOW
    for _, quantity, unit, rate, left_of in kinds:
        declared, tolerance = math.exp(-rate * timestep), 1e-9 + (rate * timestep) ** 2
        how = f"{_HOW} at this rate"
        yield quantity, unit, _FAST * declared, left_of(_FAST), _FAST * tolerance, how


def _shaken_flight(world: World, scene: Scene) -> Iterator[Compared]:
    """Probe the shaking over a period: what the plane's velocity loses a can aloft gains."""
    shake = scene.effects.shake
    if shake is None:
        return
    usual, period, gained = world.timestep, 1.0 / shake.frequency, []
    world.place(_aloft(scene), AT_REST)
    world.set_timestep(period / _IN_A_PERIOD)
    for _ in range(_IN_A_PERIOD):
        world.step()
        gained.append(world.twist().velocity)
    world.set_timestep(usual)
    times = period / _IN_A_PERIOD * np.arange(1, _IN_A_PERIOD + 1)
    swayed = np.array(gained) - np.outer(times, gravity_vector(scene))
    expected = plane_velocity(scene, 0.0) - plane_velocity(scene, times)
    damping = scene.effects.damping
    size = float(np.abs(expected).max()) + scene.gravity * period
    # decimal text, and drag over the period where there is any
    tolerance = size * (1e-9 + period * (0.0 if damping is None else damping.linear))
    across = np.array((math.cos(shake.direction), math.sin(shake.direction), 0.0))
    rate = 2.0 * math.pi * shake.frequency
    shape = math.cos(shake.phase) - np.cos(rate * times + shake.phase)
    how = "fit to the velocity gained in a period of free flight"
    for quantity, direction, amplitude in (
        ("horizontal shaking", across, shake.horizontal),
        ("vertical shaking", UP, shake.vertical),
    ):
        fitted = float(shape @ (swayed @ direction)) / float(shape @ shape) / rate
        yield quantity, "m", amplitude, fitted, tolerance / rate, how
    misfit = float(np.abs(swayed - expected).max())
    yield "misfit of the shaking", "m/s", 0.0, misfit, tolerance, "largest over the same period"


def _aloft(scene: Scene) -> Pose:
    return above_origin(_ALOFT * (1.0 + scene.can.bounding_radius))


def _collider(world: World, scene: Scene) -> Iterator[Compared]:
    """Probe the rim: how low the collider reaches below the centre at each tilt."""
    can, rim = scene.can, scene.effects.rim
    arc = 0.0 if rim is None else rim.radius
    sines, lowest, ideal = [], [], []
    for phi in _TILTS:
        # an arc takes r (sin + cos - 1) off the reach of a sharp rim
        low, blunt = low_point(can, phi), 1.0 - math.sin(phi) - math.cos(phi)
        for theta in _SPINS:
            sines.append((math.sin(phi), math.cos(phi), blunt)[: 2 if rim is None else 3])
            lowest.append(low + LIFT * can.radius - hovering_distance(world, can, phi, theta))
            ideal.append(low + arc * blunt)
    (radius, half_height, *fitted_arc), *_ = np.linalg.lstsq(
        np.array(sines), np.array(lowest), rcond=None
    )
    worst = float(np.max(np.abs(np.array(lowest) - np.array(ideal))))
    # the distances are differences of lengths of the can's size
    tolerance = 1e-12 * can.bounding_radius + 1e-15
    for quantity, declared, value, how in (
        ("radius R", can.radius, radius, "fit to distances at tilts of 0.02 to 1.5 rad"),
        ("half height H", can.half_height, half_height, "the same fit"),
        ("rim deviation", 0.0, worst, "largest distance from the ideal rim over all tilts"),
        *(("radius of the rim's arc", arc, each, "the same fit") for each in fitted_arc),
    ):
        yield quantity, "m", declared, float(value), tolerance, how
