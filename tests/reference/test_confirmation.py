"""The default answer needs two methods: a closed motion that is wrong is caught by the other."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import reference.analysis.confirmation
import reference.integrable.exact_motion
from reference import PAPER_CAN, FindingKind, Outcome, Parameters, Problem, examine, solve
from reference.analysis.agreement import Agreement
from reference.analysis.conditioning import EPS, neighbours
from reference.equations.steady_motion import steady_rotation
from reference.integrable.effective_potential import EffectivePotential
from reference.integrable.exact_motion import until_horizon
from reference.integrable.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.smooth.extrema import Run
from tests.support.examples import examples

HARD = json.loads((Path(__file__).parent / "golden" / "hard.json").read_text())
GENTLE = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.12, theta_dot=-0.06, bounces=1)
TWO_WELLS = Problem(
    parameters=Parameters(a=0.2919, c=0.3791, h=0.5575),
    phi=1.5026354274572624,
    psi_dot=-0.39236159644870505,
    theta_dot=-1.0199477967008015,
    bounces=1,
)
Forced = Callable[[Callable[[TurningPoints], TurningPoints]], None]


@pytest.fixture
def forced(monkeypatch: pytest.MonkeyPatch) -> Forced:
    """Make the closed solution take other turning points."""

    def force(change: Callable[[TurningPoints], TurningPoints]) -> None:
        def wrong(well: EffectivePotential, **options: bool) -> TurningPoints:
            return change(turning_points(well, **options))

        monkeypatch.setattr(reference.integrable.exact_motion, "turning_points", wrong)

    return force


def lower(points: TurningPoints, by: float) -> TurningPoints:
    low = points.low * (1 - by)
    fall = points.fall + by * points.low
    return replace(points, low=low, fall=fall, swing=points.high - low)


def ended(outcome: Outcome) -> Callable[[TurningPoints], TurningPoints]:
    code = np.array([OUTCOMES.index(outcome)], dtype=np.int8)
    return lambda points: replace(points, code=code)


def test_two_methods_agree_and_the_answer_is_the_closed_one() -> None:
    found, closed = solve(GENTLE), solve(GENTLE, model="exact")
    assert found.agreement is not None
    assert found.agreement.holds
    assert found.agreement.resolved
    assert found.agreement.sentence == found.caveat == ""
    assert 0 < found.agreement.evaluations < 100
    assert (found.model, found.method, found.bounces) == ("exact", "quadrature", closed.bounces)
    assert found.evaluations == closed.evaluations
    assert closed.agreement is None


@pytest.mark.parametrize("by", [1e-11, 1e-6, 0.3])
@pytest.mark.parametrize("bounces", [1, 20])
def test_a_wrong_turning_point_is_found_out(forced: Forced, by: float, bounces: int) -> None:
    """However little it is off, beyond round-off: the energy there is not that of the release."""
    problem = replace(GENTLE, bounces=bounces)
    forced(lambda points: lower(points, by))
    assert solve(problem, model="exact").model == "rolling"
    found = solve(problem)
    integrated = solve(problem, model="rolling")
    assert found.agreement is not None
    assert (found.model, found.bounces) == ("rolling", integrated.bounces)
    # the closed motion gives up, and the integrals of a period confirm the integration
    assert found.agreement.holds
    assert found.agreement.discrepancy < 1e-10


@pytest.mark.parametrize("by", [1e-11, 1e-6, 0.01])
@pytest.mark.parametrize("bounces", [1, 20])
def test_a_wrong_potential_is_caught(
    monkeypatch: pytest.MonkeyPatch, by: float, bounces: int
) -> None:
    """The motion of another can is no less smooth: only another method tells."""

    def wrong(well: EffectivePotential, **options: bool) -> TurningPoints:
        return turning_points(replace(well, short=well.short * (1 + by)), **options)

    monkeypatch.setattr(reference.integrable.exact_motion, "turning_points", wrong)
    problem = replace(GENTLE, bounces=bounces)
    assert solve(problem, model="exact").model == "exact"
    found = solve(problem)
    integrated = solve(problem, model="rolling")
    assert found.agreement is not None
    assert (found.model, found.bounces) == ("rolling", integrated.bounces)
    assert not found.agreement.holds
    assert found.agreement.discrepancy >= 0.1 * by
    (finding,) = examine(found, np.linspace(0.0, found.t_end, 50)).findings
    assert finding.kind is FindingKind.DISAGREEMENT
    assert finding.sentence == found.agreement.sentence


def test_methods_that_part_where_an_ulp_decides_give_no_bounce() -> None:
    """Neither is trusted then, whatever round-off allows."""
    apart: dict[str, Any] = {"quantity": "period", "discrepancy": 1e-2, "evaluations": 0}
    assert Agreement(**apart, allowed=1e-3, ulp=1e-6).resolved
    assert not Agreement(**apart, allowed=1e-3, ulp=2e-3).resolved
    assert not Agreement(**apart, allowed=1e-1, ulp=1e-6).resolved
    few: dict[str, Any] = {"quantity": "period", "discrepancy": 1e-6, "evaluations": 0}
    assert Agreement(**few, allowed=1e-5, ulp=1e-6).resolved
    assert not Agreement(**few, allowed=1e-5, ulp=2e-3).resolved
    assert not Agreement(**few, allowed=1e-7, ulp=2e-3).resolved


@pytest.mark.parametrize("period", [1e-150, 1e150, np.nan])
def test_a_closed_motion_without_measure_is_caught_before_it_is_followed(
    monkeypatch: pytest.MonkeyPatch, period: float
) -> None:
    """A period of next to nothing has more extrema up to the horizon than there is memory."""
    own = reference.integrable.exact_motion.harmonics_of

    def scaled(values: np.ndarray) -> reference.integrable.exact_motion.Harmonics:
        found = own(values)
        return replace(found, slope=found.slope * period, waves=found.waves * period)

    def followed(problem: Problem, path: reference.integrable.exact_motion.ExactPath) -> Run:
        assert problem.duration is None  # a bounce is compared; it goes no further
        return until_horizon(problem, path)

    monkeypatch.setattr(reference.integrable.exact_motion, "harmonics_of", scaled)
    monkeypatch.setattr(reference.analysis.confirmation, "until_horizon", followed)
    found = solve(replace(GENTLE, bounces=None, duration=5.0))
    assert found.model == "rolling"
    assert found.t_end == 5.0
    assert found.agreement is not None
    assert not found.agreement.holds


def test_integrals_of_a_period_confirm_where_the_closed_motion_gives_up(forced: Forced) -> None:
    forced(ended(Outcome.UNRESOLVED))
    found = solve(replace(GENTLE, bounces=2))
    assert (found.model, len(found.bounces)) == ("rolling", 2)
    assert found.agreement is not None
    assert found.agreement.holds
    assert 0 < found.agreement.discrepancy < 1e-10


@pytest.mark.parametrize("outcome", [Outcome.OVERTURNED, Outcome.STEADY])
@pytest.mark.parametrize("horizon", [{"bounces": 2}, {"bounces": None, "duration": 6.0}])
def test_a_bounce_that_the_closed_solution_denies_is_found(
    forced: Forced, outcome: Outcome, horizon: dict[str, Any]
) -> None:
    forced(ended(outcome))
    found = solve(replace(GENTLE, **horizon))
    assert found.agreement is not None
    assert not found.agreement.holds
    assert math.isinf(found.agreement.discrepancy)
    assert found.bounces


def test_a_bounce_that_only_the_closed_solution_finds_is_denied(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    over = Problem(parameters=PAPER_CAN, phi=0.8, psi_dot=0.1, theta_dot=0.1, bounces=1)
    ahead = solve(over)
    assert ahead.outcome is Outcome.OVERTURNED
    assert ahead.agreement is not None
    assert ahead.agreement.holds
    path = reference.integrable.exact_motion.exact_path(GENTLE, locus=False)
    monkeypatch.setattr(reference.analysis.confirmation, "exact_path", lambda *_, **__: path)
    found = solve(over)
    assert found.outcome is Outcome.OVERTURNED
    assert found.bounces == ()
    assert found.agreement is not None
    assert not found.agreement.holds


@pytest.mark.slow
def test_beside_a_separatrix_there_is_no_bounce() -> None:
    """The release rests where its two neighbours among the doubles end otherwise.

    Between a release that overturns and one that comes back lies one double after which the other
    begins: found by bisection down to the last bit.
    """
    can = TWO_WELLS.parameters
    back, over = 0.0, 3.0

    def thrown(speed: float) -> Problem:
        return Problem(
            parameters=can, phi=0.9, phi_dot=speed, psi_dot=0.05, theta_dot=0.02, bounces=1
        )

    while (middle := (back + over) / 2) not in {back, over}:
        comes_back = solve(thrown(middle), model="rolling").outcome is Outcome.FINISHED
        back, over = (middle, over) if comes_back else (back, middle)
    found = solve(thrown(back))
    assert found.outcome is Outcome.UNRESOLVED
    assert found.bounces == ()
    # up to the top, where it almost stops, the motion is known
    assert 10.0 < found.t_end < 60.0
    assert 0.9 < found.at(np.array([found.t_end])).phi[0] < np.pi / 2
    (finding,) = examine(found, np.linspace(0.0, found.t_end, 50)).findings
    assert finding.kind is FindingKind.LIMIT
    # what ends before that does not depend on it
    early = solve(replace(thrown(back), bounces=None, duration=0.2))
    assert early.outcome is Outcome.FINISHED
    assert early.t_end == 0.2


def test_what_round_off_takes_beside_steady_rolling_is_allowed_and_said() -> None:
    rotation = steady_rotation(PAPER_CAN, 0.3, 0.5)
    problem = Problem(
        parameters=PAPER_CAN, phi=0.3 * (1 - 1e-7), psi_dot=0.5, theta_dot=rotation, bounces=1
    )
    found = solve(problem)
    assert found.agreement is not None
    assert found.agreement.holds
    assert found.outcome is Outcome.FINISHED


@pytest.mark.parametrize("row", HARD, ids=lambda row: f"{row['can']}, phi={row['phi']:.3g}")
def test_hard_releases_are_confirmed(row: dict[str, Any]) -> None:
    """Releases of which forty digits are known: no false alarm, and no refusal."""
    can = Parameters(a=row["a"], c=row["c"], h=row["h"])
    release = {name: row[name] for name in ("phi", "phi_dot", "psi_dot", "theta_dot")}
    found = solve(
        Problem(parameters=can, bounces=2, **release), outputs=frozenset({"contact_locus"})
    )
    assert found.model == "exact"
    assert found.agreement is not None
    assert found.agreement.holds
    assert found.agreement.discrepancy < 1e-9


def test_random_releases_are_confirmed() -> None:
    """Over disks and needles: the bound is neither passed by round-off nor larger than 1e-9."""
    random = np.random.default_rng(11)
    for _ in range(examples(1 / 4)):
        a, h = 10.0 ** random.uniform(-1.0, 1.0), 10.0 ** random.uniform(-1.5, 0.8)
        can = Parameters(a=a, c=a * random.uniform(0.05, 1.9), h=h)
        problem = Problem(
            parameters=can,
            phi=can.balancing_angle * random.uniform(0.01, 0.999),
            psi_dot=random.normal() * 10.0 ** random.uniform(-6.0, 0.5),
            theta_dot=random.normal() * 10.0 ** random.uniform(-6.0, 0.5),
            phi_dot=random.choice([0.0, 0.0, 0.1, -0.1]),
            bounces=1,
        )
        found = solve(problem)
        assert found.agreement is not None
        assert found.agreement.holds, found.agreement.sentence
        assert found.agreement.allowed < 1e-9


def test_neighbours_differ_in_one_number() -> None:
    beside = [one for pair in neighbours(GENTLE, 4 * EPS) for one in pair]
    # a, c, h, phi, psi' and theta': phi' is zero
    assert len(set(beside)) == len(beside) == 12
    hoop = replace(GENTLE, parameters=Parameters(a=0.5, c=1.0, h=1.0))
    assert sum(len(pair) for pair in neighbours(hoop, 4 * EPS)) == 10  # c = 2 a is a limit


def test_a_scene_in_the_upper_of_two_wells() -> None:
    """Forty digits: phi_min 1.46386689 and a period of 46.3075 (DOP853 in raw variables agrees)."""
    found = solve(TWO_WELLS)
    assert found.outcome is Outcome.FINISHED
    assert found.bounces[0].phi_min == pytest.approx(1.46386689, rel=1e-8)
    assert found.t_end == pytest.approx(46.3075, rel=1e-5)


def test_the_quantity_that_parts_most_is_the_one_that_is_said() -> None:
    """Beside a separatrix the greatest phi keeps its digits and the period loses them."""
    can = Parameters(a=0.09194410442678277, c=0.11438182816854518, h=0.019708409731461443)
    release: dict[str, Any] = {
        "phi": 0.589290095572981,
        "psi_dot": -2.7761771987787656,
        "theta_dot": 3.0551656418844946,
    }
    found = solve(Problem(parameters=can, **release, bounces=2))
    assert found.agreement is not None
    assert found.agreement.quantity == "period"
    # sixty digits: the period of the closed motion is off by 1.2e-7
    assert 1.2e-7 < found.agreement.discrepancy < 1e-5
    assert found.agreement.sentence == found.caveat != ""


@pytest.mark.parametrize("ulps", [-6, pytest.param(-9, marks=pytest.mark.slow)])
def test_a_period_of_which_an_ulp_decides_the_third_digit_is_withheld(ulps: int) -> None:
    speed = 0.13864725449021076
    problem = Problem(
        parameters=TWO_WELLS.parameters,
        phi=0.9,
        phi_dot=-(speed + ulps * float(np.spacing(speed))),
        psi_dot=0.05,
        theta_dot=0.02,
        bounces=2,
    )
    assert solve(problem).outcome is Outcome.UNRESOLVED


@pytest.mark.parametrize(
    "psi_dot",
    [0.18679177426536972, pytest.param(0.18679177426536975, marks=pytest.mark.slow)],
)
def test_a_least_phi_without_a_digit_is_withheld(psi_dot: float) -> None:
    """The two releases are an ulp apart, and the integrations' least phi are 6e-17 and 7e-18."""
    problem = Problem(
        parameters=PAPER_CAN, phi=0.3, psi_dot=psi_dot, theta_dot=1 - psi_dot, bounces=1
    )
    found = solve(problem)
    assert found.outcome is Outcome.UNRESOLVED
    assert found.agreement is not None
    assert found.agreement.refused


def test_an_integration_that_stands_alone_is_given_where_no_ulp_moves_it() -> None:
    can = Parameters(a=0.13936270343261548, c=5.9474448882487e-05, h=345.561202276522)
    release: dict[str, Any] = {
        "phi": 8.700221697792875e-14,
        "psi_dot": 4.9458106462187133e-08,
        "theta_dot": -0.30345608464060064,
    }
    found = solve(Problem(parameters=can, **release, bounces=1))
    # sixty digits of `tests.reference.hostile.truth`
    assert np.diff(found.maxima)[0] == pytest.approx(2.8838076063853777e-4, rel=1e-12, abs=0)
    assert found.agreement is not None
    assert found.agreement.refused


def test_a_falling_release_that_the_closed_motion_sends_over_the_top_is_found(
    forced: Forced,
) -> None:
    forced(ended(Outcome.OVERTURNED))
    found = solve(
        Problem(
            parameters=PAPER_CAN, phi=0.4, phi_dot=-0.1, psi_dot=0.12, theta_dot=-0.06, bounces=1
        )
    )
    assert found.agreement is not None
    assert not found.agreement.holds
    assert len(found.bounces) == 1


@pytest.mark.parametrize("phi_dot", [1e-16, 3e-17, 1e-300])
@pytest.mark.parametrize("model", ["auto", "exact"])
def test_a_release_that_rises_by_less_than_an_ulp_bounces(phi_dot: float, model: str) -> None:
    rising = Problem(
        parameters=PAPER_CAN, phi=0.4, psi_dot=0.12, theta_dot=-0.06, phi_dot=phi_dot, bounces=1
    )
    found, rest = solve(rising, model=model), solve(replace(rising, phi_dot=0.0))
    assert len(found.bounces) == 1
    assert found.t_end == pytest.approx(rest.t_end, rel=1e-14, abs=0)
    assert found.agreement is None or found.agreement.holds


def test_a_release_that_falls_by_less_than_an_ulp_to_its_minimum_opens_a_bounce() -> None:
    found = solve(
        Problem(
            parameters=PAPER_CAN, phi=0.02, psi_dot=8.0, theta_dot=-8.05, phi_dot=-1e-170, bounces=1
        )
    )
    assert found.agreement is not None
    assert found.agreement.holds
    assert found.maxima[0] == 0.0
