"""Solving a problem with the model and the method of your choice."""

from collections.abc import Callable
from collections.abc import Set as AbstractSet

from reference.asymptotic_path import solve_asymptotically
from reference.choice import carries, equations_of, smallest
from reference.confirmation import solve_twice
from reference.contact_modes import Kind, Phase
from reference.coulomb import CoulombEquations
from reference.exact_path import solve_exactly
from reference.frictionless import solve_frictionless
from reference.marching import march
from reference.measure import measure_bounces
from reference.newton_euler import GeneralEquations
from reference.phases import Follower, PhasedRun
from reference.planar import solve_pendulum
from reference.problem import Problem
from reference.reduced import solve_reduced
from reference.rocking import rock
from reference.run import Run
from reference.solution import Solution
from reference.time_stepping import SCIPY_METHODS, step_in_time

OUTPUTS = frozenset({"contact_locus"})
METHODS = ("regular", "marching", *SCIPY_METHODS)
MODELS = (
    "auto",
    "pendulum",
    "frictionless",
    "rolling",
    "coulomb",
    "general",
    "exact",
    "reduced",
    "asymptotic",
)
WITH_LOCUS = ("auto", "pendulum", "frictionless", "rolling", "coulomb", "general", "exact")
WITHOUT_SLIP = ("pendulum", "rolling", "exact")


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
        One of `MODELS`. "auto" takes the smallest that carries the problem (`reference.choice`),
        and where that is "rolling" solves it twice (`reference.confirmation`): by the closed
        solution of the full equations, and by integrating one period of it. Where the two agree to
        within round-off the answer is the closed one, else the integration's; `agreement` of the
        solution says how they compare. "exact" asks for the closed solution alone, without
        confirmation, and integrates where the can does not bounce. "rolling" always integrates.
    method : str
        How to integrate: "regular", the default (`reference.rocking`); "marching", the same without
        use of its mirror symmetry (`reference.marching`); or one of scipy's methods in the raw
        variables.
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
        If a choice does not exist, or the model is too small for the effects of the problem.
    """
    choice = smallest(problem)
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
    if model != "auto" and problem.effects.declared() and not carries(model, problem):
        raise SolverError(
            f"`model` {model!r} is too small; the smallest that carries this is {choice.model!r}"
        )
    confirmed = None
    if model == "auto" and method == "regular" and choice.model == "rolling":
        confirmed = solve_twice(problem, locus=locus)
        run = confirmed.motion.run
        solved_by, used = ("exact", "quadrature") if confirmed.closed else ("rolling", method)
        bounces = confirmed.motion.bounces
    else:
        run, solved_by, used = _dispatch(
            problem, model=model, method=method, rtol=rtol, locus=locus
        )
        bounces = measure_bounces(
            run.path, run.track, problem.parameters, sliding=solved_by == "frictionless"
        )
    phases = run.phases if isinstance(run, PhasedRun) else ()
    if solved_by in WITHOUT_SLIP:
        phases = (Phase(kind=Kind.STICK, start=0.0, end=run.track.t_end),)
    return Solution(
        problem=problem,
        model=solved_by,
        method=used,
        outcome=run.track.outcome,
        bounces=bounces,
        t_end=run.track.t_end,
        maxima=run.track.maxima,
        minima=run.track.minima,
        steps=run.steps,
        evaluations=run.evaluations,
        path=run.path,
        equations=equations_of(solved_by, problem),
        why=choice.why,
        phases=phases,
        agreement=None if confirmed is None else confirmed.agreement,
    )


def _dispatch(
    problem: Problem, *, model: str, method: str, rtol: float, locus: bool
) -> tuple[Run, str, str]:
    """Return the run, the model that was solved in the end, and how."""
    stepped = "DOP853" if method == "regular" else method
    needed = smallest(problem).model
    if model == "auto" and needed != "rolling" and (method == "regular" or needed != "pendulum"):
        model = needed
    if model in {"coulomb", "general"} and method != "regular":
        raise SolverError(f"`method` of model {model!r} is 'regular' alone, not {method!r}")
    smaller: dict[str, Callable[[], tuple[Run, str]]] = {
        "pendulum": lambda: (solve_pendulum(problem), "closed form"),
        "asymptotic": lambda: (solve_asymptotically(problem), "closed form"),
        "reduced": lambda: (solve_reduced(problem, method=stepped, rtol=rtol), stepped),
        "frictionless": lambda: (solve_frictionless(problem, method=method, rtol=rtol), method),
        "coulomb": lambda: (_follow_with_friction(problem, locus=locus), method),
        "general": lambda: (_follow_with_everything(problem, locus=locus), method),
    }
    if model in smaller:
        run, used = smaller[model]()
        return run, model, used
    if model == "exact" and method == "regular":
        found = solve_exactly(problem, locus=locus)
        if found is not None:
            return found, "exact", "quadrature"
    if method == "regular":
        return rock(problem, locus=locus), "rolling", method
    if method == "marching":
        return march(problem, locus=locus), "rolling", method
    return step_in_time(problem, method=method, rtol=rtol, locus=locus), "rolling", method


def _follow_with_friction(problem: Problem, *, locus: bool) -> Run:
    mu = float("inf") if problem.effects.mu is None else problem.effects.mu
    equations = CoulombEquations(parameters=problem.parameters, mu=mu)
    return Follower(problem, equations, locus=locus).run()


def _follow_with_everything(problem: Problem, *, locus: bool) -> Run:
    equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
    return Follower(problem, equations, locus=locus).run()
