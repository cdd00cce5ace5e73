"""A sample of the hostile campaign (`python -m tests.reference.hostile`), fixed seed."""

import numpy as np

from reference import Outcome, Problem, exact_bounces, solve
from tests.reference.hostile.made import made

# Neighbouring energies beside a barrier amplify round-off by its share of the well: in this sample
# no energy is nearer than a hundredth.
AGREED = 1e-7


def test_releases_in_upper_wells_are_solved_as_the_integrator_solves_them() -> None:
    """Outcome, period and phi_min of the batch."""
    releases = [one for one in made(120, 7) if one.family == "upper well"]
    names = ("phi", "phi_dot", "psi_dot", "theta_dot")
    cycles = exact_bounces(
        **{name: [getattr(one.parameters, name) for one in releases] for name in "ach"},
        **{name: [getattr(one, name) for one in releases] for name in names},
    )
    assert cycles.bounced.sum() >= len(releases) / 2
    for number, one in enumerate(releases):
        release = {name: getattr(one, name) for name in names}
        asked = Problem(parameters=one.parameters, bounces=2, **release)
        integrated = solve(asked, model="rolling")
        assert cycles.outcome(number) is integrated.outcome, one
        if integrated.outcome is Outcome.FINISHED:
            period = np.diff(integrated.maxima)[-1]
            assert abs(cycles.period[number] / period - 1) < AGREED, one
            assert abs(cycles.phi_min[number] / integrated.bounces[-1].phi_min - 1) < AGREED, one
