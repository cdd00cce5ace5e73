"""Runs of engines that several tests look at."""

import math
from functools import cache

import numpy as np

from harness.core.case import Case, Value
from harness.core.trajectory import Trajectory
from harness.engines.stepping.settling import settle
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from models import Scene, load, release_state
from tests.support.engines import stepping_engine


def evaluated(
    scene: Scene | str,
    name: str,
    timestep: float | None = None,
    profile: str = "matched",
    **options: Value,
) -> Evaluation:
    """Return a case evaluated, once in a process."""
    return _evaluate_once(
        Case(
            scene=load(scene) if isinstance(scene, str) else scene,
            engine=name,
            profile=profile,
            timestep=timestep,
            options=tuple(options.items()),
        )
    )


_evaluate_once = cache(evaluate)


def turn_error(case: Case) -> float:
    """Return the error of the first angle of turn of a case, deg."""
    found = evaluate(case).errors
    assert found is not None
    return math.degrees(found.angle_of_turn[0])


def stepped(case: Case, steps: int) -> Trajectory:
    """Settle a case and return every single step of it."""
    chosen = stepping_engine(case.engine)
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
