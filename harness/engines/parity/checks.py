"""Model parity: is the can in the engine the can of the scene? Asked before any trajectory.

Every property is read back from the compiled engine or probed in it: mass and moments are read;
gravity, timestep, damping and velocity clamps are probed in free flight; radius, height and the
roundness of the rim by distance queries at several tilts, as the collider sees them; the friction
of the pair by a can that slides, and every other law of the contact that is declared likewise. The
probes know a `World` and no engine.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Protocol

import numpy as np

from harness.core.simulation import ParityRow
from harness.engines.base import Floats, World, signed_distance
from harness.engines.parity.contact import contact_laws
from harness.engines.parity.free_flight import compare, free_flight, shaken_flight
from models.effects import NO_SLIP_FRICTION
from models.kinematics import quaternion
from models.mass import body
from models.rim import contact_offset
from models.scene import Scene
from models.state import Pose, Twist

_FASTER = 2
"""Times that a can which slides is made to slide ten times as fast."""

_SLIDING = 10.0  # m/s, at least
_TILTS = (0.02, 0.1, 0.3, 0.6, 0.9, 1.2, 1.5)  # rad
_SHALLOW, _DEEPER = 1e-6, 1.2  # of the radius, and from one depth to the next
_DEEP = 1e-3  # of the radius, and at least _SLOP
_SLOP = 5e-5  # m: engines leave less than this alone, however small the can
_SPINS = (0.0, 0.05, 0.1, 1.0)  # rad: corners of a polygon with 32 sides lie 0.2 rad apart


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
    rows = [
        *_mass_properties(world, scene),
        *free_flight(world, scene, timestep),
        *(() if scene.effects.shake is None else shaken_flight(world, scene)),  # type: ignore[arg-type]
        *_collider(world, scene),
        _friction(world, scene, timestep),
        *contact_laws(world, scene, timestep),
    ]
    return tuple(
        replace(row, verdict="imposed")
        if row.verdict == "mismatch" and row.quantity in imposed
        else row
        for row in rows
    )


class WeighedWorld(World, Protocol):
    """A world whose engine honours a point mass: it tells the whole tensor, and where it lies."""

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        ...

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        ...


def _mass_properties(world: World, scene: Scene) -> Iterator[ParityRow]:
    """Read mass and moments back."""
    can, found_mass = scene.can, ("mass", "kg", body(scene).mass, world.mass)
    if scene.effects.point_mass is not None:
        rows = [found_mass, *_off_centre(world, scene)]  # type: ignore[arg-type]
    else:
        A1, A2, C = world.inertia
        rows = [
            found_mass,
            ("transverse inertia A", "kg m^2", can.transverse_inertia, (A1 + A2) / 2.0),
            ("inertia asymmetry", "kg m^2", 0.0, A1 - A2),
            ("axial inertia C", "kg m^2", can.axial_inertia, C),
        ]
    # decimal text and a change of frame cost a few roundings
    scales = {"kg": can.mass, "m": can.bounding_radius, "kg m^2": can.transverse_inertia}
    for quantity, unit, declared, found in rows:
        yield compare(quantity, unit, declared, float(found), 1e-12 * scales[unit], "read back")


def _off_centre(world: WeighedWorld, scene: Scene) -> Iterator[tuple[str, str, float, float]]:
    """Yield where the centre of mass lies, and the six moments about it."""
    whole, centre, tensor = body(scene), world.centre_of_mass, world.inertia_tensor
    for place, axis in enumerate("xyz"):
        yield (f"centre of mass {axis}", "m", float(whole.centre[place]), float(centre[place]))
    for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        name = f"inertia {'xyz'[row]}{'xyz'[column]}"
        declared = float(whole.inertia[row, column])
        yield name, "kg m^2", declared, float(tensor[row, column])


def _collider(world: World, scene: Scene) -> Iterator[ParityRow]:
    """Probe the rim: how low the collider reaches below the centre at each tilt."""
    can = scene.can
    still = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))
    lift = 1e-3 * can.radius  # within every engine's reach and out of contact
    rim = scene.effects.rim
    arc = 0.0 if rim is None else rim.radius
    sines, reach, ideal = [], [], []
    for phi in _TILTS:
        for theta in _SPINS:
            low = -float(contact_offset(can, phi, 0.0)[2])
            position = np.array((0.0, 0.0, low + lift))
            world.place(Pose(position=position, quaternion=quaternion(phi, 0.0, theta)), still)
            # an arc takes r (sin + cos - 1) off the reach of a sharp rim
            blunt = 1.0 - math.sin(phi) - math.cos(phi)
            sines.append((math.sin(phi), math.cos(phi), blunt)[: 2 if rim is None else 3])
            reach.append(low + lift - signed_distance(world))
            ideal.append(low + arc * blunt)
    (radius, half_height, *found_arc), *_ = np.linalg.lstsq(
        np.array(sines), np.array(reach), rcond=None
    )
    worst = float(np.max(np.abs(np.array(reach) - np.array(ideal))))
    for quantity, declared, found, how in (
        ("radius R", can.radius, float(radius), "fit to distances at tilts of 0.02 to 1.5 rad"),
        ("half height H", can.half_height, float(half_height), "the same fit"),
        ("rim deviation", 0.0, worst, "largest distance from the ideal rim over all tilts"),
        *(("radius of the rim's arc", arc, float(each), "the same fit") for each in found_arc),
    ):
        yield compare(
            quantity,
            "m",
            declared,
            found,
            # the distances are differences of lengths of the can's size
            1e-12 * can.bounding_radius + 1e-15,
            how,
        )


def contact_turns_freely(scene: Scene) -> bool:
    """Whether the plane resists neither drilling nor rolling."""
    return scene.effects.drilling is None and scene.effects.rolling_resistance is None


def _friction(world: World, scene: Scene, timestep: float) -> ParityRow:
    """Probe the friction of the pair: a can that slides fast takes all of it."""
    slip = scene.effects.slip
    declared = NO_SLIP_FRICTION if slip is None else slip.mu
    can, phi = scene.can, scene.can.balancing_angle
    low = -float(contact_offset(can, phi, 0.0)[2])
    tilted = quaternion(phi, 0.0, 0.0)
    # along the lean friction turns the can about a transverse axis only, whose moment is never
    # small; and twice as fast as the friction of one step under gravity can stop
    mobility = 1.0 + can.mass * low**2 / can.transverse_inertia
    speed = max(_SLIDING, 2.0 * declared * mobility * scene.gravity * timestep)
    still = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))
    world.place(Pose(position=np.array((0.0, 0.0, low)), quaternion=tilted), still)
    touching = low - signed_distance(world)  # where this collider touches
    tolerance = max(declared, 1e-3) * (1e-6 if contact_turns_freely(scene) else 1e-2)

    # in small steps: just past an engine's slop, since a force that stops the can within the step
    # needs less friction than there is
    deepest = max(_DEEP * can.radius, _SLOP)
    count = math.ceil(math.log(deepest / (_SHALLOW * can.radius), _DEEPER)) + 1
    depths = _SHALLOW * can.radius * _DEEPER ** np.arange(count)

    def slid(speed: float) -> float:
        # beside a heavy point mass friction along the lean may lift the rim, or jam it (Painleve):
        # then friction across tells
        for way, depth in product(np.eye(3)[:2], depths):
            position = np.array((0.0, 0.0, touching - depth))
            sliding = Twist(velocity=speed * way, angular_velocity=np.zeros(3))
            world.place(Pose(position=position, quaternion=tilted), sliding)
            world.step()
            force = world.contact().force
            if force[2] > 0.0:
                return math.hypot(force[0], force[1]) / float(force[2])
        return math.nan

    found = slid(speed)
    # friction that is soft takes all of its cone from a speed on that grows with the load
    for _ in range(_FASTER):
        if found >= declared - tolerance or math.isnan(found):
            break
        speed *= 10.0
        found = slid(speed)
    return compare(
        "friction of the pair",
        "1",
        declared,
        found,
        # solvers stop at a tolerance of this size or less; where the contact resists turning too,
        # the moment may share the cone with the force: the force is short by half its share squared
        tolerance,
        f"force ratio of a can that slides at {speed:g} m/s, balanced on its rim",
    )
