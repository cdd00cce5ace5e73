"""Derivatives of the nutation at fixed times, by the variational equations along a motion.

They go on where a bounce ends, for as long as the motion does. Of a chaotic motion they grow
exponentially, and are exact all the same: the equations are linear in the disturbance.
"""

from dataclasses import replace

import numpy as np

from reference.analysis.linearisation import NUMBER
from reference.analysis.stepped_constants import constants
from reference.analysis.tangent_motion import UndecidedError, tangent_motion
from reference.analysis.variational import without_tangent
from reference.equations.state_vector import LEAN, TIME, Angles
from reference.integrable.tangents import BY
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solver import solve


def nutation_tangents(problem: Problem, times: Floats) -> tuple[tuple[str, ...], Floats, Floats]:
    """Return the nutation's rate at times, and its derivatives by the numbers of a problem.

    Parameters
    ----------
    problem : Problem
        Its horizon does not matter.
    times : ndarray, shape (n,)
        Dimensionless, ascending.

    Returns
    -------
    by : tuple of str, length k
        What derivatives are taken by.
    rates : ndarray, shape (n,)
        phi' at the times. Not a number after the motion has ended, in the last steps of a slip
        that comes to rest (`reference.analysis.saltation.ENDING`), and of a motion whose path
        has no pieces (`reference.nonsmooth.segments.SegmentsPath`).
    slopes : ndarray, shape (n, k)
        Likewise, of phi at the same time.
    """
    by = (*BY, *constants(problem.effects))
    until = replace(problem, bounces=None, duration=float(times[-1]))
    solution = solve(until, model="general")
    rates, slopes = np.full(len(times), np.nan), np.full((len(times), len(by)), np.nan)
    if not isinstance(solution.path, SegmentsPath):
        return by, rates, slopes
    motion = tangent_motion(problem, solution.path, by)
    for place in np.flatnonzero(solution.covers(times)):
        number, c = solution.path.place(float(times[place]))
        if without_tangent(problem.effects, motion.pieces[: number + 1]):
            break
        try:
            d, f = motion.disturbances(number, c, turns=False), motion.rates(number, c)
        except UndecidedError:
            continue  # the law changes here, to round-off
        late = d[NUMBER[TIME]] / f[NUMBER[TIME]]
        S = Angles.of(motion.state(number, c)[LEAN]).S[0]
        slopes[place] = S * (d[NUMBER[LEAN]] - f[NUMBER[LEAN]] * late)
        rates[place] = S * f[NUMBER[LEAN]] / f[NUMBER[TIME]]
    return by, rates, slopes
