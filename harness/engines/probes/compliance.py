"""Compliance: how deep the rim sinks under a load, against a rigid plane that gives nothing.

The can is balanced on its rim, at rest with its centre above the contact point (eq:phistar), so
that the load is its weight exactly; gravity is varied to vary it. The depth is the one at which one
step leaves the contact at rest, and it is read again from the engine's contact after a while.
"""

from collections.abc import Iterator

import numpy as np

from harness.case import Case
from harness.engines.horizon import natural_time
from harness.engines.probes.evidence import Evidence, Finding, Trace
from harness.engines.probes.opening import Opener, follow, leaning, with_gravity

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
    for quantity, unit, value, expected in (
        ("static penetration under its weight", "m", depths[one], 0.0),
        ("depth under its weight held for 0.1 sqrt(R/g)", "m", held[one], 0.0),
        ("depth for a load", "m/N", float(slope), 0.0),
        ("mean load borne over the weight", "1", borne[one] / loads[one], 1.0),
    ):
        yield Finding(
            effect="compliance",
            quantity=quantity,
            unit=unit,
            value=value,
            expected=expected,
            how=how,
        )
    yield Trace(
        effect="compliance",
        x_label="load [N]",
        y_label="static penetration [m]",
        x=loads,
        y=np.array(depths),
    )
