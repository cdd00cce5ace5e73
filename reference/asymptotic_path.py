"""The asymptotic solution as a motion that runs on from bounce to bounce.

phi is the composite solution (eq01:uniformly_valid_solution); psi and theta are the inner ones
(eq01:psi_inner, eq01:theta_inner), equal and opposite, with the whole angle of turn in each bounce.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.asymptotic import Matched, matched_of
from reference.outcome import Outcome
from reference.problem import Problem, ProblemError
from reference.run import Run
from reference.states import Floats, States
from reference.track import Track

SAMPLES = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchedPath:
    """The composite solution as a motion, bounce after bounce; time in sqrt(R/g)."""

    problem: Problem
    matched: Matched
    t_end: float

    @property
    def period(self) -> float:
        """From maximum to maximum, 2 sqrt(I (a_p + 1))."""
        inertia = self.problem.parameters.pendulum_inertia
        return float(2 * self.matched.bounce_time * np.sqrt(inertia))

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        m = self.matched
        scale = np.sqrt(self.problem.parameters.pendulum_inertia)
        cycle = np.floor(times / self.period)
        t = (times - cycle * self.period) / scale
        phi, away = m.composite(t), t - m.bounce_time
        inner = m.inner(t)
        phi_dot = (m.height * away / inner - away) / scale
        # the sweep of one bounce, made whole at its ends, where the outer region takes over
        sweep = m.precession(t) / m.precession(np.array([2 * m.bounce_time]))
        turned = m.angle_of_turn * (cycle + (1 + sweep) / 2)
        rate = m.reduced.B_minus_two / inner**2
        zero = np.zeros_like(phi)
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=self.problem.psi + turned,
            psi_dot=rate,
            theta=self.problem.theta - turned,
            theta_dot=-rate,
            spin=zero,
        )

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states, crowded around each bounce."""
        half = self.period / 2
        width = self.matched.phi_min / np.sqrt(self.matched.height)
        steps = np.sinh(np.linspace(0, np.arcsinh(self.matched.bounce_time / width), SAMPLES))
        steps *= half / steps[-1]
        bounces = np.arange(int(np.ceil(self.t_end / self.period)) or 1)
        grid = half + np.concatenate([-steps[:0:-1], steps])
        times = np.unique((bounces[:, None] * self.period + grid).ravel())
        times = np.unique(np.clip(times, 0.0, self.t_end))
        return times, self.at(times)


def solve_asymptotically(problem: Problem) -> Run:
    """Return the composite solution of a release from rest.

    Raises
    ------
    ProblemError
        If the release is not at rest in phi, or nothing turns: the expansion has no such case.
    """
    if problem.phi_dot != 0:
        raise ProblemError("the asymptotic solution starts from rest: `phi_dot` must be 0")
    matched = matched_of(problem)
    if matched.sign == 0:
        raise ProblemError("the asymptotic solution needs precession or rotation: B_{-2} is 0")
    path = MatchedPath(problem=problem, matched=matched, t_end=0.0)
    t_end = problem.duration or path.period * (problem.bounces or 1)
    path = replace(path, t_end=t_end)
    count = int(np.floor(2 * t_end / path.period * (1 + 1e-15))) + 1
    halves = np.arange(count, dtype=float)
    times = np.minimum(halves * path.period / 2, t_end)
    track = Track(
        outcome=Outcome.FINISHED,
        t_end=t_end,
        times=times,
        extrema=_extrema(path, halves),
        maximum=halves % 2 == 0,
    )
    return Run(path=path, track=track, steps=0, evaluations=0)


def _extrema(path: MatchedPath, halves: Floats) -> States:
    """States at maxima and minima, free of the rounding of their times."""
    top = path.at(np.zeros(1))
    bottom = path.at(np.array([path.period / 2]))
    even = halves % 2 == 0
    turned = path.matched.angle_of_turn * halves / 2

    def pick(name: str) -> Floats:
        return np.asarray(np.where(even, getattr(top, name)[0], getattr(bottom, name)[0]))

    return States(
        phi=np.where(even, pick("phi"), path.matched.phi_min),
        phi_dot=np.zeros(halves.size),
        psi=path.problem.psi + turned,
        psi_dot=np.where(even, pick("psi_dot"), path.matched.peak_psi_dot),
        theta=path.problem.theta - turned,
        theta_dot=np.where(even, pick("theta_dot"), -path.matched.peak_psi_dot),
        spin=np.zeros(halves.size),
    )
