"""The rim: how far the collider is from a sharp circle, against tilt and azimuth.

The lowest point of an ideal can is z(phi) = R sin phi + H cos phi below the centre, whatever the
azimuth. A prism with n sides reaches as far at its corners and less between them, by
R (1 - cos(pi/n)) sin phi at most. A cylinder shrunk by m and swollen by a ball of radius m, which
is how a collision margin rounds the rim, reaches (R - m) sin phi + (H - m) cos phi + m: less than
the ideal by m (sin phi + cos phi - 1). A margin outside adds itself at every tilt. So

    deviation at the corners = swell - fillet (sin phi + cos phi - 1)

and a fit over the tilts tells the two apart.
"""

import math
from collections.abc import Iterator

import numpy as np

from harness.case import Case
from harness.engines.base import World
from harness.engines.probes.evidence import Evidence, Finding, Trace
from harness.engines.probes.opening import STILL, Opener
from harness.trajectory import Floats
from models.can import Can
from models.kinematics import quaternion
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
        yield Finding(
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
