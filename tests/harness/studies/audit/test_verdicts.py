"""A verdict follows from its evidence, and from nothing else."""

import mpmath as mp
import pytest
import sympy as sp

from harness.studies.audit import symbols
from harness.studies.audit.evidence import Both, Fact, Identity, Number, OutOfReach, Rate
from harness.studies.audit.finding import Verdict
from harness.studies.audit.symbols import Co, S, disagreement, phi, tidy, vanishes


def verdict(evidence: Identity | Rate | Number | Fact | Both | OutOfReach) -> Verdict:
    return evidence.ruling().verdict


def test_an_identity_holds() -> None:
    printed = sp.sin(2 * phi) / (1 + sp.cos(2 * phi))
    assert verdict(Identity(printed=printed, derived=S / Co, source="tan")) is Verdict.HOLDS


def test_a_mended_sign_is_a_misprint() -> None:
    ruling = Identity(
        printed=sp.cos(2 * phi) + 2 * S**2 + 1,
        corrected=sp.cos(2 * phi) + 2 * S**2,
        derived=sp.Integer(1),
        source="double angles",
        correct="without the 1",
    ).ruling()
    assert ruling.verdict is Verdict.MISPRINT
    assert ruling.correct == "without the 1"


def test_what_no_form_mends_is_inconsistent() -> None:
    wrong = Identity(printed=S, corrected=2 * S, derived=Co, source="nothing")
    assert verdict(wrong) is Verdict.INCONSISTENT


def test_evidence_that_contradicts_itself_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A symbolic zero that is not a numerical one must never become a verdict."""
    monkeypatch.setattr("harness.studies.audit.evidence.vanishes", lambda _: True)
    with pytest.raises(ArithmeticError, match="disagree"):
        Identity(printed=S, derived=Co, source="a lie").ruling()


@pytest.mark.parametrize(
    ("power", "expected"), [(2, Verdict.TO_ORDER), (3, Verdict.TO_ORDER), (1, Verdict.INCONSISTENT)]
)
def test_a_remainder_is_judged_by_its_rate(power: int, expected: Verdict) -> None:
    rate = Rate(
        remainder=lambda x: 3 * x**power * (1 + x), stated=2, at=(1e-5, 1e-8), source="a toy"
    )
    assert verdict(rate) is expected


def test_a_logarithm_does_not_spoil_a_rate() -> None:
    rate = Rate(remainder=lambda x: x * mp.log(x), stated=1, at=(1e-9, 1e-12), source="a toy")
    assert verdict(rate) is Verdict.TO_ORDER


def test_a_mended_remainder_is_a_misprint() -> None:
    rate = Rate(
        remainder=lambda x: x,
        corrected=lambda x: x**2,
        stated=2,
        at=(1e-5, 1e-8),
        source="a toy",
        correct="the square",
    )
    assert verdict(rate) is Verdict.MISPRINT


@pytest.mark.parametrize(
    ("printed", "value", "expected"),
    [
        ("209", 208.77, Verdict.HOLDS),
        ("209", 208.49, Verdict.INCONSISTENT),
        ("1.43e-10", 1.434e-10, Verdict.HOLDS),
        ("1.43e-10", 1.436e-10, Verdict.INCONSISTENT),
        ("0.40", 0.404, Verdict.HOLDS),
        ("0.40", 0.41, Verdict.INCONSISTENT),
    ],
)
def test_a_number_holds_if_the_value_rounds_to_it(
    printed: str, value: float, expected: Verdict
) -> None:
    assert verdict(Number(printed=printed, value=value, source="a toy")) is expected


def test_rounded_inputs_widen_a_number() -> None:
    assert verdict(Number(printed="2.897", value=2.8960, source="a")) is Verdict.INCONSISTENT
    wide = Number(printed="2.897", value=2.8960, low=2.8950, high=2.8970, source="a")
    assert verdict(wide) is Verdict.HOLDS


def test_the_gravest_part_decides() -> None:
    good, bad = Fact(true=True, how="seen"), Fact(true=False, how="not seen", correct="this")
    mended = Fact(true=False, how="mended", correct="that", mended=True)
    assert verdict(Both(parts=(good, good))) is Verdict.HOLDS
    assert verdict(Both(parts=(good, bad))) is Verdict.INCONSISTENT
    assert verdict(Both(parts=(good, mended))) is Verdict.MISPRINT
    assert Both(parts=(bad, mended)).ruling().correct == "this; that"


def test_what_is_out_of_reach_says_why() -> None:
    ruling = OutOfReach(reason="an experiment").ruling()
    assert (ruling.verdict, ruling.how) == (Verdict.NOT_CHECKABLE, "an experiment")


def test_zero_is_told_from_small() -> None:
    nearly = S**2 + Co**2 - 1 + sp.Rational(1, 10**20) * symbols.a
    assert vanishes(S**2 + Co**2 - 1)
    assert not vanishes(nearly)
    # symbols are at most 0.95 and the scale at least 1e-3
    assert 0 < disagreement(nearly, sp.Integer(0)) < mp.mpf("1e-16")


def test_tidy_writes_squares_of_sines_as_cosines() -> None:
    assert tidy(S**4) == sp.expand((1 - Co**2) ** 2)
