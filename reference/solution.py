"""The result of every solver: the motion with its bounces and its ending."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reference.analysis.agreement import Agreement
from reference.analysis.conditioning import RoundOff, round_off
from reference.analysis.sampling import grid_by_angle
from reference.equations.contact_laws import Impact, Phase
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, States
from reference.problem.validation import RefusedError
from reference.smooth.extrema import Path
from reference.unilateral.path import UnilateralPath

if TYPE_CHECKING:
    from reference.analysis.sensitivity import Sensitivity


BEFORE = 4.0 * np.finfo(float).eps
"""Share of its time by which a sample is before an impact: a unit of time leaves them apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounce:
    """One bounce, from a maximum of phi through the minimum to the next maximum.

    Attributes
    ----------
    time : float
        Time of the minimum of phi, in sqrt(R/g).
    phi_min : float
        Smallest nutation.
    angle_of_turn, rotation_turn : float
        Signed change of psi, and of theta, between the two maxima.
    peak_psi_dot : float
        Precession rate of largest magnitude, with its sign, in sqrt(g/R).
    peak_friction_ratio : float
        Largest |F|/N; infinite where the plane would have to pull, or does not push but
        holds the rim: friction without limit does not vanish with the push.
    """

    time: float
    phi_min: float
    angle_of_turn: float
    rotation_turn: float
    peak_psi_dot: float
    peak_friction_ratio: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """A solved problem.

    Attributes
    ----------
    problem : Problem
    model, method : str
        Which equations, and how they were solved.
    outcome : Outcome
    bounces : tuple of Bounce
    t_end : float
        Where the solution ends, in sqrt(R/g).
    maxima, minima : ndarray
        Times of the extrema of phi; a falling release is a maximum at 0.
    steps, evaluations : int
        Solver work; neither depends on the machine.
    path : Path
    equations : int
        Number of equations integrated together, without quadratures; 0 for a closed form.
    why : str
        Why these: what the smallest model that carries the problem is, in a sentence.
    phases : tuple of Phase
        Intervals in which the rim sticks, slips or flies, in order; none of a model without a
        contact.
    impacts : tuple of Impact
        Of a can whose contact is unilateral, in order.
    agreement : Agreement or None
        How the closed solution and the integration compare, of a motion that was solved twice.
    """

    problem: Problem
    model: str
    method: str
    outcome: Outcome
    bounces: tuple[Bounce, ...]
    t_end: float
    maxima: Floats
    minima: Floats
    steps: int
    evaluations: int
    path: Path = field(repr=False)
    equations: int = 0
    why: str = ""
    phases: tuple[Phase, ...] = ()
    impacts: tuple[Impact, ...] = ()
    agreement: Agreement | None = None

    def covers(self, times: Floats) -> NDArray[np.bool_]:
        """Which times, shape (n,), lie in [0, t_end]: a sum of time steps may be rounded beyond."""
        slack = 8 * np.finfo(float).eps * max(self.t_end, 1.0)
        return (times >= -slack) & (times <= self.t_end + slack)

    def at(self, times: Floats | float) -> States:
        """States at the given times.

        Parameters
        ----------
        times : float or array_like, shape (n,)
            Inside [0, t_end], in sqrt(R/g).

        Raises
        ------
        RefusedError
            If a time lies outside the solution.
        """
        times = np.atleast_1d(np.asarray(times, dtype=float))
        if not self.covers(times).all():
            allowed = f"inside [0, {self.t_end!r}]"
            raise RefusedError("times", times, allowed, f"`times` must lie {allowed}")
        return self.path.at(np.clip(times, 0.0, self.t_end))

    def lost(self, times: Floats) -> Floats:
        """Energy that effects have taken since the release, over m g R.

        Parameters
        ----------
        times : ndarray, shape (n,)
            Inside [0, t_end], in sqrt(R/g).

        Returns
        -------
        ndarray, shape (n,)
            Zero of a model whose rim neither rubs nor is driven.
        """
        own = self.path
        if isinstance(own, SegmentsPath | UnilateralPath):
            return own.lost(times)
        return np.zeros_like(times)

    @property
    def _rocks(self) -> bool:
        """Whether the motion has a maximum of phi either side of a bounce, and no other ending."""
        rolls = self.model in {"exact", "rolling"} and self.outcome is Outcome.FINISHED
        return rolls and self.maxima.size >= 2  # noqa: PLR2004 - either side

    @property
    def round_off(self) -> RoundOff | None:
        """Return the foretold loss by round-off of an endless rocking; mostly None."""
        return round_off(self.problem, self.at(self.maxima[-1:])) if self._rocks else None

    @property
    def caveat(self) -> str:
        """Return a sentence on the loss by round-off of an endless rocking; mostly empty."""
        if foretold := self.round_off:
            return foretold.sentence
        seen = self.agreement
        return seen.sentence if self._rocks and seen is not None and seen.holds else ""

    @property
    def sensitivity(self) -> "Sensitivity":
        """Return the exact derivatives of the first bounce, computed when they are asked for.

        They are of the problem, whatever approximation this solution is of it.
        """
        from reference.analysis.sensitivity import sensitivity

        return sensitivity(self.problem)

    def grid(self) -> Floats:
        """Return sampling times, dense by angle; of an impact the last instant before it, too.

        See `reference.analysis.sampling.grid_by_angle`.
        """
        struck = np.array([impact.time for impact in self.impacts])
        sides = (struck, struck * (1.0 - BEFORE))
        landmarks = np.concatenate([[0.0, self.t_end], self.maxima, self.minima, *sides])
        # every fourth node: where to look, not yet how densely
        times, _ = self.path.nodes()
        return grid_by_angle(self.path, np.concatenate([landmarks, times[::4]]))
