"""The exact bounce against forty digits, at its limits, and against the integrator."""

import json
import math
from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reference import PAPER_CAN, Outcome, Parameters, Problem, RefusedError, solve
from reference.equations.energy import energy
from reference.integrable.cycle import exact_bounces
from tests.support.examples import evenly, examples

TABLES = Path(__file__).parent / "golden"
GOLDEN = json.loads((TABLES / "golden.json").read_text())
MEASURES = ("period", "angle_of_turn", "rotation_turn", "phi_min", "phi_max", "peak_psi_dot")
CAN: dict[str, Any] = {"a": PAPER_CAN.a, "c": PAPER_CAN.c, "h": PAPER_CAN.h}
ARGUMENTS = ("a", "c", "h", "phi", "phi_dot", "psi_dot", "theta_dot")


either = pytest.mark.parametrize("compiled", [False, True], ids=["arrays", "compiled"])
"""By the arrays of numpy, and by compiled kernels first."""


def near_balance(row: dict[str, Any]) -> bool:
    return bool(math.atan(1 / row["h"]) - row["phi"] < 1e-4)


def test_golden_table_is_as_wide_as_promised() -> None:
    assert len({row["can"] for row in GOLDEN}) >= 5
    for can in {row["can"] for row in GOLDEN}:
        rows = [row for row in GOLDEN if row["can"] == can]
        assert len(rows) >= 12
        assert {math.copysign(1, float(row["angle_of_turn"])) for row in rows} == {-1.0, 1.0}
        assert any(row["phi_dot"] for row in rows)
        assert any(near_balance(row) for row in rows)


@either
def test_forty_digits(*, compiled: bool) -> None:
    """All rows in one batch of different cans, to 1e-12 as promised."""
    rows = {name: [row[name] for row in GOLDEN] for name in ARGUMENTS}
    cycles = exact_bounces(**rows, compiled=compiled)
    assert cycles.bounced.all()
    for name in MEASURES:
        truth = np.array([float(row[name]) for row in GOLDEN])
        assert np.abs(getattr(cycles, name) / truth - 1).max() < 1e-12, name


@pytest.mark.parametrize("model", ["exact", "rolling"])
def test_golden_releases_solved_one_by_one(model: str) -> None:
    """All rows to 1e-10, as promised, 1e-5 off balance too; the second bounce, after a return."""
    for row in evenly(GOLDEN):
        can = Parameters(a=row["a"], c=row["c"], h=row["h"])
        release = {name: row[name] for name in ARGUMENTS[3:]}
        solution = solve(Problem(parameters=can, bounces=2, **release), model=model)
        assert solution.model == model
        bounce = solution.bounces[1]
        period = solution.maxima[2] - solution.maxima[1]
        assert period == pytest.approx(float(row["period"]), rel=1e-10)
        for name in ("angle_of_turn", "rotation_turn", "phi_min", "peak_psi_dot"):
            assert getattr(bounce, name) == pytest.approx(float(row[name]), rel=1e-10, abs=0), name


@pytest.mark.slow
def test_formula_and_integrator_agree_in_all_that_a_bounce_reports() -> None:
    """To 1e-10, on every row."""
    for row in GOLDEN:
        can = Parameters(a=row["a"], c=row["c"], h=row["h"])
        release = {name: row[name] for name in ARGUMENTS[3:]}
        problem = Problem(parameters=can, bounces=1, **release)
        formula, integrated = (solve(problem, model=model) for model in ("exact", "rolling"))
        assert formula.t_end == pytest.approx(integrated.t_end, rel=1e-10)
        for one, other in zip(
            astuple(formula.bounces[0]), astuple(integrated.bounces[0]), strict=True
        ):
            assert one == pytest.approx(other, rel=1e-10, abs=0)


@pytest.mark.parametrize("off", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("share", [0.9, 1e-3, -1e-3, -0.9])
def test_a_release_that_moves_beside_balance_turns_back(off: float, share: float) -> None:
    """Just below balance there are two turning points, one on either side of it."""
    p = PAPER_CAN
    thrown = share * off * math.sqrt(math.hypot(1, p.h) / p.pendulum_inertia)
    release: dict[str, Any] = {
        "phi": p.balancing_angle - off,
        "phi_dot": thrown,
        "psi_dot": 1e-9,
        "theta_dot": 0.0,
    }
    assert exact_bounces(**CAN, **release).bounced.all()
    asked = Problem(parameters=p, bounces=2, **release)
    exact, rolling = solve(asked, model="exact"), solve(asked, model="rolling")
    assert exact.model == "exact"
    assert exact.maxima == pytest.approx(rolling.maxima, rel=1e-10, abs=1e-10)
    for mine, theirs in zip(exact.bounces, rolling.bounces, strict=True):
        assert mine.phi_min == pytest.approx(theirs.phi_min, rel=1e-10, abs=0)
        assert mine.angle_of_turn == pytest.approx(theirs.angle_of_turn, rel=1e-10)


def test_one_can_and_many_cans_agree() -> None:
    phi = np.linspace(0.01, 0.5, 40)
    one = exact_bounces(**CAN, phi=phi, psi_dot=1e-3, theta_dot=-2e-3)
    many = exact_bounces(
        a=np.full(40, CAN["a"]), c=CAN["c"], h=CAN["h"], phi=phi, psi_dot=1e-3, theta_dot=-2e-3
    )
    for name in MEASURES:
        # the same operations in another order of summation
        assert np.allclose(getattr(one, name), getattr(many, name), rtol=1e-14, atol=0)


@either
def test_mirror_turns_the_other_way(*, compiled: bool) -> None:
    """Reflection in a vertical plane: equal bits but for signs."""
    phi = np.linspace(0.01, 0.5, 40)
    here = exact_bounces(**CAN, phi=phi, psi_dot=1e-3, theta_dot=-2e-3, compiled=compiled)
    there = exact_bounces(**CAN, phi=phi, psi_dot=-1e-3, theta_dot=2e-3, compiled=compiled)
    assert (here.angle_of_turn == -there.angle_of_turn).all()
    assert (here.period == there.period).all()


@either
def test_cost_does_not_grow_with_the_hardness(*, compiled: bool) -> None:
    """Bounces down to a nutation of 1e-100 still turn by the leading angle."""
    psi_dot = 10.0 ** -np.arange(10, 101, 10)
    cycles = exact_bounces(**CAN, phi=0.3, psi_dot=psi_dot, theta_dot=0.0, compiled=compiled)
    assert cycles.bounced.all()
    # the correction is of the order of phi_min log phi_min
    assert np.allclose(cycles.angle_of_turn, np.pi * PAPER_CAN.turn_ratio, rtol=1e-7)
    assert (np.diff(np.log(cycles.phi_min)) < 0).all()


@either
def test_random_releases_leave_no_nan(*, compiled: bool) -> None:
    rng = np.random.default_rng(3)
    n = examples(40)
    cycles = exact_bounces(
        **CAN,
        phi=rng.uniform(1e-6, np.pi / 2 - 1e-6, n),
        phi_dot=rng.choice([0.0, 0.3, -0.3, 3.0], n),
        psi_dot=rng.normal(size=n) * 10.0 ** rng.uniform(-30, 2, n),
        theta_dot=rng.normal(size=n) * 10.0 ** rng.uniform(-30, 2, n),
        compiled=compiled,
    )
    for name in MEASURES:
        values = getattr(cycles, name)
        assert np.isfinite(values).all()
        assert (values[~cycles.bounced] == 0).all()
    assert (cycles.period[cycles.bounced] > 0).all()


@either
@pytest.mark.parametrize(
    ("release", "outcome"),
    [
        ({"phi": 0.4}, Outcome.FELL_FLAT),
        ({"phi": 0.8}, Outcome.OVERTURNED),
        ({"phi": 0.3, "phi_dot": 3.0}, Outcome.OVERTURNED),
        ({"phi": PAPER_CAN.balancing_angle}, Outcome.STEADY),
        ({"phi": PAPER_CAN.balancing_angle, "theta_dot": 4.0}, Outcome.STEADY),
    ],
)
def test_releases_that_never_bounce(
    release: dict[str, Any], outcome: Outcome, *, compiled: bool
) -> None:
    assert exact_bounces(**CAN, **release, compiled=compiled).outcome(0) is outcome
    for model in ("exact", "rolling"):
        solution = solve(Problem(parameters=PAPER_CAN, bounces=1, **release), model=model)
        assert solution.outcome is outcome
        assert solution.bounces == ()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("phi", 0.0),
        ("phi", 2.0),
        ("phi_dot", 1e151),
        ("psi_dot", math.nan),
        ("c", 3.0),
        ("a", -1.0),
        ("h", math.inf),
    ],
)
def test_bad_batches_are_refused(key: str, value: float) -> None:
    with pytest.raises(RefusedError) as refused:
        exact_bounces(**{**CAN, "phi": 0.3, key: value})
    assert refused.value.key == key
    np.testing.assert_array_equal(refused.value.value, value)


HISTORIES = [
    {"phi": math.pi / 100, "psi_dot": 6e-3, "theta_dot": -5.9e-3},
    {"phi": 0.3, "phi_dot": 0.1, "psi": 0.3, "theta": 1.0, "psi_dot": 0.3, "theta_dot": -0.1},
    {"phi": 0.3, "phi_dot": -0.1, "psi_dot": 0.3, "theta_dot": -0.1},
    {"phi": 0.4, "psi_dot": 2.0, "theta_dot": -1.0},
    {"phi": math.pi / 100, "psi_dot": 0.106, "theta_dot": 0.43},
]


@pytest.mark.parametrize("release", HISTORIES)
def test_histories_agree_with_the_integrator(release: dict[str, Any]) -> None:
    """Angles, rates, spin and contact point at even times through two bounces."""
    problem = Problem(parameters=PAPER_CAN, bounces=2, **release)
    outputs = {"contact_locus"}
    exact = solve(problem, model="exact", outputs=outputs)
    rolling = solve(problem, model="rolling", outputs=outputs)
    assert exact.t_end == pytest.approx(rolling.t_end, rel=1e-13, abs=0)
    times = np.linspace(0, min(exact.t_end, rolling.t_end), 400)
    here, there = exact.at(times), rolling.at(times)
    fastest = np.abs(exact.bounces[0].peak_psi_dot)
    for name in ("phi", "psi", "theta", "x", "y"):
        # a time is known to eps t: angles to that times the fastest rate, doubled for two paths
        allowed = 1e-12 + 8 * np.finfo(float).eps * exact.t_end * fastest
        assert np.abs(getattr(here, name) - getattr(there, name)).max() < allowed, name
    assert np.ptp(energy(exact.at(exact.grid()), PAPER_CAN)) < 1e-12 * fastest
    for a, b in zip(exact.bounces, rolling.bounces, strict=True):
        assert a.time == pytest.approx(b.time, rel=1e-12, abs=0)
        assert a.rotation_turn == pytest.approx(b.rotation_turn, rel=1e-11)
