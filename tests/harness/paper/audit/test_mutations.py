"""Every check reads its claim: it refuses wrong ones, and accepts the right one."""

from functools import cache

import pytest

from harness.paper.audit import CLAIMS, Claim, ClaimStatus, checks
from harness.paper.audit.claims import STANDS, WRONG
from harness.paper.audit.evidence import Evidence, OutOfReach, check_of

assert checks  # reading them registers them
EVERY = pytest.mark.parametrize("claim", CLAIMS, ids=[claim.label for claim in CLAIMS])


@cache
def right_evidence(label: str) -> Evidence:
    """Return the evidence about the claim as it should be printed."""
    return check_of(label)().as_corrected()


@pytest.mark.slow
@EVERY
def test_the_right_claim_stands(claim: Claim) -> None:
    """A claim that is wrong as printed comes with the form that the same check accepts."""
    exempt = isinstance(right_evidence(claim.label), OutOfReach)
    assert right_evidence(claim.label).ruling().status in (
        {ClaimStatus.NOT_CHECKABLE} if exempt else STANDS
    )


@pytest.mark.slow
@EVERY
def test_a_mutated_claim_is_refused(claim: Claim) -> None:
    """No claim is exempt but those that nothing in the paper decides."""
    mutations = list(right_evidence(claim.label).mutations())
    assert bool(mutations) != isinstance(right_evidence(claim.label), OutOfReach)
    for number, mutation in enumerate(mutations):
        assert mutation.ruling().status in WRONG, f"mutation {number}: {mutation}"
