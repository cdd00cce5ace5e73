"""Friction compliance: how fast a rim creeps under a force that true friction would hold.

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

from harness.case import Case
from harness.engines.horizon import natural_time
from harness.engines.probes.evidence import Evidence, Finding, Trace
from harness.engines.probes.opening import Opener, follow, leaning, with_gravity
from harness.trajectory import Floats
from models.can import Can
from models.kinematics import angles
from models.rim import contact_offset

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
        yield Finding(
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
