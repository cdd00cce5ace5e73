"""How an engine's contact differs from a rolling point: depth, slip, lift-off, several points.

Read at the recorded samples, which are dense by angle; a single step between two of them may be
missed.
"""

from dataclasses import dataclass

import numpy as np

from harness.metrics.motion import Motion, shares


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactQuality:
    """What the contact did over a run.

    Parameters
    ----------
    max_penetration : float
        m; zero if the can never sank.
    max_slip : float
        m/s, at the engine's contact point.
    lift_off_fraction : float
        Share of the time without any contact force.
    multi_contact_fraction : float
        Share of the time with more than one contact point that bears a force.
    """

    max_penetration: float
    max_slip: float
    lift_off_fraction: float
    multi_contact_fraction: float


def contact_quality(motion: Motion) -> ContactQuality:
    """Return how the contact behaved over a motion."""
    weight = shares(motion.time)
    depth, slip = motion.trajectory.penetration, motion.slip
    sunk, known = np.isfinite(depth), np.isfinite(slip)
    return ContactQuality(
        max_penetration=max(0.0, float(depth[sunk].max())) if sunk.any() else 0.0,
        max_slip=float(slip[known].max()) if known.any() else 0.0,
        lift_off_fraction=float(weight[~motion.touching].sum()),
        multi_contact_fraction=float(weight[motion.trajectory.contact_count > 1].sum()),
    )
