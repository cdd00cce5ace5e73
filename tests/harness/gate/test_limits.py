"""Numbers that prose cites of the gate, just inside and just outside each.

They are written out here as CONTRIBUTING and the docstrings have them, and not imported: whoever
changes one in the code is told which sentence no longer holds.
"""

import math
from dataclasses import replace

import pytest

from harness.core.case import Case
from harness.core.verdict import Status
from harness.gate.baseline import required_cases, write_baseline
from harness.gate.comparison import Difference, differences, judge
from harness.gate.errors import ChangedScenesError, OtherSuiteError
from harness.gate.report import GATE, sentences
from harness.gate.spread import member, members
from harness.metrics.quantities import Number
from harness.results.files import read_baseline
from harness.results.result import Result
from harness.results.scores import CaseIdentity, identity, scene_digest, score_of_row
from models import Scene, load
from tests.support.gate_scores import make_score, make_scores, scores_of

PHI = "phi_rms_rad"


@pytest.mark.parametrize(
    ("found", "change"),
    [
        (1.9999, Status.SAME),
        (2.0001, Status.WORSE),
        (0.0001, Status.SAME),
    ],
)
def test_a_tolerance_is_four_spreads(
    found: float,
    change: Status,
) -> None:
    accepted = make_scores(make_score({PHI: 1.0}, spread={PHI: 0.25}))
    _, quantity = differences(accepted, make_scores(make_score({PHI: found})))
    assert quantity.status is change
    assert quantity.tolerance == pytest.approx(1.0, abs=2e-12)  # and what round-off makes


@pytest.mark.parametrize(("found", "change"), [(1.0999, Status.SAME), (1.1001, Status.WORSE)])
def test_a_tenth_more_is_worse_and_less_is_not(found: float, change: Status) -> None:
    assert judge(1.0, found, 0.0)[0] is change


@pytest.mark.parametrize(("found", "change"), [(0.9092, Status.SAME), (0.9090, Status.BETTER)])
def test_better_is_the_same_rule_mirrored(found: float, change: Status) -> None:
    assert judge(1.0, found, 0.0)[0] is change  # 1/1.1 is 0.90909


def test_both_limits_must_be_exceeded_not_met() -> None:
    assert judge(1.0, 1.5, 0.5)[0] is Status.SAME
    assert judge(0.0, 0.0, 0.0)[0] is Status.SAME
    assert judge(1.0, 1.1, 0.0)[0] is Status.SAME


@pytest.mark.parametrize(
    ("first", "second", "factor", "severity"),
    [
        (1.0, 2.0, 2.0, 2.0),
        (2.0, 1.0, 0.5, 2.0),
        (1.0, 1.0, 1.0, 1.0),
        (2.0, 0.0, 0.0, math.inf),
        (0.0, 2.0, math.inf, math.inf),
        (0.0, 0.0, 1.0, 1.0),
        (None, 1.0, None, math.inf),
        (1.0, None, None, math.inf),
    ],
)
def test_a_factor_is_second_over_first_and_a_severity_the_larger_over_the_smaller(
    first: Number, second: Number, factor: Number, severity: float
) -> None:
    found = Difference(
        identity=make_score().identity, quantity=PHI, first=first, second=second, status=Status.SAME
    )
    assert (found.factor, found.severity) == (factor, severity)


@pytest.mark.parametrize("pulled", [(True, False), (False, True)])
def test_an_error_is_not_judged_where_either_exact_motion_pulls(
    pulled: tuple[bool, bool],
) -> None:
    first, second = (
        make_scores(make_score({PHI: value}, truth_pulls=one))
        for value, one in zip((1.0, 9.0), pulled, strict=True)
    )
    assert differences(first, second)[1].status is Status.NOT_JUDGED


def test_of_two_spreads_the_larger_counts() -> None:
    first, second = (
        make_scores(make_score({PHI: 1.0}, spread={PHI: 0.5})),
        make_scores(make_score({PHI: 2.0})),
    )
    lender = make_scores(make_score({PHI: 1.0}, spread={PHI: 0.1}))
    assert differences(first, second, spreads=lender)[1].spread == 0.5


def test_a_case_without_a_timestep_has_its_own(gentle: Scene) -> None:
    own = identity(Case(scene=gentle, engine="mujoco"))
    assert own.timestep == 0.0
    assert own == CaseIdentity(scene=gentle.name, engine="mujoco", profile="matched")
    assert own.label() == "gentle-rock in mujoco (matched, its own timestep)"
    fixed = identity(Case(scene=gentle, engine="mujoco", timestep=1.0))
    assert fixed.label() == "gentle-rock in mujoco (matched, 1 s)"


def test_a_motion_is_named_by_16_digits_that_heed_no_name_and_no_order(gentle: Scene) -> None:
    name = scene_digest(gentle)
    assert len(name) == 16
    assert int(name, 16) >= 0
    assert scene_digest(replace(gentle, name="another")) == name
    assert scene_digest(replace(gentle, gravity=9.8)) != name


@pytest.mark.parametrize(
    ("column", "floor"),
    [
        ("angle_of_turn_error_deg", 1e-10),
        ("bounce_time_error_s", 1e-13),
        ("peak_friction_ratio_error", 1e-10),
        ("phi_rms_rad", 1e-12),
        ("phi_max_rad", 1e-12),
        ("psi_rms_rad", 1e-11),
        ("theta_rms_rad", 1e-11),
        ("rotation_rms_rad", 1e-11),
        ("contact_locus_rms_m", 1e-13),
        ("contact_locus_hausdorff_m", 1e-13),
        ("energy_drift", 1e-12),
        ("max_penetration_m", 1e-9),
        ("max_slip_m_s", 1e-9),
        ("lift_off_fraction", 1e-4),
        ("multi_contact_fraction", 1e-4),
        ("steps", 1.0),
        ("constraint_rows", 16.0),
    ],
)
def test_below_its_floor_nothing_counts_as_a_change(
    column: str,
    floor: float,
) -> None:
    accepted = make_scores(make_score({column: 0.0}))
    for found, change in ((0.99 * floor, Status.SAME), (1.01 * floor, Status.WORSE)):
        _, quantity = differences(accepted, make_scores(make_score({column: found})))
        assert quantity.status is change


@pytest.mark.parametrize(
    ("steps", "count"),
    [
        (16_666, 12),
        (16_667, 11),
        (40_000, 5),
        (40_001, 4),
        (200_000, 4),
        (10_000_000, 4),
        (1, 12),
    ],
)
def test_a_case_runs_again_4_to_12_times_within_200_000_steps(steps: int, count: int) -> None:
    assert members(steps) == count


def test_members_differ_by_1e_13_to_1e_9() -> None:
    case = Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3)
    assert case.scene.release.psi == 0.0
    first = [member(case, number).scene.release.psi for number in range(5)]
    assert sorted(first) == [1e-13, 1e-12, 1e-11, 1e-10, 1e-9]  # one of each before any comes again
    assert first[:2] == [1e-9, 1e-13]  # the fewest, four, hold both ends
    assert member(case, 5).scene.release.psi == 1e-9


def known(cases: list[Case]) -> Result:
    return make_scores(*scores_of(cases))


def test_a_suite_may_have_grown_by_a_quarter() -> None:
    case = Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3)
    cases = [replace(case, timestep=1e-3 / number) for number in range(1, 27)]
    # five new ones beside twenty: grown, so that what is asked next is whether scenes changed
    with pytest.raises(ChangedScenesError):
        required_cases(known(cases[:20]), "quick", cases[:25], every_engine=True)
    with pytest.raises(OtherSuiteError) as caught:
        required_cases(known(cases[:20]), "quick", cases, every_engine=True)
    assert (caught.value.common, caught.value.cases) == (20, 26)


@pytest.mark.parametrize(("count", "words"), [(12, "s-12 in"), (13, "and 1 more, in the table")])
def test_twelve_cases_are_named(
    count: int,
    words: str,
) -> None:
    names = [f"s-{number:02d}" for number in range(1, count + 1)]
    first = make_scores(*(make_score({PHI: 1.0}, scene=name) for name in names))
    second = make_scores(*(make_score({PHI: 2.0}, scene=name) for name in names))
    text = " ".join(sentences(differences(first, second), first, second, GATE))
    assert words in text
    assert ("more, in the table" in text) is (count > 12)
    assert "s-13" not in text


@pytest.mark.parametrize(
    ("spread", "kept"),
    [(1.2341e-7, 1.24e-7), (1.23e-7, 1.23e-7), (9.991e-3, 1e-2), (5e-324, 1e-300), (0.0, 0.0)],
)
def test_a_spread_is_kept_in_three_digits_rounded_up(
    spread: float, kept: float, tmp_path: object
) -> None:
    write_baseline(make_scores(make_score({PHI: 1.0}, spread={PHI: spread})), tmp_path)  # type: ignore[arg-type]
    (found,) = read_baseline(tmp_path).scores.values()  # type: ignore[arg-type]
    assert found.spread[PHI] == kept


@pytest.mark.parametrize(("resolved", "turn"), [(True, True), (False, False), (None, False)])
def test_a_score_holds_the_numbers_that_are_known(resolved: object, turn: object) -> None:
    row = {
        "truth_pulls": True,
        "digest": "abc0" * 4,
        "turn_resolved": resolved,
        "angle_of_turn_error_deg": 2.0,
        "phi_rms_rad": math.nan,
        "max_slip_m_s": math.inf,
        "energy_drift": None,
        "steps": 5,
        "not a quantity": 1.0,
    }
    name = CaseIdentity(scene="s", engine="e", profile="matched")
    found = score_of_row(row, identity=name, outcome="FLAT")
    expected = {"steps": 5.0} | ({"angle_of_turn_error_deg": 2.0} if turn else {})
    assert dict(found.values) == expected
    assert (found.truth_pulls, found.digest, found.members) == (True, "abc0" * 4, 0)


@pytest.mark.parametrize(
    ("outcome", "endings", "finish", "fail"),
    [
        ("FINISHED", {}, True, False),
        ("FLAT", {}, False, True),
        ("FINISHED", {"FINISHED": 5}, True, False),
        ("FINISHED", {"FLAT": 1}, True, True),
        ("FLAT", {"FINISHED": 1}, True, True),
    ],
)
def test_a_run_may_finish_or_fail_where_one_member_does(
    outcome: str, endings: dict[str, int], *, finish: bool, fail: bool
) -> None:
    found = make_score(outcome=outcome, endings=endings)
    assert (found.may_finish, found.may_fail) == (finish, fail)
