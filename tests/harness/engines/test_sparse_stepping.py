"""MuJoCo's steps between looks are the steps that it takes when each is looked at."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.engines.mujoco import steps as mujoco_steps
from harness.engines.registry import engine
from harness.engines.stepping.physics_engine import schedule_of
from models import Horizon, Scene, load
from tests.support.engines import stepping_engine


def run(scene: Scene, timestep: float) -> Simulation:
    return engine("mujoco").simulate(Case(scene=scene, engine="mujoco", timestep=timestep))


@pytest.mark.parametrize(("name", "seconds"), [("gentle-rock", 0.01), ("petals", 0.02)])
def test_what_is_looked_at_has_the_bits_of_a_run_that_looks_at_every_step(
    name: str, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = replace(load(name), horizon=Horizon(seconds=seconds))
    spared = run(scene, 1e-6)
    monkeypatch.setattr(mujoco_steps, "WORTH_IT", 10**9)
    dense = run(scene, 1e-6)
    assert (spared.steps, spared.outcome) == (dense.steps, dense.outcome)
    mine, theirs = spared.trajectory, dense.trajectory
    assert mine is not None
    assert theirs is not None
    # a sample lies at most half a spacing later than that of a record that saw every step
    assert len(mine.time) == pytest.approx(len(theirs.time), rel=0.1)
    _, here, there = np.intersect1d(mine.time, theirs.time, return_indices=True)
    assert here.size > 1
    for quantity in ("position", "quaternion", "velocity", "contact_point", "contact_force"):
        one, other = getattr(mine, quantity)[here], getattr(theirs, quantity)[there]
        np.testing.assert_array_equal(one, other)


def test_coarse_steps_and_shaken_planes_are_looked_at_step_by_step() -> None:
    fine = {"gentle-rock": True, "shaken-plane": False}
    for name, sparse in fine.items():
        chosen = stepping_engine("mujoco")
        for timestep, expected in ((1e-6, sparse), (1e-4, False)):
            case = Case(scene=load(name), engine="mujoco", timestep=timestep)
            prepared = chosen.simulate(replace(case, scene=replace(case.scene, horizon=SHORT)))
            schedule, _ = schedule_of(prepared)
            sampling = mujoco_steps.sparse_sampling(chosen.open(case), schedule)
            assert (sampling is not None) is expected


SHORT = Horizon(seconds=1e-4)
