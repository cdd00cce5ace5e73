"""Solution of a problem with a chosen model and method.

The smallest model that carries a problem follows from its effects and its release:

    pendulum      nothing is declared and nothing turns: the can moves in a plane      2 equations
    frictionless  mu = 0: one degree of freedom and two conserved momenta              2
    rolling       nothing is declared: the rim never slips                             4
    coulomb       slip is declared: sticks while it may, slips beyond                  6
    compliant     the contact gives way: as general, with the depth of the rim and its rate     11
    general       anything else: six velocities, and the angles and the time that the forces
                  depend on                                                            up to 9
    unilateral    restitution is declared: the same can on the rim, and in the air     up to 9

Psi, theta, the time and the contact point are quadratures wherever nothing depends on them.
"exact", the closed solution, is of the same can as "rolling"; "reduced" and "asymptotic" are
approximations of it, good for nothing more.

Models beside the rolling can are imported when they are solved: a bounce needs none of them.
"""

import warnings
from collections.abc import Callable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from types import MappingProxyType

from reference.analysis.bounces import measure_bounces
from reference.analysis.confirmation import solve_twice
from reference.equations.contact_laws import Kind, Mode, Phase
from reference.integrable.exact_motion import solve_exactly
from reference.numerics.compiled import available
from reference.problem.problem import Problem
from reference.problem.validation import RefusedError
from reference.smooth.extrema import Run
from reference.smooth.scipy_ivp import SCIPY_METHODS, step_in_time
from reference.smooth.stepping import integrate
from reference.smooth.time_reversal import integrate_by_symmetry
from reference.solution import Solution

OF_ROLLING = ("rolling", "exact", "reduced", "asymptotic")


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A model for a problem.

    Attributes
    ----------
    model : str
    equations : int
        First-order equations that are integrated together, without quadratures.
    why : str
        A sentence.
    """

    model: str
    equations: int
    why: str


def smallest(problem: Problem) -> Choice:
    """Return the smallest model that carries a problem."""
    effects, declared = problem.effects, problem.effects.declared()
    if effects.compliance is not None or effects.restitution is not None:
        return _unheld(problem)
    if declared == ("slip",) and effects.mu == 0 and not effects.mu_static:
        why = "The plane is declared without friction: two momenta are conserved."
        return Choice(model="frictionless", equations=2, why=why)
    if declared == ("slip",):
        static = f", static {effects.mu_static:g}," if effects.mu_static else ""
        why = f"Friction {effects.mu:g}{static} is declared: the rim sticks while it may, or slips."
        return Choice(model="coulomb", equations=6, why=why)
    if declared:
        named = ", ".join(name.replace("_", " ") for name in declared)
        rest = "it takes" if len(declared) == 1 else "they take"
        why = f"Declared: {named}; {rest} the general can."
        return Choice(model="general", equations=equations_of("general", problem), why=why)
    if problem.psi_dot == problem.theta_dot == 0:
        why = "No effect is declared and nothing turns at the release: the can moves in a plane."
        return Choice(model="pendulum", equations=2, why=why)
    why = "No effect is declared and the can turns: it rolls without slipping."
    return Choice(model="rolling", equations=4, why=why)


def _unheld(problem: Problem) -> Choice:
    """Return the model of a can that may leave the plane, or sink into it."""
    effects, model = problem.effects, "compliant"
    why = "Declared: compliance; the rim has a depth, and the plane pushes by the law of it."
    if effects.restitution is not None:
        model, given = "unilateral", effects.restitution.coefficient
        why = f"With restitution {given:g} a rim that leaves the plane flies, and lands."
    lawful = {"compliance", "restitution"}
    others = [name.replace("_", " ") for name in effects.declared() if name not in lawful]
    why = f"{why} Beside it: {', '.join(others)}." if others else why
    return Choice(model=model, equations=equations_of(model, problem), why=why)


def equations_of(model: str, problem: Problem) -> int:
    """Return how many equations a model integrates together for a problem."""
    if model in {"general", "compliant", "unilateral"}:
        from reference.equations.newton_euler import GeneralEquations

        equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
        core = len(equations.core(Mode(slips=problem.effects.mu is not None)))
        return core + 2 if model == "compliant" else core
    counts = {"pendulum": 2, "frictionless": 2, "coulomb": 6, "reduced": 2}
    return counts.get(model, 0 if model in {"exact", "asymptotic"} else 4)


def carries(model: str, problem: Problem) -> bool:
    """Return whether a model is as large as a problem needs, or approximates one that is."""
    needed = smallest(problem).model
    larger = {
        "pendulum": ("pendulum", *OF_ROLLING, "coulomb", "general"),
        "rolling": (*OF_ROLLING, "coulomb", "general"),
        "frictionless": ("frictionless", "coulomb", "general"),
        "coulomb": ("coulomb", "general"),
        "general": ("general",),
        "compliant": ("compliant",),
        "unilateral": ("unilateral",),
    }
    return model in larger[needed]


OUTPUTS = frozenset({"contact_locus"})
METHODS = ("half-period", "picard-chebyshev", *SCIPY_METHODS)
RENAMED_METHODS = MappingProxyType({"regular": "half-period", "marching": "picard-chebyshev"})
"""Methods by their names of the previous release, which `solve` takes with a warning."""
MODELS = (
    "auto",
    "pendulum",
    "frictionless",
    "rolling",
    "coulomb",
    "general",
    "compliant",
    "unilateral",
    "exact",
    "reduced",
    "asymptotic",
)
WITH_LOCUS = tuple(model for model in MODELS if model not in {"reduced", "asymptotic"})
WITH_EVENTS = frozenset({"coulomb", "general", "compliant", "unilateral"})
WITHOUT_SLIP = ("pendulum", "rolling", "exact")


def renamed_method(old: str) -> str:
    """Return what is said of a method that is asked for by a key of `RENAMED_METHODS`."""
    now = RENAMED_METHODS[old]
    return f"method {old!r} is called {now!r} now; the old name goes with the next release"


class SolverError(RefusedError):
    """A model, method, tolerance or output that does not exist."""


def _unknown(key: str, value: object, allowed: str) -> SolverError:
    """Return the error of a choice that does not exist."""
    return SolverError(key, value, allowed, f"unknown `{key}` {value!r}; there are {allowed}")


def _require_numba(*, compiled: bool) -> None:
    """Refuse compiled code where there is no numba."""
    if compiled and not available():
        sentence = "`compiled` needs numba: install the extra `fast`, or leave `compiled` out"
        raise SolverError("compiled", compiled, "False without numba", sentence)


def solve(
    problem: Problem,
    *,
    model: str = "auto",
    method: str = "half-period",
    rtol: float = 1e-12,
    outputs: AbstractSet[str] = frozenset(),
    compiled: bool = False,
) -> Solution:
    """Solve a problem of the rocking can.

    Parameters
    ----------
    problem : Problem
    model : str
        One of `MODELS`. "auto" takes the smallest that carries the problem (`reference.solver`),
        and where that is "rolling" solves it twice (`reference.analysis.confirmation`): by the
        closed solution of the full equations, and by integrating one period of it. Where the two
        agree to within round-off the answer is the closed one, else the integration's; `agreement`
        of the solution says how they compare. "exact" asks for the closed solution alone, without
        confirmation, and integrates where the can does not bounce. "rolling" always integrates.
    method : str
        How to integrate: "half-period", the default, up to the next extremum of phi and from there
        by the motion's mirror symmetry (`reference.smooth.time_reversal`); "picard-chebyshev", the
        same steps without use of the symmetry (`reference.smooth.stepping`); or one of scipy's
        methods in the raw variables.
    rtol : float
        Relative tolerance of scipy's methods; the first two always work to round-off.
    outputs : set of str
        Further outputs besides the angles: "contact_locus" or none.
    compiled : bool
        Whether to integrate by compiled code (numba, the extra `fast`): the same equations and
        method, other round-offs. It pays where many problems are solved, for it takes a second to
        load, and at its first use on a machine some seconds to compile. `method` of the solution
        says which ran: closed forms have nothing to compile, effects that no kernel carries are
        computed in numpy, and so is the confirmation of a rolling can under "auto". Its rounds are
        counted apart, so that of two motions that call for all the work there is one may be
        followed further.

    Returns
    -------
    Solution
        Also where the motion ends early: its `outcome` says why.

    Raises
    ------
    SolverError
        If a choice does not exist, the model is too small for the effects of the problem, or
        compiled code is asked for without numba.
    """
    if method in RENAMED_METHODS:
        warnings.warn(renamed_method(method), DeprecationWarning, stacklevel=2)
        method = RENAMED_METHODS[method]
    choice = smallest(problem)
    if model not in MODELS:
        raise _unknown("model", model, ", ".join(MODELS))
    if method not in METHODS:
        raise _unknown("method", method, ", ".join(METHODS))
    if not 0 < rtol < 1:
        sentence = f"`rtol` must lie inside (0, 1), got {rtol!r}"
        raise SolverError("rtol", rtol, "inside (0, 1)", sentence)
    _require_numba(compiled=compiled)
    if unknown := set(outputs) - OUTPUTS:
        raise _unknown("outputs", sorted(unknown), str(sorted(OUTPUTS)))
    locus = "contact_locus" in outputs
    if locus and model not in WITH_LOCUS:
        allowed = ", ".join(WITH_LOCUS)
        sentence = f"`model` {model!r} has no contact locus; {allowed} have"
        raise SolverError("model", model, allowed, sentence)
    declared = problem.effects.declared()
    if model != "auto" and declared and not carries(model, problem):
        sentence = (
            f"`model` {model!r} is too small; the smallest that carries this is {choice.model!r}"
        )
        raise SolverError("model", model, choice.model, sentence)
    confirmed = None
    if model == "auto" and method == "half-period" and choice.model == "rolling":
        confirmed = solve_twice(problem, locus=locus)
        run = confirmed.motion.run
        solved_by, used = ("exact", "quadrature") if confirmed.closed else ("rolling", method)
        bounces = confirmed.motion.bounces
    else:
        run, solved_by, used = _dispatch(
            problem, choice.model, model, method=method, rtol=rtol, locus=locus, compiled=compiled
        )
        bounces = measure_bounces(
            run.path,
            run.track,
            problem.parameters,
            known=run.peaks,
            sliding=solved_by == "frictionless",
            symmetric=not declared,
            compiled=compiled,
        )
    phases = run.phases
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
        equations=(
            choice.equations if solved_by == choice.model else equations_of(solved_by, problem)
        ),
        why=choice.why,
        phases=phases,
        impacts=run.impacts,
        agreement=None if confirmed is None else confirmed.agreement,
    )


def _dispatch(
    problem: Problem,
    needed: str,
    model: str,
    *,
    method: str,
    rtol: float,
    locus: bool,
    compiled: bool,
) -> tuple[Run, str, str]:
    """Return the run, the model that was solved in the end, and how.

    Of a problem that needs a model, with the model that is asked for.
    """
    stepped = "DOP853" if method == "half-period" else method
    if (
        model == "auto"
        and needed != "rolling"
        and (method == "half-period" or needed != "pendulum")
    ):
        model = needed
    if model in WITH_EVENTS and method != "half-period":
        sentence = f"`method` of model {model!r} is 'half-period' alone, not {method!r}"
        raise SolverError("method", method, "half-period", sentence)
    if compiled and model in {"coulomb", "general"}:
        from reference.equations.compiled_equations import CompiledEquations

        # the one place where effects that no kernel carries are sent to numpy
        compiled = CompiledEquations.know(problem.effects)
    named = f"{method}, compiled" if compiled else method
    smaller: dict[str, Callable[[], tuple[Run, str]]] = {
        "pendulum": lambda: (_in_closed_form(problem, model), "closed form"),
        "asymptotic": lambda: (_in_closed_form(problem, model), "closed form"),
        "reduced": lambda: (_reduced(problem, stepped, rtol), stepped),
        "frictionless": lambda: (_without_friction(problem, method, rtol), method),
        "coulomb": lambda: (_with_phases(problem, model, locus=locus, compiled=compiled), named),
        "general": lambda: (_with_phases(problem, model, locus=locus, compiled=compiled), named),
        "compliant": lambda: (_yielding(problem, locus=locus), method),
        "unilateral": lambda: _in_the_air(problem, method, compiled=compiled),
    }
    if model in smaller:
        run, used = smaller[model]()
        return run, model, used
    if model == "exact" and method == "half-period":
        closed = solve_exactly(problem, locus=locus)
        if closed is not None:
            return closed, "exact", "quadrature"
    if method == "half-period":
        run = integrate_by_symmetry(problem, locus=locus, compiled=compiled)
        return run, "rolling", named
    if method == "picard-chebyshev":
        return integrate(problem, locus=locus, compiled=compiled), "rolling", named
    return step_in_time(problem, method=method, rtol=rtol, locus=locus), "rolling", method


def _in_closed_form(problem: Problem, model: str) -> Run:
    from reference.asymptotic.matched import solve_asymptotically
    from reference.equations.pendulum import solve_pendulum

    return solve_pendulum(problem) if model == "pendulum" else solve_asymptotically(problem)


def _reduced(problem: Problem, method: str, rtol: float) -> Run:
    from reference.asymptotic.small_nutation import solve_reduced

    return solve_reduced(problem, method=method, rtol=rtol)


def _without_friction(problem: Problem, method: str, rtol: float) -> Run:
    from reference.equations.frictionless import solve_frictionless

    return solve_frictionless(problem, method=method, rtol=rtol)


def _yielding(problem: Problem, *, locus: bool) -> Run:
    from reference.compliant.equations import CompliantEquations
    from reference.compliant.integrator import CompliantIntegrator

    law = problem.effects.compliance
    if law is None:
        sentence = "`model` 'compliant' needs `effects.compliance`: how the contact gives way"
        raise SolverError("model", "compliant", "another without a compliance", sentence)
    equations = CompliantEquations(parameters=problem.parameters, effects=problem.effects, law=law)
    return CompliantIntegrator(problem, equations, locus=locus).run()


def _in_the_air(problem: Problem, method: str, *, compiled: bool) -> tuple[Run, str]:
    from reference.unilateral.motion import UnilateralMotion

    motion = UnilateralMotion(problem, compiled=compiled)
    return motion.run(), f"{method}, compiled" if motion.compiled else method


def _with_phases(problem: Problem, model: str, *, locus: bool, compiled: bool) -> Run:
    from reference.equations.coulomb import CoulombEquations
    from reference.equations.newton_euler import GeneralEquations
    from reference.nonsmooth.hybrid_integrator import HybridIntegrator

    parameters, effects = problem.parameters, problem.effects
    equations: CoulombEquations | GeneralEquations
    if model == "coulomb":
        mu = float("inf") if effects.mu is None else effects.mu
        equations = CoulombEquations(parameters=parameters, mu=mu, static=effects.mu_static)
    else:
        equations = GeneralEquations(parameters=parameters, effects=effects)
    if compiled:
        from reference.equations.compiled_equations import CompiledEquations
        from reference.nonsmooth.compiled_integrator import CompiledIntegrator

        own = CompiledEquations.of(equations, problem)
        return CompiledIntegrator(problem, own, locus=locus).run()
    return HybridIntegrator(problem, equations, locus=locus).run()
