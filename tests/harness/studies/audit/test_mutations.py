"""Every check reads its claim: it refuses wrong ones, and accepts the right one."""

from functools import cache

import pytest

from harness.studies.audit.finding import STANDS, WRONG, Verdict
from harness.studies.audit.registry import Claim, Evidence
from harness.studies.audit.run import claims

CHECKABLE = [c for c in claims() if c.name != "numbers.outside"]
EVERY = pytest.mark.parametrize("claim", CHECKABLE, ids=[c.label for c in CHECKABLE])


@cache
def right(claim: Claim) -> Evidence:
    """Return the evidence about the claim as it should be printed."""
    return claim.check().as_corrected()


def test_only_what_is_not_checkable_is_exempt() -> None:
    exempt = [c for c in claims() if c not in CHECKABLE]
    assert {c.check().ruling().verdict for c in exempt} == {Verdict.NOT_CHECKABLE}


@pytest.mark.slow
@EVERY
def test_the_right_claim_stands(claim: Claim) -> None:
    """A claim that is wrong as printed comes with the form that the same check accepts."""
    assert right(claim).ruling().verdict in STANDS


@pytest.mark.slow
@EVERY
def test_a_mutated_claim_is_refused(claim: Claim) -> None:
    mutations = list(right(claim).mutations())
    assert mutations
    for number, mutation in enumerate(mutations):
        assert mutation.ruling().verdict in WRONG, f"mutation {number}: {mutation}"
