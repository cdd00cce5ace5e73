"""Steps between looks are the steps that an engine takes when each is looked at."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.engines.mujoco import steps as mujoco_steps
from harness.engines.pybullet import world as pybullet_world
from harness.engines.pybullet.suppress_output import pybullet
from harness.engines.registry import engine
from harness.engines.stepping.physics_engine import schedule_of
from models import Damping, Horizon, RollingResistance, Scene, load
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


@pytest.mark.parametrize("steps", [2, 3, 5, 7, 12, 31, 32, 100, 1023, 1024, 3000])
@pytest.mark.parametrize("timestep", [1e-6, 1e-5, 1 / 240, 1e-5 / 3, 2.0**-17])
def test_steps_of_pybullet_together_are_each_as_long_as_one(steps: int, timestep: float) -> None:
    count = pybullet_world.steps_together(steps, timestep)
    assert steps / 2 < count <= steps
    part = count * timestep / count
    assert part == timestep
    assert int(count * timestep / part) == count


@pytest.mark.parametrize(
    ("name", "effects", "settings"),
    [
        ("gentle-rock", {}, {}),
        ("gentle-rock", {}, {"useMaximalCoordinates": True}),
        ("gentle-rock", {}, {"constraintSolverType": "CONSTRAINT_SOLVER_LCP_DANTZIG"}),
        ("gentle-rock", {"damping": Damping(linear=0.5, angular=0.3)}, {}),
        ("gentle-rock", {"rolling_resistance": RollingResistance(length=3e-5)}, {}),
        ("soft-rock", {}, {}),
        ("off-centre-mass", {}, {}),
        ("tilted-plane", {}, {}),
        ("shaken-plane", {}, {}),
    ],
)
def test_steps_of_pybullet_in_one_call_have_the_bits_of_steps_one_by_one(
    name: str,
    effects: dict[str, Any],
    settings: dict[str, bool | str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = load(name)
    scene = replace(scene, horizon=Horizon(seconds=0.02), effects=replace(scene.effects, **effects))
    options = tuple(settings.items())
    case = Case(scene=scene, engine="pybullet", timestep=7e-6, options=options)
    found, calls = [], []
    set_up = pybullet.setPhysicsEngineParameter

    def counted(*numbers: float, **named: Any) -> None:
        calls.append(numbers)
        set_up(*numbers, **named)

    monkeypatch.setattr(pybullet, "setPhysicsEngineParameter", counted)
    for fewest in (2, 10**9):
        monkeypatch.setattr(pybullet_world, "_FEWEST_TOGETHER", fewest)
        trajectory = engine("pybullet").simulate(case).trajectory
        assert trajectory is not None
        found.append(trajectory)
        # of a shaken plane each step has a gravity of its own
        assert any(calls) is (fewest == 2 and name != "shaken-plane")
        calls.clear()
    for quantity in ("time", "position", "quaternion", "velocity", "contact_force"):
        one, other = (getattr(each, quantity) for each in found)
        np.testing.assert_array_equal(one, other)
