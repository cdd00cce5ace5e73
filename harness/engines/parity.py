"""Model parity: is the can in the engine the can of the scene? Asked before any trajectory.

Every property is read back from the compiled engine or probed in it: mass and moments are read;
gravity, timestep, damping and velocity clamps are probed in free flight; radius, height and the
roundness of the rim by distance queries at several tilts, as the collider sees them; the friction
of the pair by a can that slides. The probes know a `World` and no engine.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.engines.base import World
from harness.simulation import ParityRow
from models.effects import NO_SLIP_FRICTION
from models.kinematics import quaternion
from models.rim import contact_offset
from models.scene import Scene
from models.state import Pose, Twist

_UPRIGHT = np.array((1.0, 0.0, 0.0, 0.0))
_ALOFT = 10.0  # m, and as many reaches of the can: no contact within any engine's reach
_FAST = 1e4  # rad/s and m/s: beyond what a scene of a metre reaches short of 1 mm cans
_SLIDING = 10.0  # m/s, at least
_TILTS = (0.02, 0.1, 0.3, 0.6, 0.9, 1.2, 1.5)  # rad
# of the radius, in small steps: just past an engine's slop, since a force that stops the can within
# the step needs less friction than there is
_DEPTHS = tuple(1e-6 * 1.2**step for step in range(39))
_SPINS = (0.0, 0.05, 0.1, 1.0)  # rad: corners of a polygon with 32 sides lie 0.2 rad apart


@dataclass(frozen=True, slots=True, kw_only=True)
class _Finding:
    quantity: str
    unit: str
    declared: float
    found: float
    tolerance: float  # in the unit
    how: str


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
    findings = [
        *_mass_properties(world, scene),
        *_free_flight(world, scene, timestep),
        *_collider(world, scene),
        _friction(world, scene, timestep),
    ]
    rows = []
    for finding in findings:
        equal = abs(finding.found - finding.declared) <= finding.tolerance
        other = "imposed" if finding.quantity in imposed else "mismatch"
        rows.append(
            ParityRow(
                quantity=finding.quantity,
                unit=finding.unit,
                declared=finding.declared,
                found=finding.found,
                how=finding.how,
                verdict="equal" if equal else other,
            )
        )
    return tuple(rows)


def _mass_properties(world: World, scene: Scene) -> Iterator[_Finding]:
    """Read mass and moments back."""
    can = scene.can
    A1, A2, C = world.inertia
    for quantity, unit, declared, found in (
        ("mass", "kg", can.mass, world.mass),
        ("transverse inertia A", "kg m^2", can.transverse_inertia, (A1 + A2) / 2.0),
        ("inertia asymmetry", "kg m^2", 0.0, A1 - A2),
        ("axial inertia C", "kg m^2", can.axial_inertia, C),
    ):
        # decimal text and a change of frame cost a few roundings
        scale = can.mass if unit == "kg" else can.transverse_inertia
        yield _Finding(
            quantity=quantity,
            unit=unit,
            declared=declared,
            found=float(found),
            tolerance=1e-12 * scale,
            how="read back",
        )


def _free_flight(world: World, scene: Scene, timestep: float) -> Iterator[_Finding]:
    """Probe gravity, time, damping and clamps in one step of flight without contact."""
    height = _ALOFT * (1.0 + scene.can.bounding_radius)
    pose = Pose(position=np.array((0.0, 0.0, height)), quaternion=_UPRIGHT)
    unit_x, unit_z = np.array((1.0, 0.0, 0.0)), np.array((0.0, 0.0, 1.0))
    world.place(pose, Twist(velocity=unit_x, angular_velocity=unit_z))
    world.step()
    after, twist = world.pose(), world.twist()
    speed, spin = float(twist.velocity[0]), float(twist.angular_velocity[2])
    # a velocity of 1 is known to an ulp, 2e-16, and a position of 0 likewise once it has moved
    ulp = 4.0 * 2.0**-52 / timestep
    # engines advance with the new velocity
    advance = float(after.position[0]) / speed if speed else math.nan
    how = "one step of free flight"
    yield _Finding(
        quantity="timestep",
        unit="s",
        declared=timestep,
        found=advance,
        tolerance=1e-9 * timestep + 1e-15,
        how=how,
    )
    yield _Finding(
        quantity="gravity",
        unit="m/s^2",
        declared=scene.gravity,
        found=-float(twist.velocity[2]) / timestep,
        tolerance=1e-9 * scene.gravity + ulp,
        how=how,
    )
    for quantity, left in (("linear damping", speed), ("angular damping", spin)):
        yield _Finding(
            quantity=quantity,
            unit="1/s",
            declared=0.0,
            found=-math.log(left) / timestep if left > 0.0 else math.inf,
            tolerance=ulp,
            how=how,
        )
    for quantity, unit, twist in (
        ("speed kept", "m/s", Twist(velocity=_FAST * unit_x, angular_velocity=0.0 * unit_z)),
        ("spin kept", "rad/s", Twist(velocity=0.0 * unit_x, angular_velocity=_FAST * unit_z)),
    ):
        world.place(pose, twist)
        world.step()
        kept = world.twist()
        found = kept.velocity[0] if unit == "m/s" else kept.angular_velocity[2]
        yield _Finding(
            quantity=quantity,
            unit=unit,
            declared=_FAST,
            found=float(found),
            tolerance=1e-9 * _FAST,
            how="one step of free flight at this rate",
        )


def _collider(world: World, scene: Scene) -> Iterator[_Finding]:
    """Probe the rim: how low the collider reaches below the centre at each tilt."""
    can = scene.can
    still = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))
    lift = 1e-3 * can.radius  # within every engine's reach and out of contact
    sines, reach, ideal = [], [], []
    for phi in _TILTS:
        for theta in _SPINS:
            low = -float(contact_offset(can, phi, 0.0)[2])
            position = np.array((0.0, 0.0, low + lift))
            world.place(Pose(position=position, quaternion=quaternion(phi, 0.0, theta)), still)
            sines.append((math.sin(phi), math.cos(phi)))
            reach.append(low + lift - world.gap())
            ideal.append(low)
    (radius, half_height), *_ = np.linalg.lstsq(np.array(sines), np.array(reach), rcond=None)
    worst = float(np.max(np.abs(np.array(reach) - np.array(ideal))))
    for quantity, declared, found, how in (
        ("radius R", can.radius, float(radius), "fit to distances at tilts of 0.02 to 1.5 rad"),
        ("half height H", can.half_height, float(half_height), "the same fit"),
        ("rim deviation", 0.0, worst, "largest distance from the ideal rim over all tilts"),
    ):
        yield _Finding(
            quantity=quantity,
            unit="m",
            declared=declared,
            found=found,
            # the distances are differences of lengths of the can's size
            tolerance=1e-12 * can.bounding_radius + 1e-15,
            how=how,
        )


def _friction(world: World, scene: Scene, timestep: float) -> _Finding:
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
    sliding = Twist(velocity=np.array((speed, 0.0, 0.0)), angular_velocity=np.zeros(3))
    world.place(Pose(position=np.array((0.0, 0.0, low)), quaternion=tilted), sliding)
    touching = low - world.gap()  # where this collider touches
    found = math.nan
    for share in _DEPTHS:
        position = np.array((0.0, 0.0, touching - share * can.radius))
        world.place(Pose(position=position, quaternion=tilted), sliding)
        world.step()
        force = world.contact().force
        if force[2] > 0.0:
            found = math.hypot(force[0], force[1]) / float(force[2])
            break
    return _Finding(
        quantity="friction of the pair",
        unit="1",
        declared=declared,
        found=found,
        tolerance=1e-6 * max(declared, 1e-3),  # solvers stop at a tolerance of this size or less
        how=f"force ratio of a can that slides at {speed:g} m/s, balanced on its rim",
    )
