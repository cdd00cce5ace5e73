"""Probes of the contact: rim, contact points, friction compliance, stabilisation, compliance.

Rim. The lowest point of an ideal can is z(phi) = R sin phi + H cos phi below the centre, whatever
the azimuth. A prism with n sides reaches as far at its corners and less between them, by
R (1 - cos(pi/n)) sin phi at most. A cylinder shrunk by m and swollen by a ball of radius m, which
is how a collision margin rounds the rim, reaches (R - m) sin phi + (H - m) cos phi + m: less than
the ideal by m (sin phi + cos phi - 1). A margin outside adds itself at every tilt. So

    deviation at the corners = swell - fillet (sin phi + cos phi - 1)

and a fit over the tilts separates swell and fillet.

Contact points. A rigid can touches in one point at every tilt above zero. A soft or rounded can
that lies nearly flat touches along a piece of its rim, and an engine spreads the force over several
points: then the bounce of a rocking can is not that of the single point that the mathematics has.

Friction compliance. The can is let go at rest, tilted less than it balances. Without precession or
spin it stays in one plane and falls about the point of its rim that touches, which no-slip keeps
fixed: a pendulum with I = A + m (R^2 + H^2). With the centre at x = R cos phi - H sin phi beside
the contact point and z = R sin phi + H cos phi above it, energy and Newton's law give

    phi'^2 = 2 m g (z(phi_0) - z(phi)) / I         phi'' = -m g x / I
    F = -m (z phi'' + x phi'^2)                    N = m (g + x phi'' - z phi'^2)

so the friction that holds the rim is known from phi alone. Every speed that the solver leaves at
the point where it pushed is creep; mass and moment are the engine's own, so that a wrong moment
does not pass for creep.

Stabilisation. Without gravity a can at rest stays at rest. Placed a little inside the plane,
balanced so that the contact force goes through its centre, it is pushed out by a contact that
corrects positions by velocities: speed and energy out of nothing. A true plane that takes up an
impact without rebound leaves no speed at all.

Compliance. The can is balanced on its rim, at rest with its centre above the contact point
(eq:phistar), so that the load is its weight exactly; gravity is varied to vary the load. The depth
is the one at which one step leaves the contact at rest, and it is read again from the engine's
contact after a while.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Floats
from harness.engines.base import World, signed_distance
from harness.engines.probes.fixture import (
    STILL,
    Evidence,
    Opener,
    Trace,
    aloft,
    findings,
    follow,
    leaning,
    with_gravity,
)
from harness.engines.stepping.horizon import natural_time
from models.can import Can
from models.kinematics import angles, quaternion
from models.rim import contact_offset
from models.state import Pose, Twist

TILTS = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2)
"""rad."""

AZIMUTHS = 256
"""Positions round the rim: eight to a side of a prism with 32."""

_LIFT = 1e-3
"""Share of the radius at which the can hovers: within reach, out of contact."""


def deviations(world: World, can: Can, tilts: Floats, azimuths: Floats) -> Floats:
    """Return how much lower the collider reaches than an ideal can, shape (tilts, azimuths), m."""
    found = np.empty((len(tilts), len(azimuths)))
    for row, phi in enumerate(tilts):
        low = -float(contact_offset(can, phi, 0.0)[2])
        height = low + _LIFT * can.radius
        for column, theta in enumerate(azimuths):
            place = Pose(
                position=np.array((0.0, 0.0, height)), quaternion=quaternion(phi, 0.0, theta)
            )
            world.place(place, STILL)
            found[row, column] = _LIFT * can.radius - signed_distance(world)
    return found


def rim(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield sides of a polygon, its sagitta, the radius of a fillet, and a swelling."""
    can, tilts = case.scene.can, np.array(TILTS)
    azimuths: Floats = np.arange(AZIMUTHS) * np.float64(2.0 * math.pi / AZIMUTHS)
    found = deviations(engine.open(case), can, tilts, azimuths)
    spread = np.ptp(found, axis=1)
    corners = found.max(axis=1)
    basis = np.stack((np.ones_like(tilts), -(np.sin(tilts) + np.cos(tilts) - 1.0)), axis=1)
    (swell, fillet), *_ = np.linalg.lstsq(basis, corners, rcond=None)
    # distances are differences of lengths of the can's size, each known to some ulps
    noise = 1e-12 * can.bounding_radius
    middle = TILTS.index(0.6)
    spectrum = np.abs(np.fft.rfft(found[middle]))[1:]
    sides = 1 + int(np.argmax(spectrum)) if spread[middle] > noise else 0
    how = "distance to the plane at 7 tilts from 0.05 to 1.2 rad and 256 azimuths"
    lengths = (
        ("sagitta between the corners over sin phi", float(np.median(spread / np.sin(tilts)))),
        ("fillet radius", float(fillet)),
        ("swell beyond the declared size", float(swell)),
        ("largest deviation", float(np.abs(found).max())),
    )
    yield from findings("rim", how, ("sides of the rim; 0 is round", "1", float(sides), 0.0))
    for quantity, length in lengths:
        known = 0.0 if abs(length) <= noise else length
        yield from findings("rim", how, (quantity, "m", known, 0.0))
    yield Trace(
        effect="rim",
        x_label="azimuth [rad]",
        y_label="deviation at a tilt of 0.6 rad [m]",
        x=azimuths,
        y=found[middle],
    )


POINTS_TILTS = np.logspace(-9.0, -1.0, 65)
"""rad; eight to a decade."""


def points(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the largest tilt at which several points bear the load in the first step."""
    ideal = with_gravity(case, case.scene.gravity)
    counts = []
    for phi in POINTS_TILTS.tolist():
        world, _ = leaning(engine, ideal, phi)
        world.step()
        counts.append(float(world.contact().count))
    several = [phi for phi, count in zip(POINTS_TILTS.tolist(), counts, strict=True) if count > 1.0]
    how = "one step from rest at static penetration, at 65 tilts from 1e-9 to 0.1 rad"
    largest = max(several, default=0.0)
    row = ("tilt below which several points bear the load", "rad", largest, 0.0)
    yield from findings("contact points", how, row)
    yield Trace(
        effect="contact points",
        x_label="tilt [rad]",
        y_label="points that bear the load [1]",
        x=POINTS_TILTS,
        y=np.array(counts),
    )


_TILT = 0.7
"""Share of the balancing angle at which the can is let go: it falls at once, yet not far."""

_FROM, _TO = 0.3, 0.5
"""Natural times between which creep is measured: after the first slip has decayed in a contact as
slow as 20 ms, before the can has fallen flat, which takes about one."""


def planar_fall(can: Can, gravity: float, start: float, phi: Floats) -> tuple[Floats, Floats]:
    """Return friction and normal force of a can that falls about a fixed point of its rim.

    Parameters
    ----------
    can : Can
    gravity : float
        m/s^2.
    start : float
        Tilt at which it was at rest, rad.
    phi : ndarray, shape (n,)
        Tilts on the way, rad.

    Returns
    -------
    F, N : ndarray, shape (n,)
        N; F towards the side that the centre is on.
    """
    R, H, m = can.radius, can.half_height, can.mass
    x, z = R * np.cos(phi) - H * np.sin(phi), R * np.sin(phi) + H * np.cos(phi)
    z_0 = R * math.sin(start) + H * math.cos(start)
    inertia = can.transverse_inertia + m * (R**2 + H**2)
    rate_squared = 2.0 * m * gravity * (z_0 - z) / inertia
    acceleration = -m * gravity * x / inertia
    F = -m * (z * acceleration + x * rate_squared)
    N = m * (gravity + x * acceleration - z * rate_squared)
    return F, N


def creep(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the speed at which the rim creeps, over the force, and the error of the force."""
    case = with_gravity(case, case.scene.gravity)
    can, gravity, T = case.scene.can, case.scene.gravity, natural_time(case.scene)
    start, dt = _TILT * can.balancing_angle, engine.timestep(case)
    world, _ = leaning(engine, case, start)
    moments = world.inertia
    can = replace(
        can,
        mass=world.mass,
        transverse_inertia=float(moments[1]),
        axial_inertia=float(moments[2]),
    )
    slips, tilts, forces = [], [], []
    for instant in follow(world, max(8, round(_TO * T / dt))):
        phi, psi, _ = angles(instant.pose.quaternion)
        offset = instant.contact.point - instant.pose.position
        if not np.isfinite(offset).all():  # nothing touches
            offset = contact_offset(can, phi, psi)
        left = world.twist()  # after the step that solved this contact
        slips.append((left.velocity + np.cross(left.angular_velocity, offset))[0])
        tilts.append(float(phi))
        forces.append(instant.contact.force[0])
    late = slice(round(_FROM / _TO * len(slips)), None)
    F, N = planar_fall(can, gravity, start, np.array(tilts))
    slip, force = np.array(slips), np.array(forces)
    how = "let go at rest at 0.7 of the balancing angle; rim speed from 0.3 to 0.5 sqrt(R/g)"
    error = float((force / F - 1.0)[late].mean())
    yield from findings(
        "friction compliance",
        how,
        ("creep of the rim", "m/s", float(np.abs(slip[late]).mean()), 0.0),
        ("creep over the force", "m/s/N", float((np.abs(slip[late]) / F[late]).mean()), 0.0),
        ("friction ratio", "1", float(np.mean((force / N)[late])), float((F / N)[late].mean())),
        ("error of the friction over the closed form", "1", error, 0.0),
    )
    yield Trace(
        effect="friction compliance",
        x_label="time [s]",
        y_label="creep of the rim [m/s]",
        x=np.arange(len(slip)) * np.float64(dt),
        y=np.abs(slip),
    )


OVERLAPS = (1e-5, 1e-4, 1e-3)
"""Shares of the radius: from an engine's slop up to the margin that one ships with."""

IMPACT = 0.3
"""Speed of the impact, over sqrt(g R): that of a fall from a twentieth of the radius."""

_WAIT = 0.5
"""Natural times: ten time constants of a contact of 3 ms, one and a half of one of 20 ms."""


def stabilisation(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the speed and the energy that an overlap makes, and the rebound of an impact."""
    can, T = case.scene.can, natural_time(case.scene)
    scale = can.mass * case.scene.gravity * can.radius
    for share in OVERLAPS:
        speed = _fastest_rise(engine, case, share * can.radius, STILL)
        how = f"at rest without gravity, {share:g} R inside the plane"
        overlap, energy = f"an overlap of {share:g} R", 0.5 * can.mass * speed**2 / scale
        yield from findings(
            "stabilisation",
            how,
            (f"speed from {overlap}", "m/s", speed, 0.0),
            (f"energy from {overlap}, over m g R", "1", energy, 0.0),
        )
    given = IMPACT * can.radius / T
    down = Twist(velocity=np.array((0.0, 0.0, -given)), angular_velocity=np.zeros(3))
    rebound = _fastest_rise(engine, case, 0.0, down) / given
    how = "balanced on its rim without gravity, falling at 0.3 sqrt(g R)"
    yield from findings("stabilisation", how, ("rebound over impact", "1", rebound, 0.0))


def _fastest_rise(engine: Opener, case: Case, overlap: float, twist: Twist) -> float:
    """Return the greatest upward speed of a can released so deep inside the plane, m/s."""
    can, T = case.scene.can, natural_time(case.scene)
    world = aloft(engine, case)
    phi = can.balancing_angle
    tilted = quaternion(phi, 0.0, 0.0)
    low = -float(contact_offset(can, phi, 0.0)[2])
    world.place(Pose(position=np.array((0.0, 0.0, low)), quaternion=tilted), STILL)
    height = low - signed_distance(world) - overlap  # from where this collider touches
    world.place(Pose(position=np.array((0.0, 0.0, height)), quaternion=tilted), twist)
    steps = max(4, round(_WAIT * T / engine.timestep(case)))
    return max(0.0, *(float(i.twist.velocity[2]) for i in follow(world, steps)))


LOADS = (0.25, 0.5, 1.0, 1.5)
"""Weights of the can."""

_HELD = 0.1
"""Natural times for which the load is held: a balanced can has tipped by a thousandth of its
deviation's growth, exp(0.1), so that it still stands where it was put."""


def compliance(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield static penetration, its slope over the load, and how it stays under a load held."""
    can, gravity = case.scene.can, case.scene.gravity
    phi = can.balancing_angle
    depths, held, borne = [], [], []
    for load in LOADS:
        loaded = with_gravity(case, load * gravity)
        world, depth = leaning(engine, loaded, phi)
        steps = max(2, round(_HELD * natural_time(case.scene) / engine.timestep(case)))
        contacts = [instant.contact for instant in follow(world, steps)]
        depths.append(depth)
        held.append(contacts[-1].penetration)
        borne.append(float(np.mean([contact.force[2] for contact in contacts])))
    loads = can.mass * gravity * np.array(LOADS)
    slope, _ = np.polyfit(loads, depths, 1)
    one = LOADS.index(1.0)
    how = "balanced on its rim, at 0.25 to 1.5 times its weight"
    yield from findings(
        "compliance",
        how,
        ("static penetration under its weight", "m", depths[one], 0.0),
        ("depth under its weight held for 0.1 sqrt(R/g)", "m", held[one], 0.0),
        ("depth for a load", "m/N", float(slope), 0.0),
        ("mean load borne over the weight", "1", borne[one] / loads[one], 1.0),
    )
    yield Trace(
        effect="compliance",
        x_label="load [N]",
        y_label="static penetration [m]",
        x=loads,
        y=np.array(depths),
    )
