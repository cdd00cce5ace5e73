"""The same case gives the same bits: again, after another case, and in another process."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.trajectory import Trajectory
from harness.engines.registry import engine
from harness.evaluation.run_cases import run_cases
from models import Can, Effects, Scene, Slip
from tests.support.engines import STEPPING, stepping_engine
from tests.support.trajectories import make_trajectory

ENGINES = STEPPING


def same_bits(first: Trajectory | None, second: Trajectory | None) -> bool:
    """Whether two trajectories hold the same bits; NaN is NaN."""
    assert first is not None
    assert second is not None
    return all(
        np.array_equal(getattr(first, f.name), getattr(second, f.name), equal_nan=True)
        for f in fields(Trajectory)
        if f.name != "contact_count"
    ) and np.array_equal(first.contact_count, second.contact_count)


@pytest.mark.parametrize("profile", ["default", "matched"])
@pytest.mark.parametrize("name", ENGINES)
def test_again_and_after_other_cases(gentle: Scene, name: str, profile: str) -> None:
    case = Case(scene=gentle, engine=name, profile=profile, timestep=1e-3)
    first = engine(name).simulate(case)
    settings: dict[str, dict[str, Value]] = {
        "pybullet": {  # a client is used again for the worlds of other cases
            "contactBreakingThreshold": 1.0,
            "contactERP": 0.1,
            "contactSlop": 1e-4,
            "numSubSteps": 4,
            "constraintSolverType": "CONSTRAINT_SOLVER_LCP_DANTZIG",
            "numSolverIterations": 3,
            "enableConeFriction": 0,
            "frictionERP": 0.5,
        },
        "dart": {"collisionDetector": "OdeCollisionDetector", "maxSweeps": 2},
        "newton": {"solver": "SolverXPBD", "iterations": 3},
        "physx": {"solverType": "TGS", "frictionOffsetThreshold": 0.04},
        "exudyn": {"solverType": "GeneralizedAlpha", "maxIterations": 3},
        "drake": {"ground": "HalfSpace", "discrete_contact_approximation": "similar"},
        "mjx": {"jax_enable_x64": False, "cone": "pyramidal"},
        "mujoco-warp": {"cone": "pyramidal", "warmstart": "disable"},
        "pinocchio": {"solver": "ADMM", "correction": 0.2, "security_margin": 0.0},
        "ode": {"step": "dWorldQuickStep", "ERP": 0.8, "FiniteRotationMode": False},
        "mujoco": {"refsafe": "disable", "cone": "pyramidal", "warmstart": "disable"},
    }
    disk = Can.from_groups(mass=2.0, radius=0.2, a=0.27, c=0.5, h=0.1)
    other = replace(gentle, can=disk, gravity=3.0, effects=Effects(slip=Slip(mu=0.1)))
    engine(name).simulate(replace(case, scene=other, options=tuple(settings[name].items())))
    again = engine(name).simulate(case)
    assert same_bits(first.trajectory, again.trajectory)
    assert (first.steps, first.constraint_rows) == (again.steps, again.constraint_rows)
    assert first.static_penetration == again.static_penetration
    assert first.parity == again.parity


@pytest.mark.parametrize("name", ENGINES)
def test_while_another_world_is_open(gentle: Scene, name: str) -> None:
    case = Case(scene=gentle, engine=name, timestep=1e-3)
    alone = engine(name).simulate(case)
    other = stepping_engine(name).open(replace(case, timestep=1e-2))
    beside = engine(name).simulate(case)
    other.step()
    assert same_bits(alone.trajectory, beside.trajectory)


@pytest.mark.slow
def test_a_process_pool_gives_the_same_bits_in_the_same_order(gentle: Scene) -> None:
    cases = [
        Case(scene=gentle, engine=name, profile=profile, timestep=timestep)
        for name in ENGINES
        for profile, timestep in (("matched", 1e-3), ("default", None))
    ]
    context = multiprocessing.get_context("spawn")
    told: list[str] = []

    with ProcessPoolExecutor(max_workers=2, mp_context=context) as pool:
        pooled = run_cases(cases, pool, lambda e: told.append(e.simulation.case.label()))
    serial = run_cases(cases)
    assert sorted(told) == sorted(case.label() for case in cases)
    for case, here, there in zip(cases, serial, pooled, strict=True):
        assert here.simulation.case == there.simulation.case == case
        assert same_bits(here.simulation.trajectory, there.simulation.trajectory)
        assert here.bounces == there.bounces
        assert here.true_bounces == there.true_bounces
        assert repr(here.errors) == repr(there.errors)  # by repr, so that NaN is NaN
        assert here.energy_drift == there.energy_drift


@pytest.mark.parametrize("name", ENGINES)
def test_the_result_does_not_depend_on_how_the_run_is_cut(
    gentle: Scene, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = Case(scene=gentle, engine=name, timestep=1e-3)
    runs = []
    for most in (16, 37, 4096):
        monkeypatch.setattr(engine(name), "fewest_steps", min(most, 16), raising=False)
        monkeypatch.setattr("harness.engines.stepping.physics_engine.MOST", most)
        monkeypatch.setattr("harness.engines.stepping.physics_engine.SHORTEST", 1e3)
        runs.append(engine(name).simulate(case))
    assert same_bits(runs[0].trajectory, runs[1].trajectory)
    assert same_bits(runs[0].trajectory, runs[2].trajectory)
    assert len({one.constraint_rows for one in runs}) == 1


def test_the_comparison_of_bits_is_able_to_fail() -> None:
    nan = np.full(3, np.nan)
    assert same_bits(make_trajectory(3, penetration=nan), make_trajectory(3, penetration=nan))
    assert not same_bits(
        make_trajectory(3), make_trajectory(3, penetration=np.array((0.0, 5e-324, 0.0)))
    )
