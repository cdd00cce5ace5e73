"""Solving a problem with the model and the method of your choice."""

from collections.abc import Set as AbstractSet

from reference.marching import march
from reference.measure import measure_bounces
from reference.problem import Problem
from reference.solution import Solution
from reference.time_stepping import SCIPY_METHODS, step_in_time

OUTPUTS = frozenset({"contact_locus"})
METHODS = ("regular", *SCIPY_METHODS)
MODELS = ("auto", "rolling")


class SolverError(ValueError):
    """A model, method, tolerance or output that does not exist."""


def solve(
    problem: Problem,
    *,
    model: str = "auto",
    method: str = "regular",
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
        How to integrate: "regular", the default (`reference.marching`), or one of scipy's methods in
        the raw variables.
    rtol : float
        Relative tolerance of scipy's methods; "regular" always works to round-off.
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
    locus = "contact_locus" in outputs
    if method == "regular":
        run = march(problem, locus=locus)
    else:
        run = step_in_time(problem, method=method, rtol=rtol, locus=locus)
    return Solution(
        problem=problem,
        model="rolling",
        method=method,
        outcome=run.track.outcome,
        bounces=measure_bounces(run.path, run.track, problem.parameters),
        t_end=run.track.t_end,
        maxima=run.track.maxima,
        minima=run.track.minima,
        steps=run.steps,
        evaluations=run.evaluations,
        path=run.path,
    )
