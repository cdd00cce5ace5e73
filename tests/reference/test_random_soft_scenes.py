"""Random cans with random effects on a contact that gives way: none fails, or makes energy.

A sample of the thousand that `python -m tests.random_scenes` takes.
"""

import numpy as np
import pytest

from reference import Outcome, Problem, solve
from tests.support.soft_contact import energies, random_problem

LOCUS = frozenset({"contact_locus"})
SCENES = 1000
ENDED = {
    Outcome.FINISHED,
    Outcome.OVERTURNED,
    Outcome.FELL_FLAT,
    Outcome.CAME_TO_REST,
    Outcome.VIBRATES,
}
EXCLUDED = {
    frozenset({"contour_friction", "rolling_resistance"}),
    frozenset({"patch", "drilling"}),
    *(frozenset({name, "sticks for ever"}) for name in ("slip", "static", "patch")),
}


def fault_of(problem: Problem) -> str:
    """Return what is wrong with the solution of a problem; nothing if nothing is."""
    found = solve(problem, outputs=LOCUS)
    law = problem.effects.compliance
    # a rim that never slips on a damper: see the test of such a one
    several = problem.effects.mu is None and law is not None and law.damping > 0
    if found.outcome is Outcome.INDETERMINATE and several:
        return ""
    if found.outcome not in ENDED:
        return f"{found.outcome.name} at {found.t_end:.6g} after {found.evaluations}"
    force = found.at(np.linspace(0, found.t_end, 300)).force
    assert force is not None
    if not np.isfinite(force).all():
        return "not a number"
    if (pull := float(force[:, 2].min())) < -1e-12:
        return f"pulled with {-pull:.2g} m g"
    whole = energies(found)
    missing = float(np.ptp(whole)) / (1 + float(np.abs(whole).max()))
    return f"lacks {missing:.2g} of its energy" if missing > 1e-12 else ""


@pytest.mark.parametrize("number", range(0, SCENES, 50))
def test_a_random_scene_has_a_motion_and_is_never_pulled(number: int) -> None:
    assert not fault_of(random_problem(number))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(5, SCENES, 10))
def test_another_random_scene_has_a_motion_and_is_never_pulled(number: int) -> None:
    assert not fault_of(random_problem(number))


def test_every_effect_is_drawn_with_every_other_that_it_does_not_exclude() -> None:
    drawn = [random_problem(number) for number in range(SCENES)]
    sets = [set(problem.effects.declared()) | extras(problem) for problem in drawn]
    names = sorted(set().union(*sets))
    for index, one in enumerate(names):
        for other in names[:index]:
            together = sum({one, other} <= named for named in sets)
            assert together > 10 or frozenset({one, other}) in EXCLUDED, (one, other)


def extras(problem: Problem) -> set[str]:
    """Return what a scene declares beside the names of its effects."""
    effects, law = problem.effects, problem.effects.compliance
    assert law is not None
    there = {
        "height": problem.height > 0,
        "static": effects.mu_static != effects.mu,
        "damped": law.damping > 0,
        "curved": law.exponent > 1,
        "sticks for ever": effects.mu is None,
    }
    return {name for name, declared in there.items() if declared}
