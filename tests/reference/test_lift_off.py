"""The can leaves the plane where the normal force is zero, by every method, with every effect."""

from dataclasses import replace

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Effects,
    FindingKind,
    Gravity,
    Mass,
    Outcome,
    Parameters,
    Problem,
    examine,
    solve,
)
from reference.analysis.validity import LIGHT
from reference.equations.reaction_force import contact_force
from reference.solver import METHODS


@pytest.mark.parametrize("method", METHODS)
def test_without_friction_a_can_lifts_by_whatever_method(method: str) -> None:
    """Once only the default lifted, and the others went on with N = -11.9."""
    lifts = Problem(
        parameters=Parameters(a=0.4, c=0.2, h=1.2),
        phi=0.68,
        phi_dot=0.4,
        psi_dot=4.85,
        theta_dot=-2.06,
        duration=0.3,
        effects=Effects(mu=0.0),
    )
    exact, found = solve(lifts, model="coulomb"), solve(lifts, method=method)
    assert found.outcome is exact.outcome is Outcome.LIFTED
    assert exact.t_end > 0
    assert found.t_end == pytest.approx(exact.t_end, abs=1e-10)
    force = found.at(np.array([found.t_end])).force
    assert force is not None
    assert abs(force[0, 2]) < 1e-12
    # who would have to be pulled from the start does not begin
    assert solve(replace(lifts, phi_dot=-4.0), method=method).t_end == 0


FALLING = Problem(parameters=PAPER_CAN, phi=0.22, psi_dot=-1.1, theta_dot=-0.6, bounces=1)
"""Its bounce asks for a pull of 1.2 m g."""
SMALL = 1e-12


@pytest.mark.parametrize(
    "effects",
    [
        Effects(drilling=SMALL),
        Effects(rolling_resistance=SMALL),
        Effects(linear_damping=SMALL),
        Effects(angular_damping=SMALL),
        Effects(rim=SMALL),
        Effects(mass=Mass(share=SMALL)),
        Effects(gravity=Gravity(amplitude=(0.0, 0.0, SMALL), rate=1.0)),
    ],
)
def test_whatever_effect_is_declared_the_can_lifts_where_the_normal_force_is_zero(
    effects: Effects,
) -> None:
    ideal = solve(FALLING, model="rolling")
    assert ideal.outcome is Outcome.FINISHED
    assert examine(ideal, ideal.grid()).findings[0].kind is FindingKind.PULL
    found = solve(replace(FALLING, effects=effects))
    assert found.outcome is Outcome.LIFTED
    # there the force of the ideal motion is zero, but for what SMALL changes
    normal = contact_force(ideal.at(np.array([found.t_end])), PAPER_CAN)[2]
    assert abs(normal[0]) < 100 * SMALL
    seen = examine(found, found.grid())
    assert abs(seen.normal_force) < 1e-12
    # |F| is some tenths of the weight: over LIGHT at most
    assert 1 < seen.friction_ratio < 1 / LIGHT
    assert FindingKind.PULL not in {finding.kind for finding in seen.findings}
    (ending,) = (finding for finding in seen.findings if finding.kind is FindingKind.ENDING)
    assert ending.sentence.endswith("Declare restitution, be it 0: `unilateral` carries it.")


def test_a_normal_force_that_grazes_zero_between_two_looks_lifts() -> None:
    """N falls to -7e-9 for less than the fortieth part of a step."""
    problem = Problem(
        parameters=Parameters(a=0.4, c=0.5, h=1.473),
        phi=0.25,
        psi_dot=4.029855267305931,
        theta_dot=-0.95 * 4.029855267305931,
        duration=2.0,
        effects=Effects(mu=50.0),
    )
    lifted = solve(problem)
    assert lifted.outcome is Outcome.LIFTED
    assert lifted.t_end == pytest.approx(0.87438, abs=1e-5)
