"""Model parity: is the can in the engine the can of the scene? Asked before any trajectory.

Every property is read back from the compiled engine or probed in it: mass and moments are read;
gravity, timestep, damping, velocity clamps and the shaking of the plane are probed in free flight;
radius, height and the roundness of the rim by distance queries at several tilts, as the collider
sees them; friction and every other law of the contact as `harness.engines.parity.contact` says. The
probes know a `World` and no engine.

Free flight. A can aloft, tilted and turned, gains gravity in one step; thrown, it keeps its
velocity; spun about a principal axis with its centre of mass at rest, it keeps its spin. What
damping takes away in one step of dt is the declared rate to the first order in dt.

Spun about another axis it changes its spin by Euler's equation, I a = L x omega with L = I omega:
the acceleration of an engine whose spins are handed over in the right frame. It is quadratic in
omega, so that a spin that is set or read in the frame of the body gives another. An explicit step
of dt adds dt a to the spin, an implicit one takes omega or L or both at its end, and either may be
meant in the axes of the world or in those of the body, which turn by omega dt. So methods of the
first order and exact ones agree up to

    dt (|I^-1 (L x a)| + |I^-1 (omega x I a)| + |omega x a|)

in the acceleration, but for the square of omega dt. What damping takes from a spin as fast about a
principal axis is given back first. The moments are those of the engine, right or wrong.

Where an engine is known to go its own way it says how far: as a share of what is declared, and of
what is declared as zero as a share of the can's mass, size or moment, or of one unit. A difference
up to there is imposed; one that is larger is another can's.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Protocol

import numpy as np

from harness.core.simulation import ParityRow
from harness.engines.description import Method, Precision
from harness.engines.parity.contact import (
    FRICTIONS,
    ROUND_OFF,
    Compared,
    RoundOff,
    Stand,
    contact_laws,
    declared_friction,
    friction,
)
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import (
    AT_REST,
    LIFT,
    LYING,
    TURNED,
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
from harness.engines.world import Floats, World
from models import Can, InvalidValueError, Pose, Scene, Twist, to_body
from models.gravity import gravity_vector, plane_velocity, shaking
from models.kinematics import to_world
from models.mass import body

_TILTS = (0.02, 0.1, 0.3, 0.6, 0.9, 1.2, 1.5)  # rad
_SPINS = (0.0, 0.05, 0.1, 1.0)  # rad: corners of a polygon with 32 sides lie 0.2 rad apart
_ALOFT = 10.0  # m, and as many reaches of the can: no contact within any engine's reach
_FAST = 1e4  # rad/s and m/s: beyond what a scene of a metre reaches short of 1 mm cans
_HOW = "one step of free flight"

RIM = ("radius R", "half height H", "rim deviation")
"""Rows of the collider."""

SMALLEST_TILT = _TILTS[0]
"""rad: where the direction to the rim's lowest point is the hardest to tell."""


def rim_within(can: Can, length: float) -> dict[str, float]:
    """Return how far the rows of the collider go astray whose every point is within a length, m."""
    sizes = (can.radius, can.half_height, can.bounding_radius)
    return {row: length / size for row, size in zip(RIM, sizes, strict=True)}


_SKEW = np.array((1.2, 0.7, 1.5))
"""Spin of the gyroscopic probe in the axes of the body, over sqrt(g/R)."""

_STEP = 1e-3
"""Timestep of the gyroscopic probe in natural times: methods differ by some thousandths of the
acceleration, and a difference of spins keeps two digits in single precision."""

_IN_A_PERIOD = 16
"""Steps in a period of the shaking: enough to distinguish it from another frequency or phase."""


def parity(
    world: World,
    scene: Scene,
    timestep: float,
    imposed: Mapping[str, float],
    precision: Precision = Precision.DOUBLE,
    *,
    method: Method = Method.FIXED_TIMESTEP,
    tells_forces: bool = True,
) -> tuple[ParityRow, ...]:
    """Return the table of what the scene declares against what the engine has compiled.

    Parameters
    ----------
    world : World
        Is placed and stepped; not to be used for the run itself.
    scene : Scene
    timestep : float
        What a step of the world is to advance by, s.
    imposed : mapping of str to float
        Quantities in which this engine is known to go its own way, each with the largest share of
        the declared by which it does: a difference up to there is "imposed" and reported; any
        other is a "mismatch", and the run does not start. Infinity excuses no number at all, too.
    precision : Precision
        Of the engine's numbers: what is read back or probed is known no better.
    method : Method
        What cannot be asked of it has a row that says so, without a number.
    tells_forces : bool
        Whether the force of a contact is the one that moved the can; else it is taken from the
        change of the momentum.
    """
    rows, known, sizes = [], ROUND_OFF[precision], _sizes(scene)
    probed = _probed(world, scene, timestep, known)
    if not method.refusal:
        of_contact = _contact(world, scene, timestep, known, tells_forces=tells_forces)
        probed = chain(probed, of_contact)
    for quantity, unit, declared, value, tolerance, how in probed:
        deviation, size = abs(value - declared), abs(declared) or sizes.get(unit, 1.0)
        excused = imposed.get(quantity, 0.0)
        if deviation <= tolerance:
            verdict = "equal"
        else:
            own = deviation <= excused * size or excused == math.inf
            verdict = "imposed" if own else "mismatch"
        rows.append(ParityRow(quantity, unit, declared, value, how, verdict))
    if method.refusal:
        mu, no = declared_friction(scene), "does not apply"
        rows += [ParityRow(row, "1", mu, math.nan, method.refusal, no) for row in FRICTIONS]
    return tuple(rows)


def _probed(world: World, scene: Scene, timestep: float, known: RoundOff) -> Iterator[Compared]:
    """Yield every quantity but the laws of the contact, as declared and as the engine has it."""
    yield from _mass_properties(world, scene, known)
    yield from _free_flight(world, scene, timestep, known)
    yield from _gyroscopic(world, scene, known)
    yield from _shaken_flight(world, scene, known)
    yield from _collider(world, scene, known)


def _contact(
    world: World, scene: Scene, timestep: float, known: RoundOff, *, tells_forces: bool
) -> Iterator[Compared]:
    """Yield the laws of the contact, as declared and as the engine has them."""
    stand = Stand(world, scene, timestep, known, tells_forces=tells_forces)
    yield from friction(stand)
    yield from contact_laws(stand)


class WeighedWorld(World, Protocol):
    """A world whose engine honours a point mass: it has the whole tensor and the centre of mass."""

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""


def _mass_properties(world: World, scene: Scene, known: RoundOff) -> Iterator[Compared]:
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
    sizes = _sizes(scene)
    for quantity, unit, declared, value in rows:
        yield quantity, unit, declared, float(value), known.read * sizes[unit], "read back"


def _sizes(scene: Scene) -> dict[str, float]:
    """Return what a mass, a length and a moment of the can are measured against, by unit."""
    can = scene.can
    return {"kg": can.mass, "m": can.bounding_radius, "kg m^2": can.transverse_inertia}


def _off_centre(world: WeighedWorld, scene: Scene) -> Iterator[tuple[str, str, float, float]]:
    """Yield where the centre of mass lies, and the six moments about it."""
    solid, centre, tensor = body(scene), world.centre_of_mass, world.inertia_tensor
    for place, axis in enumerate("xyz"):
        yield f"centre of mass {axis}", "m", float(solid.centre[place]), float(centre[place])
    for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        name, declared = f"inertia {'xyz'[row]}{'xyz'[column]}", float(solid.inertia[row, column])
        yield name, "kg m^2", declared, float(tensor[row, column])


def _free_flight(
    world: World, scene: Scene, timestep: float, known: RoundOff
) -> Iterator[Compared]:
    """Probe gravity, time, damping and clamps in single steps of flight without contact."""
    damping, solid = scene.effects.damping, body(scene)
    axis = to_world(LYING, solid.principal()[1][:, 2])

    def flown(velocity: Floats = ZERO, spin: Floats = ZERO) -> tuple[Twist, Pose]:
        after = _flown(world, scene, LYING, velocity, spin)
        return after.twist(), after.pose()

    rest, fallen = flown()

    def speed_left(speed: float) -> float:
        return float(flown(velocity=speed * X)[0].velocity[0] - rest.velocity[0])

    def spin_left(spin: float) -> float:
        return float(flown(spin=spin * axis)[0].angular_velocity @ axis)

    left, (_, after) = speed_left(1.0), flown(velocity=X)
    # a velocity of 1 is known to an ulp, and a position of 0 likewise once it has moved
    ulp = 4.0 * known.epsilon / timestep
    # engines advance with the new velocity
    advance = float(after.position[0] - fallen.position[0]) / left if left else math.nan
    yield "timestep", "s", timestep, advance, known.probed * timestep + 1e-15, _HOW
    gravity = gravity_vector(scene) + shaking(scene, 0.0, timestep)
    directions = [("gravity", -UP)]
    if scene.effects.tilt is not None or scene.effects.shake is not None:
        directions += [("gravity along x", X), ("gravity along y", Y)]
    linear, angular = (0.0, 0.0) if damping is None else (damping.linear, damping.angular)
    # damping may take its share of what gravity adds in the step
    share = known.probed + linear * timestep
    tolerance = share * float(np.linalg.norm(gravity)) + ulp
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
        # of a spin there are the roundings of the frames of a can that lies, too
        known_to = 4.0 * ulp if left_of is spin_left else ulp
        yield quantity, "1/s", rate, value, known_to + rate**2 * timestep, _HOW
    for _, quantity, unit, rate, left_of in kinds:
        declared, tolerance = math.exp(-rate * timestep), known.probed + (rate * timestep) ** 2
        how = f"{_HOW} at this rate"
        try:
            left = left_of(_FAST)
        except InvalidValueError:  # the step fails, and leaves no numbers
            left = math.nan
        yield quantity, unit, _FAST * declared, left, _FAST * tolerance, how


def _flown(
    world: World, scene: Scene, orientation: Floats, velocity: Floats, spin: Floats
) -> World:
    """Return the world after a step of a can aloft whose centre of mass has a velocity."""
    centre = to_world(orientation, body(scene).centre)
    thrown = moving(velocity - np.cross(spin, centre), spin)
    return stepped(world, _aloft(scene, orientation), thrown)


def _gyroscopic(world: World, scene: Scene, known: RoundOff) -> Iterator[Compared]:
    """Probe the acceleration of a spin about no principal axis, and with it the frame of spins."""
    usual, rate = world.timestep, 1.0 / natural_time(scene)
    timestep, omega = _STEP / rate, rate * _SKEW
    tensor = np.diag(np.asarray(world.inertia, dtype=np.float64))
    if scene.effects.point_mass is not None:
        tensor = np.asarray(world.inertia_tensor)  # type: ignore[attr-defined] # it is a WeighedWorld

    def flown(spin: Floats) -> Floats:
        """Return what a step makes of a spin, both in the axes of the body at first, rad/s."""
        after = _flown(world, scene, TURNED, ZERO, to_world(TURNED, spin)).twist()
        return to_body(TURNED, after.angular_velocity)

    def over(torque: Floats) -> Floats:
        """Return the acceleration of a torque in the axes of the body, rad/s^2."""
        return np.asarray(np.linalg.solve(tensor, torque), dtype=np.float64)

    world.set_timestep(timestep)
    size = float(np.linalg.norm(omega))
    axis = np.linalg.eigh(tensor)[1][:, 0]
    kept = float(flown(size * axis) @ axis) / size
    found = (flown(omega) / kept - omega) / timestep if kept else np.full(3, np.nan)
    world.set_timestep(usual)
    momentum = tensor @ omega
    ideal = over(np.cross(momentum, omega))
    differences = (
        over(np.cross(momentum, ideal)),
        over(np.cross(omega, tensor @ ideal)),
        np.cross(omega, ideal),
    )
    first = timestep * sum(float(np.linalg.norm(each)) for each in differences)
    # damping acts on what the acceleration has added, too
    lost = abs(1.0 - kept) * float(np.linalg.norm(ideal))
    tolerance = (first + lost) * (1.0 + size * timestep) + known.probed * size / timestep
    misfit = float(np.linalg.norm(found - ideal))
    how = f"one step of free flight, beside {np.linalg.norm(ideal):.3g} rad/s^2 by Euler's equation"
    yield "misfit of the gyroscopic acceleration", "rad/s^2", 0.0, misfit, tolerance, how


def _shaken_flight(world: World, scene: Scene, known: RoundOff) -> Iterator[Compared]:
    """Probe the shaking over a period: what the plane's velocity loses a can aloft gains."""
    shake = scene.effects.shake
    if shake is None:
        return
    usual, period, gained = world.timestep, 1.0 / shake.frequency, []
    world.place(_aloft(scene, TURNED), AT_REST)
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
    tolerance = size * (known.probed + period * (0.0 if damping is None else damping.linear))
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


def _aloft(scene: Scene, orientation: Floats) -> Pose:
    return above_origin(_ALOFT * (1.0 + scene.can.bounding_radius), orientation)


def _collider(world: World, scene: Scene, known: RoundOff) -> Iterator[Compared]:
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
    tolerance = known.read * can.bounding_radius + 1e-15
    for quantity, declared, value, how in (
        ("radius R", can.radius, radius, "fit to distances at tilts of 0.02 to 1.5 rad"),
        ("half height H", can.half_height, half_height, "the same fit"),
        ("rim deviation", 0.0, worst, "largest distance from the ideal rim over all tilts"),
        *(("radius of the rim's arc", arc, each, "the same fit") for each in fitted_arc),
    ):
        yield quantity, "m", declared, float(value), tolerance, how
