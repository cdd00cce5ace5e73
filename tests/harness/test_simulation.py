"""Simulations: locked, picklable, and outcomes that a person can read."""

import pickle
from dataclasses import fields, replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.simulation import Outcome, ParityRow, Simulation
from models import Scene
from tests.support.trajectories import make_trajectory, path_of


@pytest.fixture
def simulation(gentle: Scene) -> Simulation:
    """Return a simulation with every field set."""
    row = ParityRow(quantity="mass", unit="kg", declared=1.0, found=1.0, how="", verdict="equal")
    return Simulation(
        case=Case(scene=gentle, engine="mujoco"),
        outcome=Outcome.FINISHED,
        note="well",
        trajectory=make_trajectory(3),
        engine_version="1",
        model="mujoco",
        timestep=1e-4,
        settings={"cone": "elliptic"},
        parity=(row,),
        steps=3,
    )


def test_settings_are_a_locked_copy(simulation: Simulation) -> None:
    given = {"cone": "elliptic"}
    kept = replace(simulation, settings=given)
    given["cone"] = "pyramidal"
    assert kept.settings == {"cone": "elliptic"}
    with pytest.raises(TypeError):
        kept.settings["cone"] = "pyramidal"  # type: ignore[index]


def test_pickling_keeps_every_field_and_the_lock(simulation: Simulation) -> None:
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    for field in fields(Simulation):
        if field.name != "trajectory":
            assert getattr(back, field.name) == getattr(simulation, field.name), field.name
    assert back.trajectory is not None
    np.testing.assert_array_equal(path_of(back).time, path_of(simulation).time)
    with pytest.raises(TypeError):
        back.settings["cone"] = "pyramidal"


@pytest.mark.parametrize("outcome", Outcome)
def test_an_outcome_is_a_sentence_that_begins_with_its_word(outcome: Outcome) -> None:
    word, colon, sentence = outcome.value.partition(": ")
    assert colon
    assert word.replace(" ", "_").upper() == outcome.name
    assert len(sentence.split()) > 3
