"""Reading the bounces off a motion."""

from collections.abc import Callable
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from scipy.optimize import minimize_scalar

from reference.contact import friction_ratio
from reference.parameters import Parameters
from reference.sampling import grid_by_angle
from reference.solution import Bounce, Path
from reference.states import Floats, States

Quantity: TypeAlias = Callable[[States], Floats]


def measure_bounces(
    path: Path, maxima: Floats, minima: Floats, marks: Floats, parameters: Parameters
) -> tuple[Bounce, ...]:
    """One `Bounce` for each minimum of phi that has a maximum on either side.

    Parameters
    ----------
    path : Path
    maxima, minima, marks : ndarray
        Times of the extrema of phi and of the solver's steps, increasing.
    parameters : Parameters
    """
    bounces = []
    for left, right in pairwise(maxima.tolist()):
        between = minima[(minima > left) & (minima < right)]
        if between.size != 1:
            raise RuntimeError("between two maxima of phi there must be one minimum")
        inside = marks[(marks > left) & (marks < right)]
        times = grid_by_angle(path, np.concatenate([[left, right], between, inside]))
        states = path.at(times)
        ends, bottom = path.at(np.array([left, right])), path.at(between)
        bounces.append(
            Bounce(
                time=float(between[0]),
                phi_min=float(bottom.phi[0]),
                angle_of_turn=float(ends.psi[1] - ends.psi[0]),
                rotation_turn=float(ends.theta[1] - ends.theta[0]),
                peak_psi_dot=_peak(path, times, states.psi_dot, _precession),
                peak_friction_ratio=_peak(
                    path,
                    times,
                    friction_ratio(states, parameters),
                    lambda s: friction_ratio(s, parameters),
                ),
            )
        )
    return tuple(bounces)


def _precession(states: States) -> Floats:
    return states.psi_dot


def _peak(path: Path, times: Floats, values: Floats, quantity: Quantity) -> float:
    """Value of largest magnitude, with its sign, refined between samples."""
    best = int(np.argmax(np.abs(values)))
    low, high = times[max(best - 1, 0)], times[min(best + 1, times.size - 1)]
    if not np.isfinite(values[best]) or high <= low:
        return float(values[best])
    sign = np.sign(values[best]) or 1.0
    found = minimize_scalar(
        lambda t: -sign * quantity(path.at(np.array([t])))[0],
        bounds=(low, high),
        method="bounded",
        # the peak is flat: the square root of eps in time is eps in value
        options={"xatol": 1e-8 * (high - low)},
    )
    return float(max(abs(values[best]), -found.fun) * sign)
