"""Falls beside folds of the steady motions, where the pull on phi grows from next to nothing."""

import numpy as np
import pytest

from reference import PAPER_CAN, FindingKind, Outcome, Problem, examine, solve
from reference.equations.bifurcation import folds

PHI = 0.6
FOLD = folds(PAPER_CAN, np.array([PHI]))[0]


def beside_the_fold(share: float) -> Problem:
    return Problem(
        parameters=PAPER_CAN,
        phi=PHI,
        psi_dot=float(FOLD.psi_dot[0]),
        theta_dot=float(FOLD.theta_dot[0]) * (1 + share),
        bounces=1,
    )


@pytest.mark.parametrize("share", [1e-7, 1e-8])
def test_a_can_that_hardly_begins_to_fall_is_followed_to_its_bounce(share: float) -> None:
    """Once called steady after 400 pendulum times, though it bounces at 1213 sqrt(R/g)."""
    start = beside_the_fold(share)
    found, exact = solve(start, model="rolling"), solve(start, model="exact")
    assert found.outcome is exact.outcome is Outcome.FINISHED
    # an ulp of the rotation is eps/share of the pull
    (bounce,), (known,) = found.bounces, exact.bounces
    assert bounce.time == pytest.approx(known.time, rel=10 * np.finfo(float).eps / share)


def test_a_slow_fall_is_the_longer_the_nearer_the_fold() -> None:
    """With the pull s x^2 a fall takes a time that goes as the fourth root of the share."""
    times = [
        solve(beside_the_fold(share), model="rolling").bounces[0].time for share in (1e-7, 1e-8)
    ]
    # of first order in the distance that the share makes, its square root
    assert times[1] / times[0] == pytest.approx(10**0.25, rel=0.01)


def test_beyond_a_fold_the_can_overturns_however_slowly() -> None:
    start = beside_the_fold(-1e-8)
    found = solve(start, model="rolling")
    assert found.outcome is Outcome.OVERTURNED
    assert found.t_end > 1000
    # at the fold itself nothing but round-off pulls
    assert solve(beside_the_fold(0.0), model="rolling").outcome is Outcome.STEADY


@pytest.mark.slow
def test_of_a_fall_that_no_single_ulp_but_all_of_them_decide_no_bounce_is_given() -> None:
    """Once a crash: no neighbour parts by itself, so that there is no instant up to which."""
    found = solve(beside_the_fold(1e-12))
    assert found.outcome is Outcome.UNRESOLVED
    assert found.bounces == ()
    assert np.isfinite(found.t_end)
    (finding,) = examine(found, np.array([0.0])).findings
    assert finding.kind is FindingKind.LIMIT
