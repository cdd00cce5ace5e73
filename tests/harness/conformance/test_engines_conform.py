"""The engines of this package keep the contract, and exactly where they can."""

from functools import cache

import pytest

from harness.engines.conformance import CLAUSES, ClauseResult, ClauseStatus, conform
from harness.engines.registry import engine

NOT_APPLICABLE: dict[str, set[str]] = {
    "mujoco": set(),
    "pybullet": {"unsupported effect"},
    "reference": {"mass properties", "horizon", "laws of effects", "divergence", "flight"},
}


@cache
def verdicts_on(name: str) -> tuple[ClauseResult, ...]:
    """Return what the suite says of an engine, asked once."""
    return conform(engine(name))


def told(verdicts: tuple[ClauseResult, ...], result: ClauseStatus) -> dict[str, str]:
    """Return the details of the checks that ended so, by name."""
    return {verdict.name: verdict.detail for verdict in verdicts if verdict.result is result}


DEAR = [pytest.param(name, marks=pytest.mark.slow) for name in ("pybullet", "reference")]
"""Engines that keep the contract as `mujoco` does, some seconds each."""


@pytest.mark.parametrize("name", ["mujoco", *DEAR])
def test_the_engines_keep_the_contract(name: str) -> None:
    verdicts = verdicts_on(name)
    assert [verdict.name for verdict in verdicts] == list(CLAUSES)
    assert told(verdicts, ClauseStatus.FAILED) == {}
    alone = set() if hasattr(engine(name), "simulate_many") else {"repeats in a batch"}
    assert told(verdicts, ClauseStatus.NOT_APPLICABLE).keys() == NOT_APPLICABLE[name] | alone


@pytest.mark.parametrize("name", ["mujoco", DEAR[0]])
def test_the_adapters_of_physics_engines_are_exact_where_they_can_be(name: str) -> None:
    numbers = {verdict.name: verdict.number or 0.0 for verdict in verdicts_on(name)}
    # of a reading of the wrong instant it would be 1; round-off of a soft constraint is 1e-11
    assert numbers["newton"] < 1e-9
    assert numbers["same instant"] < 1e-9
