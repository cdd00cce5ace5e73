"""The rule: beyond the tolerance and beyond a factor, the same whichever of the two comes first."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.verdict import Status
from harness.gate.comparison import FACTOR, OUTCOME, differences, judge
from harness.results.scores import QUANTITIES
from tests.support.gate_scores import make_score, make_scores

PHI = "phi_rms_rad"
MAGNITUDES = st.floats(0.0, 1e6)


@pytest.mark.parametrize(
    ("numbers", "change", "tolerance"),
    [
        ((1.0, 1.0, 0.0), Status.SAME, 1e-12),
        ((1.0, 2.0, 0.0), Status.WORSE, 1e-12),
        ((2.0, 1.0, 0.0), Status.BETTER, 1e-12),
        # a tenth more: beyond the tolerance, and on either side of the factor
        ((1.0, 1.099, 0.0), Status.SAME, 1e-12),
        ((1.0, 1.101, 0.0), Status.WORSE, 1e-12),
        ((1.101, 1.0, 0.0), Status.BETTER, 1e-12),
        # beyond the factor, and on either side of four spreads
        ((1.0, 1.399, 0.1), Status.SAME, 0.4 + 1e-12),
        ((1.0, 1.401, 0.1), Status.WORSE, 0.4 + 1e-12),
        ((1.401, 1.0, 0.1), Status.BETTER, 0.4 + 1e-12),
        ((0.0, 1e-14, 0.0), Status.SAME, 1e-12),  # of zero infinitely more, and nothing
        ((0.0, 1e-6, 0.0), Status.WORSE, 1e-12),
        ((1e-15, 5e-13, 0.0), Status.SAME, 1e-12),
        ((1.0, 100.0, None), Status.UNDECIDABLE, None),
        ((None, 1.0, 0.0), Status.NEW, 1e-12),
        ((1.0, None, 0.0), Status.MISSING, 1e-12),
    ],
)
def test_beyond_four_spreads_and_a_tenth_more_is_a_change(
    numbers: tuple[float | None, ...],
    change: Status,
    tolerance: float | None,
) -> None:
    accepted, found, spread = numbers
    first = make_score({} if accepted is None else {PHI: accepted}, spread={PHI: spread})
    second = make_score({} if found is None else {PHI: found})
    _, quantity = differences(make_scores(first), make_scores(second))
    assert (quantity.quantity, quantity.status) == (PHI, change)
    assert (quantity.first, quantity.second, quantity.spread) == (accepted, found, spread)
    assert quantity.tolerance == tolerance


@given(MAGNITUDES, MAGNITUDES, MAGNITUDES)
def test_the_rule_is_the_same_from_both_sides(a: float, b: float, tolerance: float) -> None:
    mirrored = {Status.WORSE: Status.BETTER, Status.BETTER: Status.WORSE}
    there, back = judge(a, b, tolerance)[0], judge(b, a, tolerance)[0]
    assert back is mirrored.get(there, there)


@given(MAGNITUDES, MAGNITUDES, st.floats(-1.0, 1.0))
def test_nothing_within_its_tolerance_has_changed(a: float, tolerance: float, share: float) -> None:
    assert judge(a, max(0.0, a + share * tolerance), tolerance)[0] is Status.SAME


@given(MAGNITUDES, st.floats(1.0 / FACTOR + 1e-9, FACTOR - 1e-9))
def test_nothing_within_the_factor_has_changed(a: float, factor: float) -> None:
    assert judge(a, factor * a, 0.0)[0] is Status.SAME


def test_signs_do_not_count() -> None:
    turn = "angle_of_turn_error_deg"
    _, found = differences(
        make_scores(make_score({turn: -2.0})), make_scores(make_score({turn: 2.0}))
    )
    assert (found.first, found.second, found.status) == (2.0, 2.0, Status.SAME)


@pytest.mark.parametrize(
    ("outcomes", "endings", "change"),
    [
        (("FINISHED", "FINISHED"), {"FINISHED": 5}, Status.SAME),
        (("FINISHED", "FLAT"), {"FINISHED": 5}, Status.WORSE),
        (("FLAT", "FINISHED"), {"FLAT": 5}, Status.BETTER),
        (("FLAT", "OVERTURNED"), {"FLAT": 5}, Status.NOT_JUDGED),
        (("FINISHED", "FLAT"), {"FINISHED": 4, "OVERTURNED": 1}, Status.UNDECIDABLE),
    ],
)
def test_a_run_that_no_longer_finishes_is_worse(
    outcomes: tuple[str, str],
    endings: dict[str, int],
    change: Status,
) -> None:
    first, second = outcomes
    values = {PHI: 1.0}
    accepted = make_scores(make_score(values, outcome=first, endings=endings))
    found = differences(accepted, make_scores(make_score({PHI: 9.0}, outcome=second)))
    assert found[0].quantity == OUTCOME
    assert found[0].status is change
    # numbers of a run that ended early are those of another length
    assert len(found) == (2 if (first, second) == ("FINISHED", "FINISHED") else 1)


def test_what_is_missing_and_what_is_new() -> None:
    old, new = make_score({PHI: 1.0}, scene="petals"), make_score({PHI: 1.0}, scene="wobble")
    both = make_score({PHI: 1.0})
    found = differences(make_scores(both, old), make_scores(both, new))
    assert {one.identity.scene: one.status for one in found if one.quantity == OUTCOME} == {
        "gentle-rock": Status.SAME,
        "petals": Status.MISSING,
        "wobble": Status.NEW,
    }
    owed = differences(make_scores(both, old), make_scores(both), expected=[both.identity])
    assert all(one.status is Status.SAME for one in owed)


def test_times_and_errors_where_the_plane_would_pull_are_not_judged() -> None:
    first = make_score({PHI: 1.0, "max_slip_m_s": 1.0, "wall_s": 1.0}, truth_pulls=True)
    second = make_score({PHI: 9.0, "max_slip_m_s": 9.0, "wall_s": 9.0}, truth_pulls=True)
    found = {
        one.quantity: one.status for one in differences(make_scores(first), make_scores(second))
    }
    assert found[PHI] is Status.NOT_JUDGED
    assert found["wall_s"] is Status.NOT_JUDGED
    assert found["max_slip_m_s"] is Status.WORSE


def test_two_motions_are_not_compared() -> None:
    first, second = make_score({PHI: 1.0}), make_score({PHI: 9.0})
    another = make_scores(second, inputs={"gentle-rock": "a" * 16})
    (found,) = differences(make_scores(first), another)
    assert found.status is Status.NOT_JUDGED
    assert "scene has changed" in found.note


def test_a_spread_can_be_borrowed() -> None:
    first, second = make_scores(make_score({PHI: 1.0})), make_scores(make_score({PHI: 2.0}))
    lender = make_scores(make_score({PHI: 1.0}, spread={PHI: 1.0}))
    assert differences(first, second)[1].status is Status.WORSE
    assert differences(first, second, spreads=lender)[1].status is Status.SAME


def test_every_floor_is_far_below_what_is_judged() -> None:
    # a thousandth of what a fine run still errs by: 2e-6 rad, 2e-4 degrees, 1e-7 m of locus
    largest = {"rad": 1e-9, "deg": 1e-7, "m": 1e-9, "s": 1e-9, "m/s": 1e-8}
    for quantity in QUANTITIES:
        assert quantity.floor <= largest.get(quantity.unit, 16.0), quantity
