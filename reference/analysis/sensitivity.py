"""Derivatives of the first bounce by the release, the can and the constants of its effects.

Of the ideal can that rocks for ever they are those of the closed solution
(`reference.integrable.derivatives`); of any other they come of the variational equations
(`reference.analysis.tangent_motion`).
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np

from reference.analysis.stepped_constants import SCALARS, constants
from reference.analysis.tangent_motion import motion_tangents
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
        Sentences: which derivatives are of one side, and that those beside a separatrix are large.
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
            by, jets, why = motion_tangents(problem, solution)
            return _filled(by, jets, why, "variational equations", _one_sided(problem))
        # a motion without impacts is that of the same can without restitution
        problem = replace(problem, effects=replace(problem.effects, restitution=None))
    path = None if problem.effects.declared() else exact_path(problem, locus=False)
    if isinstance(path, ExactPath):
        jets, why = bounce_tangents(problem, path)
        if NO_PATH not in why.values():
            caveats = (*_one_sided(problem), *_separatrix(path))
            return _filled(BY, jets, why, "quadrature", caveats)
    by, jets, why = motion_tangents(problem)
    caveats = (*_one_sided(problem), *(_separatrix(path) if isinstance(path, ExactPath) else ()))
    return _filled(by, jets, why, "variational equations", caveats)


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
        method=method,
        caveats=caveats,
    )


def _one_sided(problem: Problem) -> tuple[str, ...]:
    """Return which derivatives are of one side: at rest, and at the bound of a constant."""
    sentences = []
    if problem.phi_dot == 0.0:
        sentences.append(
            "Derivatives by the rate of phi are those towards larger values, for the release is at "
            "rest: one that falls opens its first bounce itself, without the way from the maximum."
        )
    values, declared = asdict(problem.effects), constants(problem.effects)
    bound = [name for name, field in SCALARS.items() if name in declared and values[field] == 0.0]
    if problem.effects.compliance is not None and problem.effects.compliance.damping == 0.0:
        bound.append("compliance.damping")
    if bound:
        named = ", ".join(f"effects.{name}" for name in bound)
        sentences.append(
            f"Derivatives by {named} are those towards larger values, for none is below zero."
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
