"""The planar motion as a solution: the can falls flat or over, and nothing else moves."""

from dataclasses import dataclass

import numpy as np

from reference.contact import contact_from_centre
from reference.outcome import Outcome
from reference.pendulum import Pendulum, frequency, planar_motion
from reference.problem import Problem
from reference.run import Run
from reference.states import Floats, States, initial_states, states_of
from reference.track import Track

SAMPLES = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarPath:
    """The planar motion as states: psi, theta and the contact point stay what they were."""

    problem: Problem
    pendulum: Pendulum
    t_end: float

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        phi, phi_dot = self.pendulum.nutation(times)
        zero = np.zeros_like(phi)
        release = initial_states(self.problem)
        point = contact_from_centre(release, self.problem.parameters)[0]
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=zero + self.problem.psi,
            psi_dot=zero,
            theta=zero + self.problem.theta,
            theta_dot=zero,
            spin=zero,
            x=zero + point[0],
            y=zero + point[1],
        )

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states on an even grid."""
        times = np.linspace(0, self.t_end, SAMPLES)
        return times, self.at(times)


def solve_pendulum(problem: Problem) -> Run:
    """Follow the planar motion until the can lies flat, its side meets the plane, or time is up.

    Rates of precession and rotation are left out: this is the model in which they have no effect.
    """
    p = problem.parameters
    motion = planar_motion(p, problem.phi, problem.phi_dot)
    over = motion.constant < 0
    down = problem.phi_dot < 0 if over else motion.side < 0
    outcome = Outcome.FELL_FLAT if down else Outcome.OVERTURNED
    t_end = motion.time_at(0.0 if down else np.pi / 2)
    balanced = problem.phi == p.balancing_angle and problem.phi_dot == 0
    arrives = motion.constant == 0 and problem.phi_dot * motion.side < 0
    if problem.bounces is not None and (balanced or arrives):
        # a double is never quite in balance, and stays there as long as its last digit lets it
        outcome, t_end = Outcome.STEADY, 2 * np.pi / frequency(p)
    if problem.duration is not None and problem.duration < t_end:
        outcome, t_end = Outcome.FINISHED, problem.duration
    track = Track(
        outcome=outcome,
        t_end=float(t_end),
        times=np.empty(0),
        extrema=states_of([]),
        maximum=np.empty(0, dtype=bool),
    )
    return Run(
        path=PlanarPath(problem=problem, pendulum=motion, t_end=float(t_end)),
        track=track,
        steps=0,
        evaluations=0,
    )
