"""Consecutive steps of PyBullet: looked at as often as the recorder needs it, and no more.

There is no batched stepping: each step is a call, and so is each of the three readings, which
together cost more than the step. So most steps of a slow motion are taken without a look; `Looks`
says which. What PyBullet says is kept as it says it, and understood chunk by chunk; the contacts
that a step leaves are paired with the state before it.
"""

from collections.abc import Sequence
from itertools import chain, repeat

import numpy as np
import pybullet

from harness.core.trajectory import Floats, Integers, Trajectory
from harness.engines.pybullet.world import ContactPoint, Numbers, PybulletWorld, State, resultant
from harness.engines.stepping.generic_stepping import take_stage
from harness.engines.stepping.recording import Chunk, Looks, trajectory_of
from harness.engines.stepping.schedule import Stage

_ROWS_PER_CONTACT = 3  # the normal and two directions of friction
_STATE = 13  # numbers of a state: position, quaternion, velocity, angular velocity
_POINT = 19  # numbers of a contact point that matter, in PyBullet's order
_NONE = (0.0,) * _POINT


class Steps:
    """The states before consecutive steps that were looked at, and the contacts that they solved.

    Parameters
    ----------
    looks : Looks or None
        Of the run; None looks at every step.
    """

    def __init__(self, looks: Looks | None) -> None:
        self._looks = looks
        self._times: list[Floats] = []
        self._parts = 1
        self._spans: list[int] = []
        self._states: list[State] = []
        self._contacts: list[tuple[ContactPoint, ...]] = []
        self.taken = 0

    def take(self, world: PybulletWorld, stage: Stage) -> None:
        """Take the steps of a stage, looking at the state before a step and the contacts after."""
        client, can, ground, centred = world.client, world.can, world.ground, world.reading
        step, pose_of = world.stepper(stage.times), pybullet.getBasePositionAndOrientation
        velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
        keep, touch = self._states.append, self._contacts.append

        def look() -> tuple[Numbers, Numbers]:
            position, quaternion = pose_of(can, client)
            velocity, spin = velocity_of(can, client)
            if centred is not None:
                position, quaternion, velocity, spin = centred(position, quaternion, velocity, spin)
            step(client)
            touch(contacts_of(can, ground, physicsClientId=client))
            keep((position, quaternion, velocity, spin))
            return quaternion, spin

        def skip(steps: int) -> None:
            for _ in repeat(None, steps):
                step(client)

        places, spans = take_stage(stage, self._looks, look, skip)
        self._parts = world.parts
        self._times.append(stage.times[places])
        self._spans += spans
        self.taken += len(stage.times)

    @property
    def seen(self) -> bool:
        """Whether any step was looked at."""
        return len(self._states) > 0

    def chunk(self) -> Chunk:
        """Return what was looked at as a chunk."""
        times, numbers = np.concatenate(self._times), chain.from_iterable(self._states)
        states = np.fromiter(chain.from_iterable(numbers), np.float64).reshape(-1, _STATE)
        states[:, 3:7] = states[:, [6, 3, 4, 5]]
        good = np.isfinite(states).all(axis=1)
        count = len(states) if np.all(good) else int(np.argmin(good))
        contacts = np.fromiter(map(len, self._contacts), np.int64)
        contacts[count:] = 0

        def read(keep: Integers) -> Trajectory:
            point, force, depth, bearing = _resultants([self._contacts[n] for n in keep.tolist()])
            return trajectory_of(
                times[keep], states[keep], (point, force * self._parts, depth, bearing)
            )

        return Chunk(
            times=times,
            quaternions=states[:count, 3:7],
            constraint_rows=contacts * _ROWS_PER_CONTACT,
            spans=np.array(self._spans),
            sound=count == len(states),
            read=read,
        )


def _resultants(
    contacts: Sequence[tuple[ContactPoint, ...]],
) -> tuple[Floats, Floats, Floats, Integers]:
    """Return point (n, 3), force (n, 3), depth (n,) and bearing points (n,) of some steps."""
    single = [_numbers(*points) if len(points) == 1 else _NONE for points in contacts]
    p = np.array(single).reshape(-1, _POINT)
    normal = p[:, 10:11]
    bears = normal[:, 0] > 0.0
    # weighted and divided again, as of several points, so that both ways give the same bits
    weighted = normal * (p[:, 0:3] + p[:, 3:6]) / 2.0
    point = np.divide(weighted, normal, out=np.full_like(weighted, np.nan), where=normal > 0.0)
    force = normal * p[:, 6:9] + p[:, 11:12] * p[:, 12:15] + p[:, 15:16] * p[:, 16:19]
    force[~bears] = 0.0
    depth, bearing = -p[:, 9], bears.astype(np.int64)
    for row, points in enumerate(contacts):
        if len(points) != 1:
            x, y, z, f_x, f_y, f_z, deepest, number, _ = resultant(points)
            point[row], force[row] = (x, y, z), (f_x, f_y, f_z)
            depth[row], bearing[row] = deepest, int(number)
    return point, force, depth, bearing


def _numbers(p: ContactPoint) -> tuple[float, ...]:
    """Return the numbers of a contact point that matter, in PyBullet's order."""
    return (*p[5], *p[6], *p[7], p[8], p[9], p[10], *p[11], p[12], *p[13])
