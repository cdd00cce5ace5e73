"""Energy of a can that may fly, from its motion alone."""

import numpy as np

from reference import Solution, centre_position, centre_velocity
from reference.equations.nonholonomic import angular_velocity
from reference.problem.states import Floats
from reference.unilateral.free_body import Body


def energy(solution: Solution, times: Floats) -> Floats:
    """Return the energy without the shaking, in m g R."""
    problem, there = solution.problem, solution.at(times)
    body = Body.of(problem.parameters, problem.effects)
    v = centre_velocity(there, problem.parameters, problem.effects)
    w, cos, sin = angular_velocity(there), np.cos(there.theta), np.sin(there.theta)
    w = np.stack([cos * w[:, 0] + sin * w[:, 1], cos * w[:, 1] - sin * w[:, 0], w[:, 2]], -1)
    place = centre_position(there, problem.parameters, problem.effects)
    kinetic = (body.mass * (v * v).sum(1) + (w * (w @ body.inertia)).sum(1)) / 2
    return np.asarray(kinetic - body.mass * place @ np.array(problem.effects.gravity.constant))
