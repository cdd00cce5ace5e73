"""The engines of this package keep the contract, and exactly where they can."""

from functools import cache

import pytest

from harness.engines.conformance import CLAUSES, ClauseResult, ClauseStatus, conform
from harness.engines.registry import engine
from tests.support.engines import PHYSICS, STEPPING

NOT_APPLICABLE: dict[str, set[str]] = {name: set() for name in PHYSICS} | {
    "drake-cenic": {"horizon", "friction", "divergence", "newton"},
    "exudyn": {"friction", "flight"},
    "ode": {"friction"},
    "reference": {
        *("mass properties", "horizon", "laws of effects", "divergence", "flight"),
        "unsupported effect",
    },
}


COARSE = {
    # numbers of 24 bits; a cone solver that stops within 2e-4 of the weight, beside small changes
    "newton": {"mujoco-warp": 0.01, "newton": 0.01, "physx": 0.6, "pinocchio": 0.6},
    # a collider that iterates knows the point less well than the depth; Newton's has further points
    "same instant": {
        "drake": 1e-3,
        "exudyn": 1e-6,
        "mujoco-warp": 1e-3,
        "newton": 0.1,
        "physx": 0.1,
    },
}
"""What is not exact to round-off, and how far."""


@cache
def verdicts_on(name: str) -> tuple[ClauseResult, ...]:
    """Return what the suite says of an engine, asked once."""
    return conform(engine(name))


def told(verdicts: tuple[ClauseResult, ...], result: ClauseStatus) -> dict[str, str]:
    """Return the details of the checks that ended so, by name."""
    return {verdict.name: verdict.detail for verdict in verdicts if verdict.result is result}


PARAMS = [
    pytest.param(name, marks=pytest.mark.slow if name in {"pybullet", "reference"} else ())
    for name in (*PHYSICS, "reference")
]
"""Engines, the reference the last: a quick run asks one of those that are always there, and of the
optional ones all that are installed."""


@pytest.mark.parametrize("name", PARAMS)
def test_the_engines_keep_the_contract(name: str) -> None:
    verdicts = verdicts_on(name)
    assert [verdict.name for verdict in verdicts] == list(CLAUSES)
    assert told(verdicts, ClauseStatus.FAILED) == {}
    alone = set() if hasattr(engine(name), "simulate_many") else {"repeats in a batch"}
    assert told(verdicts, ClauseStatus.NOT_APPLICABLE).keys() == NOT_APPLICABLE[name] | alone


@pytest.mark.parametrize("name", [each for each in PARAMS if each.values[0] in STEPPING])
def test_the_adapters_of_physics_engines_are_exact_where_they_can_be(name: str) -> None:
    numbers = {verdict.name: verdict.number or 0.0 for verdict in verdicts_on(name)}
    # of a reading of the wrong instant it would be 1; round-off of a soft constraint is 1e-11
    assert numbers["newton"] < COARSE["newton"].get(name, 1e-9)
    assert numbers["same instant"] < COARSE["same instant"].get(name, 1e-9)
