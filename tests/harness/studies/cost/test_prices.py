"""Prices, from points made by hand: luck is not for sale, ties are told, costs are interpolated."""

import math
from collections.abc import Sequence

import pytest

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.engines.base import Variant
from harness.studies.cost.design import CostPlan
from harness.studies.cost.points import Family, Point, fronts
from harness.studies.cost.prices import HERE, NOISE, Cost, cost_of, offers, price
from harness.studies.cost.tables import price_rows
from models import load
from tests.support.engines import CONSTRAINT

TURN = "turn_deg"


def ladder(
    errors: Sequence[float | None], costs: Sequence[float] = (), engine: str = "mujoco"
) -> list[Point]:
    """Return points at timesteps that fall by ten, with a cost of 1, 10, 100, ..."""
    scene = load("gentle-rock")
    return [
        Point(
            case=Case(scene=scene, engine=engine, timestep=10.0**-rung),
            variant=Variant(name="one"),
            run={
                "outcome": Outcome.FINISHED.name,
                "timestep_s": 10.0**-rung,
                "errors": {TURN: error},
                "simulated_s": 1.0,
                "version": "1",
                "command": "",
            },
            timed={"cpu_s": [costs[rung] if costs else 10.0**rung] * 3},
        )
        for rung, error in enumerate(errors)
    ]


def test_a_coarse_step_that_is_right_by_luck_is_not_sold() -> None:
    sold = offers(ladder((0.001, -1.0, -0.1)), TURN, steps=True)
    assert [offer.error for offer in sold] == [1.0, 1.0, 0.1]


def test_the_finest_rung_is_vouched_for_by_the_one_before() -> None:
    sold = offers(ladder((10.0, 1.0, 1e-9)), TURN, steps=True)
    # a step ten times finer takes an error of second order down by a hundred, and no further
    assert sold[-1].error == pytest.approx(0.01)


def test_an_error_that_is_not_known_below_spoils_what_is_above() -> None:
    sold = offers(ladder((0.1, None, 0.001)), TURN, steps=True)
    assert math.isinf(sold[0].error)
    assert math.isinf(sold[-1].error)


def test_a_solver_that_knows_its_error_needs_nobody_to_vouch() -> None:
    sold = offers(ladder((0.001, -1.0)), TURN, steps=False)
    assert [offer.error for offer in sold] == [0.001, 1.0]


def test_costs_within_the_noise_are_tied() -> None:
    within, beyond = 1.0 + 1.5 * NOISE, 1.0 + 3.0 * NOISE
    sold = offers(ladder((0.1, 0.1, 0.1), (1.0, within, beyond)), TURN, steps=True)
    assert len(price(sold, 1.0).winners) == 2
    assert price(sold, 0.01).winners == ()
    best = price(sold, 0.01).best
    assert best is not None
    assert best.error == 0.1


def test_a_cost_between_rungs_is_that_of_the_power_law() -> None:
    # first order, and a cost that goes with the inverse of the step: 0.5 degrees at 20
    sold = offers(ladder((10.0, 1.0, 0.1)), TURN, steps=True)
    found = cost_of(sold, 0.5)
    assert found is not None
    assert found[0] == pytest.approx(20.0, rel=1e-12)
    assert not found[1]


def test_what_the_coarsest_rung_does_is_a_bound() -> None:
    sold = offers(ladder((0.1, 0.01)), TURN, steps=True)
    assert cost_of(sold, 1.0) == (1.0, True)
    assert cost_of(sold, 1e-9) is None


def test_a_constraint_is_on_no_front_with_contacts() -> None:
    contacts = ladder((10.0, 1.0), (1.0, 10.0))
    better = ladder((0.1, 0.01, 0.1), (0.5, 5.0, 50.0), CONSTRAINT)
    assert fronts([*contacts, *better], TURN) == (tuple(contacts), tuple(better[:2]))
    assert fronts(contacts, TURN) == (tuple(contacts), ())


def test_the_cheapest_contact_stays_the_cheapest_beside_a_constraint() -> None:
    engines = (CONSTRAINT, "mujoco", "pybullet")
    ladders = [
        ladder((0.1, 0.01), (cost, 10.0), name)
        for cost, name in zip((1.0, 4.0, 8.0), engines, strict=True)
    ]
    families = [Family(variant=own[0].variant, cases=tuple(p.case for p in own)) for own in ladders]
    plan = CostPlan(
        scene=load("gentle-rock"),
        suite="quick",
        scored=tuple(families),
        tuning=(),
        tuning_scene=load("gentle-rock"),
        hardness=(),
        paths=(),
    )
    cost = Cost(
        plan=plan,
        ladders=tuple(zip(families, map(tuple, ladders), strict=True)),
        tuned={},
        hardness=(),
        runs={},
        overheads={},
    )
    rows = {row["engine"]: row for row in price_rows(cost, HERE, 0.5)}
    assert {name: str(row["verdict"]) for name, row in rows.items()} == {
        "mujoco": "cheapest",
        "pybullet": "dearer",
        CONSTRAINT: "cheapest",
    }
    assert [*rows][-1] == CONSTRAINT  # after all that it is not ranked with
    assert [rows[name]["relative_cost"] for name in engines] == [1.0, 1.0, 2.0]
