"""The rim: how far the collider is from a sharp circle, against tilt and azimuth.

The lowest point of an ideal can is z(phi) = R sin phi + H cos phi below the centre, whatever the
azimuth. A prism with n sides reaches as far at its corners and less between them, by
R (1 - cos(pi/n)) sin phi at most. A cylinder shrunk by m and swollen by a ball of radius m, which
is how a collision margin rounds the rim, reaches (R - m) sin phi + (H - m) cos phi + m: less than
the ideal by m (sin phi + cos phi - 1). A margin outside adds itself at every tilt. So

    deviation at the corners = swell - fillet (sin phi + cos phi - 1)

and a fit over the tilts tells the two apart.

Contact points: from which tilt down a rim touches in more than one.

A rigid can touches in one point at every tilt above zero. A soft or rounded one that lies nearly
flat touches along a piece of its rim, and an engine spreads the force over several points: in
between, the bounce of a rocking can is not the point's that the mathematics speaks of.

Friction compliance: how fast a rim creeps under a force that true friction would hold.

The can is let go at rest, tilted less than it balances. Without precession or spin it stays in one
plane and falls about the point of its rim that touches, which no-slip keeps fixed: a pendulum with
I = A + m (R^2 + H^2). With the centre at x = R cos phi - H sin phi beside the contact point and
z = R sin phi + H cos phi above it, energy and Newton's law give

    phi'^2 = 2 m g (z(phi_0) - z(phi)) / I         phi'' = -m g x / I
    F = -m (z phi'' + x phi'^2)                    N = m (g + x phi'' - z phi'^2)

so the friction that holds the rim is known from phi alone. Every speed that the solver leaves at
the point where it pushed is creep; mass and moment are the engine's own, so that a wrong one does
not pass for it.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Floats
from harness.engines.base import World
from harness.engines.probes.fixture import (
    STILL,
    Evidence,
    Opener,
    ProbeFinding,
    Trace,
    follow,
    leaning,
    with_gravity,
)
from harness.engines.stepping.horizon import natural_time
from models.can import Can
from models.kinematics import angles, quaternion
from models.rim import contact_offset
from models.state import Pose

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
            found[row, column] = _LIFT * can.radius - world.gap()
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
    for quantity, unit, value in (
        ("sides of the rim; 0 is round", "1", float(sides)),
        ("sagitta between the corners over sin phi", "m", float(np.median(spread / np.sin(tilts)))),
        ("fillet radius", "m", float(fillet)),
        ("swell beyond the declared size", "m", float(swell)),
        ("largest deviation", "m", float(np.abs(found).max())),
    ):
        yield ProbeFinding(
            effect="rim",
            quantity=quantity,
            unit=unit,
            value=0.0 if unit == "m" and abs(value) <= noise else value,
            expected=0.0,
            how=how,
        )
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
    yield ProbeFinding(
        effect="contact points",
        quantity="tilt below which several points bear the load",
        unit="rad",
        value=max(several, default=0.0),
        expected=0.0,
        how="one step from rest at static penetration, at 65 tilts from 1e-9 to 0.1 rad",
    )
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
    for quantity, unit, value in (
        ("creep of the rim", "m/s", np.abs(slip[late]).mean()),
        ("creep over the force", "m/s/N", (np.abs(slip[late]) / F[late]).mean()),
        ("friction ratio", "1", (F / N)[late].mean()),
        ("error of the friction over the closed form", "1", (force / F - 1.0)[late].mean()),
    ):
        ratio = quantity == "friction ratio"
        yield ProbeFinding(
            effect="friction compliance",
            quantity=quantity,
            unit=unit,
            value=float(np.mean((force / N)[late])) if ratio else float(value),
            expected=float(value) if ratio else 0.0,
            how=how,
        )
    yield Trace(
        effect="friction compliance",
        x_label="time [s]",
        y_label="creep of the rim [m/s]",
        x=np.arange(len(slip)) * np.float64(dt),
        y=np.abs(slip),
    )
