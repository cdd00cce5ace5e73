"""Solving a problem with the model and the method of your choice."""

from collections.abc import Set as AbstractSet

from reference.measure import measure_bounces
from reference.problem import Problem
from reference.solution import Outcome, Solution
from reference.time_stepping import METHODS, step_in_time
from reference.track import Ending

OUTPUTS = frozenset({"contact_locus"})
MODELS = ("auto", "rolling")
_OUTCOMES = {
    Ending.HORIZON: Outcome.FINISHED,
    Ending.OVERTURNED: Outcome.OVERTURNED,
    Ending.FELL_FLAT: Outcome.FELL_FLAT,
    Ending.STEADY: Outcome.STEADY,
    Ending.STALLED: Outcome.STALLED,
}


class SolverError(ValueError):
    """A model, method, tolerance or output that does not exist."""


def solve(
    problem: Problem,
    *,
    model: str = "auto",
    method: str = "DOP853",
    rtol: float = 1e-12,
    outputs: AbstractSet[str] = frozenset(),
) -> Solution:
    """Solve a problem of the rocking can.

    Parameters
    ----------
    problem : Problem
    model : str
        One of `MODELS`; "auto" takes the full equations.
    method : str
        How to integrate; one of scipy's method names.
    rtol : float
        Relative tolerance of the integrator.
    outputs : set of str
        What to integrate beside the angles: "contact_locus" or nothing.

    Returns
    -------
    Solution
        Also where the motion ends early: its `outcome` says why.

    Raises
    ------
    SolverError
        If a choice does not exist.
    """
    if model not in MODELS:
        raise SolverError(f"unknown `model` {model!r}; there are {', '.join(MODELS)}")
    if method not in METHODS:
        raise SolverError(f"unknown `method` {method!r}; there are {', '.join(METHODS)}")
    if not 0 < rtol < 1:
        raise SolverError(f"`rtol` must lie inside (0, 1), got {rtol!r}")
    if unknown := set(outputs) - OUTPUTS:
        raise SolverError(f"unknown `outputs` {sorted(unknown)}; there are {sorted(OUTPUTS)}")
    path, track = step_in_time(problem, method=method, rtol=rtol, locus="contact_locus" in outputs)
    return Solution(
        problem=problem,
        model="rolling",
        method=method,
        outcome=_OUTCOMES[track.ending],
        bounces=measure_bounces(path, track.maxima, track.minima, track.marks, problem.parameters),
        t_end=track.t_end,
        maxima=track.maxima,
        minima=track.minima,
        steps=track.steps,
        evaluations=track.evaluations,
        path=path,
        marks=track.marks,
    )
