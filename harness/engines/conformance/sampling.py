"""The sampling grid: from the release on, forwards, dense by angle, up to the horizon."""

from dataclasses import replace

import numpy as np

from harness.engines.conformance.bench import BRIEF, FINE, Bench
from harness.engines.conformance.verdict import Found, not_applicable, within
from models.kinematics import angle_rates, angles, principal
from models.record import RESOLVED_STEP
from models.scene import Horizon

_ODD = 7e-4
"""s: a timestep that does not divide the horizon."""


def starts(bench: Bench) -> Found:
    """Look at the first instant and at the smallest distance between two."""
    time = bench.trajectory(bench.case(bench.brief)).time
    # the release is at zero exactly: nothing is summed up to there
    if len(time) > 1 and not np.diff(time).min() > 0.0:
        return within(-float(np.diff(time).min()), 0.0, "s", "time runs backwards or stands still")
    return within(abs(float(time[0])), 0.0, "s", f"first instant of {len(time)}, all increasing")


def dense(bench: Bench) -> Found:
    """Look at how far the precession gets between samples, through the whole bounce.

    The rates at both ends count as well, since between samples far apart psi may go round unseen.
    """
    path = bench.trajectory(bench.case(bench.gentle, FINE))
    if len(path) < 2:  # noqa: PLR2004 - one sample has no distance to another
        return within(float("inf"), float(RESOLVED_STEP), "rad", "one sample")
    phi, psi, _ = angles(path.quaternion)
    _, psi_dot, _ = angle_rates(phi, psi, path.angular_velocity)
    rate = np.maximum(np.abs(psi_dot[:-1]), np.abs(psi_dot[1:]))
    turn = np.maximum(np.abs(principal(np.diff(psi))), rate * np.diff(path.time))
    detail = f"largest turn of psi from sample to sample, of {len(path)}"
    return within(float(turn.max()), float(RESOLVED_STEP), "rad", detail)


def ends(bench: Bench) -> Found:
    """Look at the last instant, where the timestep divides the horizon and where it does not."""
    worst = 0.0
    for timestep in (1e-3, _ODD) if bench.steps else (1e-3,):
        case = bench.case(bench.brief, timestep)
        left = BRIEF - float(bench.trajectory(case).time[-1])
        # a solver without timesteps ends at the horizon itself, but for round-off
        allowed = timestep if bench.steps else 1e-12 * BRIEF
        # the last state lies at the horizon or less than a timestep before it, never behind it
        worst = max(worst, left / allowed, -left / (1e-9 * BRIEF))
    return within(worst, 1.0, "timesteps", "from the last sample to a horizon of 20 ms")


def grows(bench: Bench) -> Found:
    """Let the horizon double: the first half of the run stays what it was."""
    if not bench.steps:
        return not_applicable("a solver that chooses its own steps may choose others")
    short = bench.trajectory(bench.case(bench.brief))
    double = replace(bench.brief, horizon=Horizon(seconds=2.0 * BRIEF))
    long = bench.trajectory(bench.case(double))
    common = short.time[:-1]  # the last sample of a run is kept whatever the angles say
    at = np.searchsorted(long.time, common)
    if at.max() >= len(long):
        return within(float("inf"), 0.0, "m", "the longer run lacks instants of the shorter")
    off = float(np.abs(long.position[at] - short.position[:-1]).max())
    return within(off, 0.0, "m", "position at the instants of the shorter run")
