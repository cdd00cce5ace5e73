"""Looking at the steps that matter finds what looking at every step finds."""

from collections.abc import Callable
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.core.trajectory import Trajectory, join
from harness.engines.registry import engine
from harness.engines.stepping.generic_stepping import walk
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.recording import (
    ANGLE_STEP,
    READINGS_PER_SAMPLE,
    SAMPLES_IN_TIME,
    SamplingInterval,
)
from harness.engines.stepping.schedule import Fixed
from harness.engines.stepping.settling import settle
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from models import Horizon, Scene, load, release_state
from models.kinematics import angles, quaternion

INTERVAL = 3e-4
Patch = pytest.MonkeyPatch


def seen(phi: float, spin: tuple[float, float, float]) -> int:
    """Return the first pause at steps of a nanosecond from a tilt, scalar last, and a spin."""
    w, x, y, z = quaternion(phi, 0.3, -0.2).tolist()
    return SamplingInterval(INTERVAL).pause((x, y, z, w), spin, 1e-9)


def test_at_rest_time_alone_counts() -> None:
    assert seen(0.4, (0.0, 0.0, 0.0)) == int(INTERVAL / READINGS_PER_SAMPLE / 1e-9)


def test_a_pause_ends_at_its_share_of_the_path() -> None:
    # a spin of 2e4 rad/s about the vertical is psi' alone, which the path counts twice
    vertical = seen(0.4, (0.0, 0.0, 2e4))
    rate = 2.0 * 2e4 / ANGLE_STEP + 1.0 / INTERVAL
    assert vertical == pytest.approx(1e9 / (READINGS_PER_SAMPLE * rate), abs=1.0)  # whole steps


def test_near_the_flat_state_a_pause_ends_before_the_tilt_has_changed() -> None:
    # a fall changes phi by g/R in time, in natural times by one: a tenth of phi, less round-off
    fall = 1e-4 * 0.1 * (SAMPLES_IN_TIME * INTERVAL)
    assert seen(1e-4, (0.0, 0.0, 0.0)) == pytest.approx(fall / 1e-9, abs=1.0)
    assert seen(0.0, (0.0, 0.0, 0.0)) == 1


@pytest.mark.parametrize("spin", [(np.nan, 0.0, 0.0), (np.inf, 0.0, 0.0), (0.0, 1e300, 0.0)])
def test_of_what_is_no_state_every_step_is_looked_at(spin: tuple[float, float, float]) -> None:
    assert seen(0.4, spin) == 1


def test_shares_of_steps_are_not_lost() -> None:
    sampling = SamplingInterval(INTERVAL)
    timestep = INTERVAL / READINGS_PER_SAMPLE / 2.3
    pauses = [sampling.pause((0.2, 0.0, 0.0, 0.98), (0.0, 0.0, 0.0), timestep) for _ in range(1000)]
    assert set(pauses) == {2, 3}
    # each pause is cut down to whole steps, and what was cut off counts for the next
    assert abs(sum(pauses) - 2300) <= 1


def runs(scene: Scene, profile: str, timestep: float, patch: Patch) -> tuple[Evaluation, ...]:
    """Return a run that looks at every step, and one that does not."""
    case = Case(scene=scene, engine="pybullet", profile=profile, timestep=timestep)
    with patch.context() as changed:
        changed.setattr(SamplingInterval, "spare", lambda *_: False)
        every = evaluate(case)
    return every, evaluate(case)


SCENES = [("gentle-rock", 2e-5), ("paper-release", 5e-6), ("wobble", 2e-5)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "timestep"), SCENES)
@pytest.mark.parametrize("profile", ["default", "matched"])
def test_all_that_is_reported_stays(
    name: str, timestep: float, profile: str, monkeypatch: Patch
) -> None:
    every, sparing = runs(load(name), profile, timestep, monkeypatch)
    assert sparing.simulation.outcome is every.simulation.outcome
    assert len(sparing.bounces) == len(every.bounces) > 0
    # the motion is one and the same; between its samples it is interpolated from other samples,
    # which tells at the fourth power of their spacing, at the first where a prism's corners kick
    kicked = profile == "default"
    for mine, its in zip(sparing.bounces, every.bounces, strict=True):
        assert mine.angle_of_turn == pytest.approx(its.angle_of_turn, abs=1e-6 if kicked else 1e-8)
        assert mine.phi_min == pytest.approx(its.phi_min, rel=1e-3 if kicked else 1e-5)
        if not kicked:  # of kicks that last a step no recording by angle finds the largest
            assert mine.peak_friction_ratio == pytest.approx(its.peak_friction_ratio, rel=1e-5)
    a, b = sparing.contact, every.contact
    assert a is not None
    assert b is not None
    # at most a sample of each hundred tells another state of a contact that comes and goes
    assert a.lift_off_fraction == pytest.approx(b.lift_off_fraction, abs=2e-3)
    assert a.multi_contact_fraction == pytest.approx(b.multi_contact_fraction, abs=2e-3)
    assert a.max_penetration == pytest.approx(b.max_penetration, rel=0.05 if kicked else 1e-3)
    if not kicked:
        assert a.max_slip == pytest.approx(b.max_slip, rel=1e-3)
    # a run ends at a sample, and samples lie up to half their spacing later
    spacing = natural_time(load(name)) / SAMPLES_IN_TIME / timestep
    assert abs(sparing.simulation.steps - every.simulation.steps) <= 1.5 * spacing
    mean = every.simulation.constraint_rows / every.simulation.steps
    assert sparing.simulation.constraint_rows / sparing.simulation.steps == pytest.approx(
        mean, rel=0.02
    )


def walked(case: Case) -> Trajectory:
    """Return every step of a case whose horizon is a time, read one by one."""
    chosen = engine(case.engine)
    pose, twist = release_state(case.scene.can, case.scene.release)
    _, pose = settle(chosen.open(case), case.scene, pose, twist)  # type: ignore[attr-defined]
    world = chosen.open(case)  # type: ignore[attr-defined]
    world.place(pose, twist)
    schedule = Fixed(chosen.timestep(case) or 0.0, case.scene.horizon.seconds or 0.0, 64)
    return join([chunk.read(np.arange(len(chunk.times))) for chunk in walk(world, schedule, 64)])


def test_each_look_is_the_state_of_its_step(brief: Scene) -> None:
    case = Case(scene=brief, engine="pybullet", timestep=1e-5)
    every = walked(case)
    own = engine("pybullet").simulate(case)
    path = own.trajectory
    assert path is not None
    at = np.searchsorted(every.time, path.time)
    assert len(path) < len(every) / 10
    for field in fields(Trajectory):
        np.testing.assert_array_equal(getattr(path, field.name), getattr(every, field.name)[at])
    assert path.time[-1] == every.time[-1]  # the last step of all is looked at
    assert own.steps == len(every)
    assert own.constraint_rows == 3 * len(every)


@pytest.mark.parametrize("size", [16, 37])
def test_the_looks_do_not_depend_on_how_the_run_is_cut(
    brief: Scene, size: int, monkeypatch: Patch
) -> None:
    case = Case(scene=brief, engine="pybullet", timestep=1e-5)
    whole = engine("pybullet").simulate(case)
    monkeypatch.setattr(engine("pybullet"), "fewest_steps", size)
    monkeypatch.setattr("harness.engines.stepping.physics_engine.MOST", size)
    cut = engine("pybullet").simulate(case)
    assert whole.trajectory is not None
    assert cut.trajectory is not None
    for field in fields(Trajectory):
        np.testing.assert_array_equal(
            getattr(cut.trajectory, field.name), getattr(whole.trajectory, field.name)
        )
    assert (cut.steps, cut.constraint_rows) == (whole.steps, whole.constraint_rows)


def ended(
    bounces: int | None, seconds: float | None, change: Callable[[Scene], Scene]
) -> Simulation:
    """Return a run of a gentle rock with another horizon."""
    scene = change(replace(load("gentle-rock"), horizon=Horizon(bounces=bounces, seconds=seconds)))
    return engine("pybullet").simulate(Case(scene=scene, engine="pybullet", timestep=1e-5))


def test_steps_are_counted_up_to_the_last_sample() -> None:
    run = ended(1, None, lambda scene: scene)
    assert run.trajectory is not None
    assert run.steps == round(float(run.trajectory.time[-1]) / 1e-5) + 1


def test_samples_are_no_further_apart_than_half_again_their_spacing() -> None:
    run = ended(None, 0.1, lambda scene: scene)
    assert run.trajectory is not None
    phi, _, _ = angles(run.trajectory.quaternion)
    assert phi.min() > 0.1  # of time and little else
    limit = natural_time(load("gentle-rock")) / SAMPLES_IN_TIME
    gaps = [after - before for before, after in pairwise(run.trajectory.time.tolist())]
    assert max(gaps) <= (1.0 + 1.0 / READINGS_PER_SAMPLE) * limit + 1e-5
