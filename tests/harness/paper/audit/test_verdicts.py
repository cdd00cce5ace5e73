"""A verdict follows from its evidence, and from nothing else."""

from dataclasses import replace

import mpmath as mp
import pytest
import sympy as sp

from harness.paper.audit import symbols
from harness.paper.audit.claims import WRONG, AuditRow, Claim, ClaimStatus
from harness.paper.audit.evidence import (
    Both,
    Evidence,
    Fact,
    IdentityEvidence,
    Number,
    OutOfReach,
    Rate,
)
from harness.paper.audit.symbols import Co, S, disagreement, phi, tidy, vanishes
from tests.harness.paper.audit.mutated_form import MOST, mutated
from tests.harness.paper.audit.wrong_claims import right_claim, wrong_claims


def falling(power: int, x: mp.mpf) -> mp.mpf:
    """Return a remainder that falls with a power."""
    return 3 * x**power * (1 + x)


def four(printed: int, *, corrected: int | None = None, correct: str = "") -> Fact:
    """Return evidence about whether a number is four."""
    return Fact(
        printed=printed,
        holds=lambda n: n == 4,
        how="counted",
        corrected=corrected,
        correct=correct,
    )


def verdict(evidence: Evidence) -> ClaimStatus:
    return evidence.ruling().status


def test_an_identity_holds() -> None:
    printed = sp.sin(2 * phi) / (1 + sp.cos(2 * phi))
    assert (
        verdict(IdentityEvidence(printed=printed, derived=S / Co, source="tan"))
        is ClaimStatus.HOLDS
    )


@pytest.mark.parametrize(
    ("right", "expected"),
    [("a - b", ClaimStatus.MISPRINT), ("c - b", ClaimStatus.FALSE), ("", ClaimStatus.FALSE)],
)
def test_what_is_false_is_a_misprint_if_one_symbol_mends_it(
    right: str, expected: ClaimStatus
) -> None:
    ruling = IdentityEvidence(
        printed=sp.cos(2 * phi) + 2 * S**2 + 1,
        corrected=sp.cos(2 * phi) + 2 * S**2,
        derived=sp.Integer(1),
        source="double angles",
    ).ruling()
    fields = {"label": "eq", "section": "2", "place": "(2.1)", "says": "a sum", "printed": "a + b"}
    claim = Claim(**fields, right=right, remark="without the 1")
    row = AuditRow(claim=claim, ruling=ruling, check="toy.sum", seconds=0.0)
    assert ruling.status is ClaimStatus.FALSE
    assert row.status is expected
    assert row.correct == f"`{right}`; without the 1" if right else "without the 1"


def test_what_no_form_mends_is_inconsistent() -> None:
    wrong = IdentityEvidence(printed=S, corrected=2 * S, derived=Co, source="nothing")
    assert verdict(wrong) is ClaimStatus.INCONSISTENT


def test_evidence_that_contradicts_itself_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A numerical zero that is not a symbolic one must never become a verdict."""
    monkeypatch.setattr("harness.paper.audit.evidence.vanishes", lambda _: False)
    with pytest.raises(ArithmeticError, match="disagree"):
        IdentityEvidence(printed=S, derived=S, source="a lie").ruling()


@pytest.mark.parametrize(
    ("power", "expected"),
    [(2, ClaimStatus.TO_ORDER), (3, ClaimStatus.TO_ORDER), (1, ClaimStatus.INCONSISTENT)],
)
def test_a_remainder_is_judged_by_its_rate(power: int, expected: ClaimStatus) -> None:
    rate = Rate(printed=power, remainder=falling, stated=2, at=(1e-5, 1e-8), source="a toy")
    assert verdict(rate) is expected


def test_a_logarithm_does_not_spoil_a_rate() -> None:
    rate = Rate(
        printed=1,
        remainder=lambda n, x: x**n * mp.log(x),
        stated=1,
        at=(1e-9, 1e-12),
        source="a toy",
    )
    assert verdict(rate) is ClaimStatus.TO_ORDER


def test_a_form_that_its_remainder_refuses_is_false() -> None:
    rate = Rate(
        printed=1,
        remainder=falling,
        corrected=2,
        stated=2,
        at=(1e-5, 1e-8),
        source="a toy",
        correct="the square",
    )
    assert verdict(rate) is ClaimStatus.FALSE
    right = right_claim(rate)
    assert isinstance(right, Rate)
    assert verdict(right) is ClaimStatus.TO_ORDER
    assert verdict(replace(right, stated=3)) in WRONG


def test_a_remainder_may_be_put_right_by_another_power() -> None:
    rate = Rate(
        printed=1, remainder=falling, corrected_to=1, stated=2, at=(1e-5, 1e-8), source="a toy"
    )
    assert verdict(rate) is ClaimStatus.FALSE
    right = right_claim(rate)
    assert isinstance(right, Rate)
    assert right.stated == 1


@pytest.mark.parametrize(
    ("printed", "value", "expected"),
    [
        ("209", 208.77, ClaimStatus.HOLDS),
        ("209", 208.49, ClaimStatus.INCONSISTENT),
        ("1.43e-10", 1.434e-10, ClaimStatus.HOLDS),
        ("1.43e-10", 1.436e-10, ClaimStatus.INCONSISTENT),
        ("0.40", 0.404, ClaimStatus.HOLDS),
        ("0.40", 0.41, ClaimStatus.INCONSISTENT),
    ],
)
def test_a_number_holds_if_the_value_rounds_to_it(
    printed: str, value: float, expected: ClaimStatus
) -> None:
    assert verdict(Number(printed=printed, value=value, source="a toy")) is expected


def test_rounded_inputs_widen_a_number() -> None:
    assert verdict(Number(printed="2.897", value=2.8960, source="a")) is ClaimStatus.INCONSISTENT
    wide = Number(printed="2.897", value=2.8960, low=2.8950, high=2.8970, source="a")
    assert verdict(wide) is ClaimStatus.HOLDS


def test_the_gravest_part_decides() -> None:
    good, bad = four(4), four(5, correct="this")
    false = four(3, correct="that", corrected=4)
    assert verdict(Both(good, good)) is ClaimStatus.HOLDS
    assert verdict(Both(good, bad)) is ClaimStatus.INCONSISTENT
    assert verdict(Both(good, false)) is ClaimStatus.FALSE
    assert verdict(Both(bad, false)) is ClaimStatus.FALSE
    assert Both(bad, false).ruling().correct == "this; that"
    assert verdict(right_claim(Both(good, false))) is ClaimStatus.HOLDS


def test_a_statement_is_mutated_part_by_part() -> None:
    parts = four(5, corrected=4), Both(four(3, corrected=4), four(4))
    mutations = list(wrong_claims("toy", Both(*parts)))
    assert [verdict(x) for x in mutations] == [ClaimStatus.FALSE] * 2


@pytest.mark.parametrize("printed", ["209", "1.43e-10", "0.40", "4.3e-2"])
def test_a_number_is_mutated_in_its_last_digit(printed: str) -> None:
    number = Number(printed=printed, value=mp.mpf(printed), source="a toy")
    assert right_claim(number) == number
    mutations = list(wrong_claims("toy", number))
    assert [verdict(x) for x in mutations] == [ClaimStatus.INCONSISTENT] * 2


def test_mutations_of_a_form_are_other_forms() -> None:
    form = sp.Matrix([S**2 + 3 * Co, sp.Integer(0)])
    found = mutated(form)
    assert 3 <= len(found) <= MOST
    assert all(disagreement(x, form) > mp.mpf("1e-3") for x in found)


def test_a_mutation_that_says_the_same_is_none() -> None:
    # the square of m in both places of a quotient cancels
    assert all(sp.simplify(x - phi) != 0 for x in mutated((phi**2 + phi) / (1 + phi)))


def test_what_is_out_of_reach_says_why() -> None:
    ruling = OutOfReach(reason="an experiment").ruling()
    assert (ruling.status, ruling.how) == (ClaimStatus.NOT_CHECKABLE, "an experiment")


def test_zero_is_told_from_small() -> None:
    nearly = S**2 + Co**2 - 1 + sp.Rational(1, 10**20) * symbols.a
    assert vanishes(S**2 + Co**2 - 1)
    assert not vanishes(nearly)
    # symbols are at most 0.95 and the scale at least 1e-3
    assert 0 < disagreement(nearly, sp.Integer(0)) < mp.mpf("1e-16")


def test_tidy_writes_squares_of_sines_as_cosines() -> None:
    assert tidy(S**4) == sp.expand((1 - Co**2) ** 2)
