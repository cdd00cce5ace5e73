"""Probes of a can under its weight: compliance, creep, rim, contact points, sliding.

Compliance. The can is balanced on its rim, at rest with its centre above the contact point
(eq:phistar), so that the load is its weight exactly; gravity is varied to vary the load. The depth
is the one at which one step leaves the contact at rest, and it is read again from the engine's
contact after a while.

Rim. The lowest point of an ideal can is z(phi) = R sin phi + H cos phi below the centre, whatever
the azimuth. A prism with n sides reaches as far at its corners and less between them, by
R (1 - cos(pi/n)) sin phi at most. A cylinder shrunk by m and swollen by a ball of radius m, which
is how a collision margin rounds the rim, reaches (R - m) sin phi + (H - m) cos phi + m: less than
the ideal by m (sin phi + cos phi - 1). A margin outside adds itself at every tilt. So

    deviation at the corners = swell - fillet (sin phi + cos phi - 1)

and a fit over the tilts separates swell and fillet.

Contact points. A rigid can touches in one point at every tilt above zero, and that point is on
its rim. A soft or rounded can that lies nearly flat touches along a piece of its rim, and an engine
spreads the force over several points: then the bounce of a rocking can is not that of the single
point that the mathematics has. A collider that takes the can for flat has a point elsewhere.

Sliding. Friction is mu times the load at once, whatever the load was a step before; and what slides
on a plane is not lifted off it. Convex approximations of the contact give up one or the other.

Friction compliance. The can is let go at rest, tilted less than it balances. Without precession or
spin it stays in one plane and falls about the point of its rim that touches, which no-slip keeps
fixed: a pendulum with I = A + m (R^2 + H^2). With the centre at x = R cos phi - H sin phi beside
the contact point and z = R sin phi + H cos phi above it, energy and Newton's law give

    phi'^2 = 2 m g (z(phi_0) - z(phi)) / I         phi'' = -m g x / I
    F = -m (z phi'' + x phi'^2)                    N = m (g + x phi'' - z phi'^2)

so the friction that holds the rim is known from phi alone. Every speed that the solver leaves at
the point where it pushed is creep; mass and moment are the engine's own, so that a wrong moment
does not pass for creep.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from harness.core.case import Case
from harness.core.errors import RefusedModelError
from harness.core.trajectory import Floats
from harness.engines.base import features_of
from harness.engines.parity.contact import Stand
from harness.engines.probes.survey import (
    Opener,
    Reading,
    alternatives,
    follow,
    leaning,
    probe,
    with_gravity,
)
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import LIFT, UP, X, hovering_distance, moving
from models import Can, Effects, Slip, angles, contact_offset
from models.kinematics import to_world

LOADS = (0.25, 0.5, 1.0, 1.5)
"""Weights of the can."""

_HELD = 0.1
"""Natural times for which the load is held: a balanced can has tipped by a thousandth of its
deviation's growth, exp(0.1), so that it still stands where it was put."""


@probe("compliance", contact=True)
def compliance(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield static penetration, its slope over the load, and how it stays under a load held."""
    can, gravity = case.scene.can, case.scene.gravity
    depths, held, borne = [], [], []
    for load in LOADS:
        world, depth = leaning(engine, with_gravity(case, load * gravity), can.balancing_angle)
        steps = max(2, round(_HELD * natural_time(case.scene) / world.timestep))
        contacts = [contact for _, _, contact in follow(world, steps)]
        depths.append(depth)
        held.append(contacts[-1].penetration)
        borne.append(float(np.mean([contact.force[2] for contact in contacts])))
    loads = can.mass * gravity * np.array(LOADS)
    slope, _ = np.polyfit(loads, depths, 1)
    one = LOADS.index(1.0)
    how = "balanced on its rim, at 0.25 to 1.5 times its weight"
    yield "static penetration under its weight", "m", depths[one], 0.0, how
    yield "depth under its weight held for 0.1 sqrt(R/g)", "m", held[one], 0.0, how
    yield "depth for a load", "m/N", float(slope), 0.0, how
    yield "mean load borne over the weight", "1", float(borne[one] / loads[one]), 1.0, how


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


@probe("friction compliance", contact=True)
def creep(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the speed at which the rim creeps, over the force, and the error of the force."""
    case = with_gravity(case, case.scene.gravity)
    can, gravity, T = case.scene.can, case.scene.gravity, natural_time(case.scene)
    start = _TILT * can.balancing_angle
    world, _ = leaning(engine, case, start)
    _, transverse, axial = world.inertia.tolist()
    can = replace(can, mass=world.mass, transverse_inertia=transverse, axial_inertia=axial)
    slips, tilts, forces = [], [], []
    for pose, _, contact in follow(world, max(8, round(_TO * T / world.timestep))):
        phi, psi, _ = angles(pose.quaternion)
        offset = contact.point - pose.position
        if not np.isfinite(offset).all():  # nothing touches
            offset = contact_offset(can, phi, psi)
        left = world.twist()  # after the step that solved this contact
        slips.append((left.velocity + np.cross(left.angular_velocity, offset))[0])
        tilts.append(float(phi))
        forces.append(contact.force[0])
    late = slice(round(_FROM / _TO * len(slips)), None)
    F, N = planar_fall(can, gravity, start, np.array(tilts))
    slip, force = np.array(slips), np.array(forces)
    how = "let go at rest at 0.7 of the balancing angle; rim speed from 0.3 to 0.5 sqrt(R/g)"
    for quantity, unit, value, expected in (
        ("creep of the rim", "m/s", np.abs(slip[late]).mean(), 0.0),
        ("creep over the force", "m/s/N", (np.abs(slip[late]) / F[late]).mean(), 0.0),
        ("friction ratio", "1", np.mean((force / N)[late]), float((F / N)[late].mean())),
        ("error of the friction over the closed form", "1", (force / F - 1.0)[late].mean(), 0.0),
    ):
        yield quantity, unit, float(value), expected, how


TILTS = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2)
"""rad."""

AZIMUTHS = 256
"""Positions round the rim: eight to a side of a prism with 32."""


@probe("rim")
def rim(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield sides of a polygon, its sagitta, the radius of a fillet, and a swelling."""
    world, can, tilts = engine.open(case), case.scene.can, np.array(TILTS)
    azimuths: Floats = np.arange(AZIMUTHS) * np.float64(2.0 * math.pi / AZIMUTHS)
    # how much lower the collider reaches than an ideal can, by tilt and azimuth
    excess = np.array(
        [
            [LIFT * can.radius - hovering_distance(world, can, phi, theta) for theta in azimuths]
            for phi in TILTS
        ]
    )
    spread, corners = np.ptp(excess, axis=1), excess.max(axis=1)
    basis = np.stack((np.ones_like(tilts), -(np.sin(tilts) + np.cos(tilts) - 1.0)), axis=1)
    (swell, fillet), *_ = np.linalg.lstsq(basis, corners, rcond=None)
    # distances are differences of lengths of the can's size, each known to some ulps
    noise = 1e-12 * can.bounding_radius
    middle = TILTS.index(0.6)
    spectrum = np.abs(np.fft.rfft(excess[middle]))[1:]
    sides = 1.0 + int(np.argmax(spectrum)) if spread[middle] > noise else 0.0
    how = "distance to the plane at 7 tilts from 0.05 to 1.2 rad and 256 azimuths"
    yield "sides of the rim; 0 is round", "1", sides, 0.0, how
    for quantity, length in (
        ("sagitta between the corners over sin phi", np.median(spread / np.sin(tilts))),
        ("fillet radius", fillet),
        ("swell beyond the declared size", swell),
        ("largest deviation", np.abs(excess).max()),
    ):
        yield quantity, "m", 0.0 if abs(length) <= noise else float(length), 0.0, how


POINTS_TILTS = np.logspace(-9.0, -1.0, 65)
"""rad; eight to a decade."""


@probe("contact points", contact=True)
def points(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield the largest tilt at which several points bear the load, and where a single one is."""
    ideal, largest, nearest, can = with_gravity(case, case.scene.gravity), 0.0, 1.0, case.scene.can
    for phi in POINTS_TILTS.tolist():
        world, _ = leaning(engine, ideal, phi)
        pose = world.pose()
        world.step()
        contact = world.contact()
        if contact.count > 1:
            largest = phi
        elif contact.count == 1:
            middle = pose.position - can.half_height * to_world(pose.quaternion, UP)
            reach = float(np.linalg.norm(contact.point - middle)) / can.radius
            nearest = min(nearest, reach)
    how = "one step from rest at static penetration, at 65 tilts from 1e-9 to 0.1 rad"
    yield "tilt below which several points bear the load", "rad", largest, 0.0, how
    yield "least distance of a single contact from the middle of the base", "R", nearest, 1.0, how


_MU = 0.3
"""Friction of a can that slides: steep enough to be seen, too little to hold the can."""

_SLIDE = 1.0
"""Speed of the slide, over sqrt(g R)."""

_PRESSED = 1e-6
"""Of the radius: a load that was not there in the step before."""

_AWAIT = 40
"""Steps in which a can that touches comes to be borne."""


@probe("sliding")
def sliding(engine: Opener, case: Case) -> Iterator[Reading]:
    """Yield friction in the first step of a load, and how fast what slides is lifted.

    Again with other settings, where they change it.
    """
    if "slip" not in engine.capabilities.honours:
        return
    case = with_gravity(case, case.scene.gravity)
    case = replace(case, scene=replace(case.scene, effects=Effects(slip=Slip(mu=_MU))))
    base = _slid(engine, case)
    names = (
        ("friction over the declared, in the first step of a load", 1.0),
        ("rise of what slides, over mu times its speed", 0.0),
    )
    how = "slides along its lean at sqrt(g R), balanced on its rim, mu 0.3"
    for (quantity, expected), value in zip(names, base, strict=True):
        if value is not None:
            yield quantity, "1", value, expected, how
    for name, word in alternatives(engine.settings, case):
        try:
            other = _slid(engine, replace(case, options=(*case.options, (name, word))))
        except RefusedModelError:  # the engine does not take this value with the others
            continue
        for (quantity, expected), own, usual in zip(names, other, base, strict=True):
            if own is not None and usual is not None and abs(own - usual) > _CHANGED:
                yield f"{quantity}, with {name}={word}", "1", own, expected, how


_CHANGED = 0.01
"""Change of a reading by another setting that is worth a row."""


def _slid(engine: Opener, case: Case) -> tuple[float | None, float | None]:
    """Return friction over the declared, and rise over mu times the speed; None where unborne."""
    told = features_of(engine).description.tells_forces
    world, can = engine.open(case), case.scene.can
    stand = Stand(world, case.scene, world.timestep, tells_forces=told)
    speed = _SLIDE * can.radius / natural_time(case.scene)
    force = stand.press(_PRESSED * can.radius, moving(speed * X)).force
    ratio = math.hypot(force[0], force[1]) / float(force[2]) / _MU if force[2] > 0.0 else None
    for contact in islice(stand.pressed(0.0, moving(speed * X)), _AWAIT):
        if contact.force[2] > 0.0:
            after = world.twist()
            rise = float((after.velocity + np.cross(after.angular_velocity, stand.offset))[2])
            return ratio, rise / (_MU * speed)
    return ratio, None
