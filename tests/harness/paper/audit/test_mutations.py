"""Every check reads its claim: it refuses wrong ones, and accepts the right one."""

from functools import cache

import pytest

from harness.paper.audit import CLAIMS, Claim, ClaimStatus, checks
from harness.paper.audit import flat_series as series
from harness.paper.audit.checks.frobenius import _solvable
from harness.paper.audit.claims import WRONG
from harness.paper.audit.evidence import CHECKS, Evidence, OutOfReach
from tests.harness.paper.audit.wrong_claims import WRONG_CLAIMS, right_claim, wrong_claims

assert checks.__all__  # reading them registers them
STANDS = frozenset({ClaimStatus.HOLDS, ClaimStatus.TO_ORDER})
EVERY = pytest.mark.parametrize("claim", CLAIMS, ids=[claim.label for claim in CLAIMS])


@cache
def evidence_of(label: str) -> Evidence:
    """Return the evidence about the claim as it is printed."""
    return CHECKS[label]()


def test_steps_of_a_series_are_judged_by_the_equation(monkeypatch: pytest.MonkeyPatch) -> None:
    """With h = 0 eq01:frob_ode has a solution in every other power, and none in every third."""
    second_order = series.second_order
    assert not _solvable(0, 2)
    monkeypatch.setattr(series, "second_order", lambda psi: second_order(psi).subs(series.h, 0))
    assert _solvable(0, 2)
    assert not _solvable(0, 3)


def test_every_wrong_claim_is_of_a_claim_of_the_paper() -> None:
    labels = {key if isinstance(key, str) else key[0] for key in WRONG_CLAIMS}
    assert labels <= {claim.label for claim in CLAIMS}


@pytest.mark.slow
@EVERY
def test_the_right_claim_stands(claim: Claim) -> None:
    """A claim that is wrong as printed comes with the form that the same check accepts."""
    evidence = evidence_of(claim.label)
    exempt = isinstance(evidence, OutOfReach)
    assert right_claim(evidence).ruling().status in (
        {ClaimStatus.NOT_CHECKABLE} if exempt else STANDS
    )


@pytest.mark.slow
@EVERY
def test_a_mutated_claim_is_refused(claim: Claim) -> None:
    """No claim is exempt but those that nothing in the paper decides."""
    evidence = evidence_of(claim.label)
    mutations = list(wrong_claims(claim.label, evidence))
    assert bool(mutations) != isinstance(evidence, OutOfReach)
    for number, mutation in enumerate(mutations):
        assert mutation.ruling().status in WRONG, f"mutation {number}: {mutation}"
