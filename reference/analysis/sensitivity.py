"""Derivatives of the first bounce by the release, the can and the constants of its effects.

Of the ideal can that rocks for ever they are those of the closed solution
(`reference.integrable.derivatives`); of any other they come of the variational equations
(`reference.analysis.bounce_tangents`).
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np

from reference.analysis.bounce_tangents import motion_tangents
from reference.analysis.release_tangents import OF_RELEASE
from reference.analysis.stepped_constants import SCALARS, constants
from reference.analysis.tangent_motion import model_of
from reference.analysis.unilateral_tangents import BRANCH
from reference.equations.contact_laws import Kind
from reference.integrable.derivatives import NO_PATH, QUANTITIES, bounce_tangents
from reference.integrable.exact_motion import ExactPath, exact_path
from reference.integrable.tangents import BY
from reference.numerics.jets import Jet
from reference.problem.problem import Problem
from reference.problem.states import Floats
from reference.solution import Solution
from reference.solver import solve

# phi_max this near the balanced can, over phi_max, is beside a separatrix.
NEAR = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """Derivatives of the first bounce, dimensionless.

    Attributes
    ----------
    by : tuple of str
        What the derivatives are taken by: the release, the can, constants of declared effects.
    values : mapping of str to float
        By the names `QUANTITIES`; not a number where there is no derivative.
    derivatives : mapping of str to ndarray of shape (k,)
        Likewise.
    why : mapping of str to str
        Why there is none, of those quantities.
    method : str
        "quadrature", "variational equations", or "none".
    caveats : tuple of str
        Sentences: which derivatives are of one side, that those beside a separatrix are large, and
        by what there are none.
    """

    by: tuple[str, ...]
    values: Mapping[str, float]
    derivatives: Mapping[str, Floats]
    why: Mapping[str, str]
    method: str
    caveats: tuple[str, ...] = ()


def _stays_on_plane(solution: Solution) -> bool:
    """Return whether a first bounce with restitution is one without it."""
    kinds = {Kind.STICK} if solution.problem.effects.mu is None else {Kind.STICK, Kind.SLIP}
    on_plane = {phase.kind for phase in solution.phases} <= kinds and not solution.impacts
    return on_plane and bool(solution.bounces)


def sensitivity(problem: Problem) -> Sensitivity:
    """Return the derivatives of the first bounce of a problem.

    A release that falls counts as the maximum that opens the bounce. So of a release at rest
    period and turn have two derivatives by phi', and the one returned is that towards phi' > 0,
    where a bounce begins at a maximum.

    Parameters
    ----------
    problem : Problem
        Its horizon does not matter.
    """
    if problem.effects.restitution is not None:
        solution = solve(replace(problem, bounces=1, duration=None))
        if problem.height > 0 or not _stays_on_plane(solution):
            return _along_motion(problem, solution)
        # a motion without impacts is that of the same can without restitution
        problem = replace(problem, effects=replace(problem.effects, restitution=None))
    path = None if problem.effects.declared() else exact_path(problem, locus=False)
    if not isinstance(path, ExactPath):
        return _along_motion(problem)
    jets, why = bounce_tangents(problem, path)
    if NO_PATH in why.values():
        own = _along_motion(problem)
        return replace(own, caveats=(*own.caveats, *_separatrix(path)))
    caveats = (*_one_sided(problem, at_rest=problem.phi_dot == 0.0), *_separatrix(path))
    return _filled(BY, jets, why, "quadrature", caveats)


def _along_motion(problem: Problem, solution: Solution | None = None) -> Sensitivity:
    """Return the derivatives by the variational equations."""
    if solution is None:
        solution = solve(replace(problem, bounces=1, duration=None), model=model_of(problem))
    by, jets, why = motion_tangents(problem, solution)
    on_plane = problem.height == 0 and problem.effects.compliance is None
    opens = on_plane or bool(solution.maxima.size and solution.maxima[0] == 0.0)
    missing = {
        name: [quantity for quantity, jet in jets.items() if np.isnan(jet.slope[place])]
        for place, name in enumerate(by)
        if name not in OF_RELEASE
    }
    absent = frozenset(name for name, of in missing.items() if of)
    caveats = list(_one_sided(problem, absent, at_rest=opens and problem.phi_dot == 0.0))
    turns = problem.phi_dot or problem.psi_dot or problem.theta_dot
    if problem.height > 0 and not turns:
        caveats.append(
            "A can that is dropped without turning keeps its phi until it lands. One that turns "
            "has a maximum of phi in the air, and with it another first bounce than that of which "
            "the derivatives are."
        )
    for name in by:
        if name in absent:
            key = f"effects.{name}" if "." in name else f"can.{name}"
            named = ", ".join(each.replace("_", " ") for each in missing[name])
            caveats.append(f"By {key} there is no derivative of {named}: {BRANCH}.")
    return _filled(by, jets, why, "variational equations", tuple(caveats))


def _filled(
    by: tuple[str, ...],
    jets: Mapping[str, Jet],
    why: Mapping[str, str],
    method: str,
    caveats: tuple[str, ...],
) -> Sensitivity:
    none = np.full(len(by), np.nan)
    return Sensitivity(
        by=by,
        values={name: float(jets[name].value) if name in jets else np.nan for name in QUANTITIES},
        derivatives={name: jets[name].slope if name in jets else none for name in QUANTITIES},
        why={name: why[name] for name in QUANTITIES if name in why},
        method=method if jets else "none",
        caveats=caveats if jets else (),
    )


def _one_sided(
    problem: Problem, absent: frozenset[str] = frozenset(), *, at_rest: bool
) -> tuple[str, ...]:
    """Return which derivatives are of one side: at rest, and at the bound of a constant.

    Of those that are there.
    """
    sentences = []
    if at_rest:
        sentences.append(
            "Derivatives by the rate of phi are those towards larger values, for the release is at "
            "rest: one that falls opens its first bounce itself, without the way from the maximum."
        )
    values, declared = asdict(problem.effects), constants(problem.effects)
    bound = [name for name, field in SCALARS.items() if name in declared and values[field] == 0.0]
    if problem.effects.compliance is not None and problem.effects.compliance.damping == 0.0:
        bound.append("compliance.damping")
    bound = [name for name in bound if name not in absent]
    if bound:
        named = ", ".join(f"effects.{name}" for name in bound)
        sentences.append(
            f"Derivatives by {named} are those towards larger values, for none is below zero."
        )
    given = problem.effects.restitution
    if given is not None and given.coefficient == 1.0 and "restitution.coefficient" not in absent:
        sentences.append(
            "Derivatives by effects.restitution.coefficient are those towards smaller values, for "
            "none is above one."
        )
    if problem.effects.mu_static is not None and problem.effects.mu_static == problem.effects.mu:
        sentences.append(
            "Derivatives by effects.slip.mu_static are those towards larger values, and by "
            "effects.slip.mu towards smaller ones, for static friction is not below the kinetic."
        )
    return tuple(sentences)


def _separatrix(path: ExactPath) -> tuple[str, ...]:
    """Return that derivatives are large because the can all but stops where it rises highest."""
    clock = path.clock
    distance = float((clock.fourth_root[0] - clock.high[0]) / clock.high[0])
    if distance >= NEAR:
        return ()
    sentence = (
        f"The bounce is beside a separatrix: phi_max is {distance:.1e} of itself from a nutation "
        "at which the can would wait for ever. The period grows like the logarithm of that "
        "distance, and its derivatives like one over it; so does the turn, if the can precesses "
        "while it waits."
    )
    return (sentence,)
