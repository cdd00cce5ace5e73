"""Contact points: from which tilt down a rim touches in more than one.

A rigid can touches in one point at every tilt above zero. A soft or rounded one that lies nearly
flat touches along a piece of its rim, and an engine spreads the force over several points: in
between, the bounce of a rocking can is not the point's that the mathematics speaks of.
"""

from collections.abc import Iterator

import numpy as np

from harness.case import Case
from harness.engines.probes.evidence import Evidence, Finding, Trace
from harness.engines.probes.opening import Opener, leaning, with_gravity

TILTS = np.logspace(-9.0, -1.0, 65)
"""rad; eight to a decade."""


def points(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the largest tilt at which several points bear the load in the first step."""
    ideal = with_gravity(case, case.scene.gravity)
    counts = []
    for phi in TILTS.tolist():
        world, _ = leaning(engine, ideal, phi)
        world.step()
        counts.append(float(world.contact().count))
    several = [phi for phi, count in zip(TILTS.tolist(), counts, strict=True) if count > 1.0]
    yield Finding(
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
        x=TILTS,
        y=np.array(counts),
    )
