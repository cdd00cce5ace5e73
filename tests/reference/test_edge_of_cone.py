"""What is held where its reaction stands on the edge of its friction cone."""

from dataclasses import replace

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Effects,
    FindingKind,
    Kind,
    Outcome,
    Parameters,
    Problem,
    examine,
    solve,
)
from reference.equations.contact_laws import Mode
from reference.equations.coulomb import CoulombEquations
from reference.equations.state_vector import released
from reference.nonsmooth.segments import SegmentsPath
from tests.onsets.campaign import pulls_and_excess

EDGES = {
    # once stuck for ever, where it needs 4.9 and mu is 0.85
    "stuck": (
        Parameters(a=2.4458977454944817, c=1.3709009350341448, h=0.12161682424675234),
        (1.195138536954516, 1.402611426528888, -4.259781777600158),
        Kind.SLIP,
    ),
    # which needs less soon; once slipped below its own round-off, for 20 s and no further
    "slow": (
        Parameters(a=0.06489918545350426, c=0.08141464191271924, h=0.8570613661397004),
        (0.4655989909526477, 1.8513302278749264, -0.30971247595006696),
        Kind.STICK,
    ),
    # of two slips that the equations have near the edge one has a negative mobility
    "inadmissible": (
        Parameters(a=0.3084541791326839, c=0.06675889360328628, h=0.3397888709079677),
        (1.1274629064613455, 3.3251030742457695, 1.2779116146293827),
        Kind.SLIP,
    ),
}


@pytest.mark.parametrize("model", ["coulomb", "general"])
@pytest.mark.parametrize("ulps", [-2, 0, 2])
@pytest.mark.parametrize("name", EDGES)
def test_what_stands_on_the_edge_of_its_cone_slips_if_it_needs_more_than_there_is(
    name: str, ulps: int, model: str
) -> None:
    """At phi' = 0 the friction that is needed is stationary: its slack falls below round-off."""
    can, (phi, psi_dot, theta_dot), ends = EDGES[name]
    start = Problem(parameters=can, phi=phi, psi_dot=psi_dot, theta_dot=theta_dot, duration=0.3)
    force = CoulombEquations(parameters=can, mu=1.0).contact(released(start)[:, None], Mode()).force
    mu = float(np.hypot(*force[:2, 0]) / force[2, 0]) * (1 + ulps * np.finfo(float).eps)
    found = solve(replace(start, effects=Effects(mu=mu)), model=model)
    assert found.outcome is Outcome.FINISHED
    least, excess = pulls_and_excess(found)
    assert least >= 0
    assert excess < 1
    assert examine(found, found.grid()).findings == ()
    assert found.phases[-1].kind is ends
    # 200000 once; a hundred steps of a few iterations at 16 points
    assert found.evaluations < 5000


def test_a_rim_that_sticks_beyond_its_cone_is_a_finding() -> None:
    start = Problem(parameters=PAPER_CAN, phi=0.9, psi_dot=0.3, theta_dot=-0.4, duration=0.5)
    rolls = solve(replace(start, effects=Effects(mu=2.0)))
    needed = examine(rolls, rolls.grid())
    assert needed.findings == ()
    # as if it had been followed so with less
    wrong = replace(rolls, problem=replace(rolls.problem, effects=Effects(mu=0.26)))
    (finding,) = examine(wrong, wrong.grid()).findings
    assert finding.kind is FindingKind.CONE


def test_a_turning_that_stops_in_the_step_in_which_rolling_begins_is_seen() -> None:
    """Once followed as if friction went on against a turning that it had already turned round."""
    found = solve(
        Problem(
            parameters=Parameters(a=0.844324671342653, c=0.4093693761472177, h=0.6147681066005056),
            phi=1.0390712947482998,
            psi_dot=-0.00014877262193151657,
            duration=0.3,
            effects=Effects(
                mu=7.9203538225587735,
                drilling=0.11003449511211205,
                rolling_resistance=0.01902974846793292,
            ),
        )
    )
    assert pulls_and_excess(found)[1] < 1
    assert isinstance(found.path, SegmentsPath)
    assert [piece.mode.turns for piece in found.path.pieces][:2] == [-1, 0]
