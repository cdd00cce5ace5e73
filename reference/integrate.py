"""Solving a problem with the model and the method of your choice."""

from collections.abc import Callable
from collections.abc import Set as AbstractSet

from reference.asymptotic_path import solve_asymptotically
from reference.exact_path import solve_exactly
from reference.frictionless import solve_frictionless
from reference.marching import march
from reference.measure import measure_bounces
from reference.pendulum import solve_pendulum
from reference.problem import Problem
from reference.reduced import solve_reduced
from reference.run import Run
from reference.solution import Solution
from reference.time_stepping import SCIPY_METHODS, step_in_time

OUTPUTS = frozenset({"contact_locus"})
METHODS = ("regular", *SCIPY_METHODS)
MODELS = ("auto", "exact", "rolling", "reduced", "asymptotic", "pendulum", "frictionless")


WITH_LOCUS = ("auto", "exact", "rolling", "frictionless")


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
        One of `MODELS`. "exact" takes the closed solution of the full equations where the can
        bounces, and integrates them where it does not; "auto" does the same; "rolling" always
        integrates.
    method : str
        How to integrate: "regular", the default (`reference.marching`), or one of scipy's methods
        in the raw variables.
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
    if locus and model not in WITH_LOCUS:
        raise SolverError(f"`model` {model!r} has no contact locus; {', '.join(WITH_LOCUS)} have")
    run, solved_by, used = _dispatch(problem, model=model, method=method, rtol=rtol, locus=locus)
    return Solution(
        problem=problem,
        model=solved_by,
        method=used,
        outcome=run.track.outcome,
        bounces=measure_bounces(
            run.path, run.track, problem.parameters, sliding=model == "frictionless"
        ),
        t_end=run.track.t_end,
        maxima=run.track.maxima,
        minima=run.track.minima,
        steps=run.steps,
        evaluations=run.evaluations,
        path=run.path,
    )


def _dispatch(
    problem: Problem, *, model: str, method: str, rtol: float, locus: bool
) -> tuple[Run, str, str]:
    """Return the run, the model that was solved in the end, and how."""
    stepped = "DOP853" if method == "regular" else method
    smaller: dict[str, Callable[[], tuple[Run, str]]] = {
        "pendulum": lambda: (solve_pendulum(problem), "closed form"),
        "asymptotic": lambda: (solve_asymptotically(problem), "closed form"),
        "reduced": lambda: (solve_reduced(problem, method=stepped, rtol=rtol), stepped),
        "frictionless": lambda: (solve_frictionless(problem, method=stepped, rtol=rtol), stepped),
    }
    if model in smaller:
        run, used = smaller[model]()
        return run, model, used
    if model in {"auto", "exact"} and method == "regular":
        found = solve_exactly(problem, locus=locus)
        if found is not None:
            return found, "exact", "quadrature"
    if method == "regular":
        return march(problem, locus=locus), "rolling", method
    return step_in_time(problem, method=method, rtol=rtol, locus=locus), "rolling", method
