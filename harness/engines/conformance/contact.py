"""The contact: of the same instant as the state, and obeying Newton's second law.

Both are told from what a reading of the next instant would give. Between samples t apart

    m (v' - v)/t = F - m g z

holds for the force F that was applied. A misfit as large as the change of F from sample to sample
is a force of the wrong instant; half of that is what a force at either end may differ from the
mean.
"""

import numpy as np

from harness.engines.conformance.bench import COARSE, FINE, Bench
from harness.engines.conformance.verdict import Found, holds, within
from models.rim import contact_point

NEWTON = 0.6
"""Misfit over the change of the force from sample to sample: 0 where the force of a step is told,
1/2 where that of its first instant is, with a tenth for the curvature; 1 is the next instant."""

SAME = 0.1
"""Distance of the contact point from the lowest point of the rim, over the way of that point from
sample to sample: 1 is the next instant. A tenth is left to engines that round the rim a little."""


def newton(bench: Bench) -> Found:
    """Compare the force of each sample with the change of the velocity up to the next."""
    path = bench.trajectory(bench.case(bench.brief, COARSE))
    can, gravity = bench.brief.can, bench.brief.gravity
    if len(path) < 3:  # noqa: PLR2004 - two changes of the velocity to compare one change of force
        return holds(f"{len(path)} samples are too few", "")
    gained = can.mass * np.diff(path.velocity, axis=0) / np.diff(path.time)[:, None]
    weight = np.array((0.0, 0.0, can.mass * gravity))
    misfit = np.linalg.norm(gained - path.contact_force[:-1] + weight, axis=1)
    change = np.linalg.norm(np.diff(path.contact_force, axis=0), axis=1)
    # root mean squares, so that one step in which the force happens to rest does not decide
    ratio = float(np.sqrt(np.mean(misfit**2) / np.mean(change**2)))
    worst = float(misfit.max()) / (can.mass * gravity)
    detail = f"misfit over the change of the force; at most {worst:.1g} of the weight"
    return within(ratio, NEWTON, "1", detail)


def same_instant(bench: Bench) -> Found:
    """Compare the contact point of each sample with the lowest point of the rim."""
    path = bench.trajectory(bench.case(bench.gentle, FINE))
    low = contact_point(bench.gentle.can, path.position, path.quaternion)
    single = (path.contact_count == 1)[:-1]
    if not single.any():
        return holds("no sample touches in one point", "")
    off = np.linalg.norm((path.contact_point - low)[:-1, :2], axis=1)[single]
    way = np.linalg.norm(np.diff(low[:, :2], axis=0), axis=1)[single]
    ratio = float(np.sqrt(np.mean(off**2) / np.mean(way**2)))
    worst = float(off.max()) / bench.gentle.can.radius
    detail = f"distance over the way between samples; at most {worst:.1g} of the radius"
    return within(ratio, SAME, "1", detail)
