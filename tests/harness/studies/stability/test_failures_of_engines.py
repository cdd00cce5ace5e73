"""The detectors on real engines: a case of each failure, which must keep being recognised."""

import numpy as np
import pytest

from harness.core.case import Case
from harness.evaluation.evaluate import evaluate
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus, classify
from models import load


def run(scene: str, engine: str, profile: str, timestep: float | None) -> ClassifiedRun:
    return classify(
        evaluate(Case(scene=load(scene), engine=engine, profile=profile, timestep=timestep))
    )


@pytest.mark.parametrize(
    ("scene", "engine", "profile", "timestep", "verdict", "least"),
    [
        # the stock contact gives way by a tenth of the radius when the can lands
        ("drop-1-cm", "mujoco", "default", None, StabilityStatus.TUNNELS, 0.1),
        # a needle's spin is stirred by friction until it carries many times the energy
        ("needle-moments", "pybullet", "matched", 2e-3, StabilityStatus.GAINS, 1.0),
        # a step is longer than the bounce: the can lands flat and stays
        ("epsilon-1e-12", "mujoco", "matched", 2e-3, StabilityStatus.FLAT, 1e-3),
        ("epsilon-1e-12", "pybullet", "matched", 2e-3, StabilityStatus.FLAT, 1e-3),
        # the stock damping of a multibody, in free flight
        ("free-axial", "pybullet", "default", None, StabilityStatus.DISSIPATES, 0.3),
        # ERP takes a depth of a millimetre away in a step: the can is shot up
        ("start-in-penetration", "pybullet", "matched", 2e-6, StabilityStatus.DIVERGES, 10.0),
        # the bounce is survived, but its turns cannot be counted
        ("epsilon-1e-08", "pybullet", "matched", 2e-4, StabilityStatus.UNRESOLVED, 1.5),
    ],
)
def test_a_failure_is_recognised(  # noqa: PLR0917 - a parameter a column
    scene: str,
    engine: str,
    profile: str,
    timestep: float | None,
    verdict: StabilityStatus,
    least: float,
) -> None:
    found = run(scene, engine, profile, timestep)
    assert found.verdict is verdict, found.symptom
    assert found.symptom.number >= least
    seconds = load(scene).horizon.seconds
    assert seconds is not None
    assert 0.0 <= found.symptom.time <= seconds


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_a_run_ends_when_its_numbers_break(engine: str) -> None:
    case = Case(scene=load("start-in-penetration"), engine=engine, timestep=5e-6)
    e = evaluate(case)
    path, found = e.simulation.trajectory, classify(e)
    assert path is not None
    assert found.verdict is StabilityStatus.DIVERGES
    speed = np.linalg.norm(path.velocity, axis=1)
    limit = 24.0  # m/s: a thousand times the energy of this can at its release, and a little less
    assert speed[-1] > limit
    assert (speed[:-1] < 1.1 * limit).all()
    assert (found.symptom.time, found.symptom.number) == (path.time[-1], speed[-1])
    # the can is shot up within a millisecond, and nothing is stepped after the chunk that shows it
    assert found.symptom.time < 1e-3
    assert e.simulation.steps == round(found.symptom.time / 5e-6) + 1


@pytest.mark.parametrize(
    ("scene", "engine", "profile", "timestep"),
    [
        # friction that is soft takes all of its cone only where the can slides fast
        ("hundred-g", "mujoco", "default", None),
        # a solver that stops early, for impulses are tiny
        pytest.param("short-look", "pybullet", "matched", 1e-8, marks=pytest.mark.slow),
        # a can of a millimetre, of which an engine leaves a hundredth alone
        ("tiny-can", "pybullet", "default", 1e-4),
    ],
)
def test_friction_that_is_hard_to_probe_is_not_mistaken_for_another(
    scene: str, engine: str, profile: str, timestep: float | None
) -> None:
    found = run(scene, engine, profile, timestep)
    assert found.verdict is not StabilityStatus.REFUSED, found.symptom


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_what_is_easy_is_accurate(engine: str) -> None:
    assert run("thin-disk", engine, "matched", 1e-3).verdict is StabilityStatus.ACCURATE


def test_a_failure_does_not_poison_the_next_case() -> None:
    before = run("tall-can", "pybullet", "matched", 2e-3)
    run("start-in-penetration", "pybullet", "matched", 2e-6)
    after = run("tall-can", "pybullet", "matched", 2e-3)
    assert (after.verdict, after.symptom) == (before.verdict, before.symptom)
