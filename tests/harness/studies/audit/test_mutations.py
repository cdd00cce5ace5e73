"""Every check reads its claim: it refuses wrong ones, and accepts the right one."""

from functools import cache

import pytest

from harness.paper.audit.evidence import OutOfReach
from harness.paper.audit.finding import STANDS, WRONG, ClaimStatus
from harness.paper.audit.registry import Claim, Evidence
from harness.paper.audit.run import claims

EVERY = pytest.mark.parametrize("claim", claims(), ids=[c.label for c in claims()])


@cache
def right(claim: Claim) -> Evidence:
    """Return the evidence about the claim as it should be printed."""
    return claim.check().as_corrected()


@pytest.mark.slow
@EVERY
def test_the_right_claim_stands(claim: Claim) -> None:
    """A claim that is wrong as printed comes with the form that the same check accepts."""
    exempt = isinstance(right(claim), OutOfReach)
    assert right(claim).ruling().verdict in ({ClaimStatus.NOT_CHECKABLE} if exempt else STANDS)


@pytest.mark.slow
@EVERY
def test_a_mutated_claim_is_refused(claim: Claim) -> None:
    """No claim is exempt but those that nothing in the paper decides."""
    mutations = list(right(claim).mutations())
    assert bool(mutations) != isinstance(right(claim), OutOfReach)
    for number, mutation in enumerate(mutations):
        assert mutation.ruling().verdict in WRONG, f"mutation {number}: {mutation}"
