"""Derivatives of the nutation at fixed times, by the variational equations along a motion.

They go on where a bounce ends, for as long as the motion does. Of a chaotic motion they grow
exponentially, and are exact all the same: the equations are linear in the disturbance.
"""

from dataclasses import replace

import numpy as np

from reference.analysis.linearisation import NUMBER, UndecidedError
from reference.analysis.release_tangents import numbers
from reference.analysis.tangent_motion import model_of, path_in_pieces, tangent_motion
from reference.analysis.variational import without_tangent
from reference.equations.state_vector import LEAN, TIME, Angles
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
        that comes to rest (`reference.analysis.saltation.ENDING`), and of a motion without
        derivatives that are known (`reference.analysis.tangent_motion.path_in_pieces`).
    slopes : ndarray, shape (n, k)
        Likewise, of phi at the same time.
    """
    by = numbers(problem)
    until = replace(problem, bounces=None, duration=float(times[-1]))
    solution = solve(until, model=model_of(problem))
    rates, slopes = np.full(len(times), np.nan), np.full((len(times), len(by)), np.nan)
    try:
        path = path_in_pieces(problem, solution)
        motion = tangent_motion(problem, path)
    except UndecidedError:
        return by, rates, slopes
    for place in np.flatnonzero(solution.covers(times)):
        number, c = path.place(float(times[place]))
        if without_tangent(motion.pieces[: number + 1]):
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
