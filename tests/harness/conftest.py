"""What the tests of the harness share: scenes, and evaluations that several tests look at."""

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.report_model import Figure
from harness.core.trajectory import Trajectory
from harness.engines.registry import engine
from harness.engines.stepping.settling import settle
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from models import Horizon, Scene, load, release_state

Evaluator = Callable[..., Evaluation]
Stepper = Callable[[Case, int], Trajectory]
Trajectories = Callable[..., Trajectory]


@pytest.fixture(scope="session", autouse=True)
def _own_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep what tests run in a store of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROCKINGCAN_STORE", str(tmp_path_factory.mktemp("store")))
        yield


@pytest.fixture(scope="session", autouse=True)
def _two_sentences() -> Iterator[None]:
    """Hold every figure that the harness makes in a test to two sentences on what is seen."""
    made = Figure.__init__

    def held(self: Figure, *args: object, **fields: object) -> None:
        made(self, *args, **fields)
        if sys._getframe(1).f_globals["__name__"].startswith("harness.studies"):  # noqa: SLF001
            count = len(re.findall(r"[.!?](?=\s|$)", self.seen))
            assert count == 2, f"{self.name}: {count} sentences: {self.seen}"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "__init__", held)
        yield


@pytest.fixture(scope="session")
def gentle() -> Scene:
    """Return the gentle release, one bounce."""
    return load("gentle-rock")


@pytest.fixture(scope="session")
def brief(gentle: Scene) -> Scene:
    """Return the gentle release for 20 ms: long enough for contact, too short for a bounce."""
    return replace(gentle, horizon=Horizon(seconds=0.02))


@pytest.fixture(scope="session")
def evaluated() -> Evaluator:
    """Return a function that evaluates a case once in the whole session."""
    known: dict[Case, Evaluation] = {}

    def evaluate_once(
        scene: Scene | str,
        name: str,
        timestep: float | None = None,
        profile: str = "matched",
        **options: Value,
    ) -> Evaluation:
        case = Case(
            scene=load(scene) if isinstance(scene, str) else scene,
            engine=name,
            profile=profile,
            timestep=timestep,
            options=tuple(options.items()),
        )
        if case not in known:
            known[case] = evaluate(case)
        return known[case]

    return evaluate_once


@pytest.fixture(scope="session")
def stepped() -> Stepper:
    """Return a function that settles a case and hands over every single step of it."""

    def step(case: Case, steps: int) -> Trajectory:
        chosen = engine(case.engine)
        pose, twist = release_state(case.scene.can, case.scene.release)
        _, pose = settle(chosen.open(case), case.scene, pose, twist)
        world = chosen.open(case)
        world.place(pose, twist)
        rows = []
        for _ in range(steps):
            pose, twist = world.pose(), world.twist()
            world.step()
            rows.append((pose, twist, world.contact()))
        return Trajectory(
            time=np.arange(steps) * world.timestep,
            position=np.array([pose.position for pose, _, _ in rows]),
            quaternion=np.array([pose.quaternion for pose, _, _ in rows]),
            velocity=np.array([twist.velocity for _, twist, _ in rows]),
            angular_velocity=np.array([twist.angular_velocity for _, twist, _ in rows]),
            contact_point=np.array([contact.point for _, _, contact in rows]),
            contact_force=np.array([contact.force for _, _, contact in rows]),
            penetration=np.array([contact.penetration for _, _, contact in rows]),
            contact_count=np.array([contact.count for _, _, contact in rows]),
        )

    return step


@pytest.fixture(scope="session")
def made() -> Trajectories:
    """Return a function that makes a trajectory of n samples, with the fields that are given."""

    def make(samples: int, **given: np.ndarray) -> Trajectory:
        ones = np.ones(samples)
        fields = {
            "time": np.arange(samples, dtype=float),
            "position": np.zeros((samples, 3)),
            "quaternion": np.outer(ones, (1.0, 0.0, 0.0, 0.0)),
            "velocity": np.zeros((samples, 3)),
            "angular_velocity": np.zeros((samples, 3)),
            "contact_point": np.zeros((samples, 3)),
            "contact_force": np.outer(ones, (0.0, 0.0, 1.0)),
            "penetration": np.zeros(samples),
            "contact_count": np.ones(samples, dtype=np.int64),
        }
        return Trajectory(**(fields | given))

    return make
