"""Consecutive steps of PyBullet: looked at as often as the recorder needs it, and no more.

There is no batched stepping: each step is a call, and so is each of the three readings, which
together cost more than the step. So most steps of a slow motion are taken without a look; `Looks`
says which. What PyBullet says is kept as it says it, and understood chunk by chunk; the contacts
that a step leaves are paired with the state before it.
"""

from collections.abc import Sequence
from itertools import chain, repeat
from typing import TypeAlias

import numpy as np
import pybullet

from harness.core.trajectory import Floats, Integers, Trajectory
from harness.engines.pybullet.world import ContactPoint, PybulletWorld, resultant
from harness.engines.stepping.recording import Chunk, Looks
from harness.engines.stepping.schedule import Stage

_ROWS_PER_CONTACT = 3  # the normal and two directions of friction
_STATE = 13  # numbers of a state: position, quaternion, velocity, angular velocity
_POINT = 19  # numbers of a contact point that matter, in PyBullet's order
_NONE = (0.0,) * _POINT
_State: TypeAlias = tuple[tuple[float, ...], ...]


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
        self._taken, self._parts = 0, 1
        self._places: list[int] = []
        self._spans: list[int] = []
        self._states: list[_State] = []
        self._contacts: list[tuple[ContactPoint, ...]] = []

    def reach(self, size: int) -> bool:
        """Whether so many steps are taken, and any of them was looked at."""
        return self._taken >= size and len(self._places) > 0

    def take(self, world: PybulletWorld, stage: Stage) -> None:
        """Take the steps of a stage, looking at the state before a step and the contacts after."""
        client, can, ground = world.client, world.can, world.ground
        self._parts = world.parts
        step, pose_of = world.stepper(stage.times), pybullet.getBasePositionAndOrientation
        velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
        centred = world.reading
        state, touch = self._states.append, self._contacts.append
        here, stand = self._places.append, self._spans.append
        timestep, count, last = stage.timestep, len(stage.times), stage.ahead - 1
        looks, place, left = self._looks, 0, 0
        sparing = looks is not None and looks.spare(timestep)
        if looks is not None:
            place, left = min(looks.left, count), max(looks.left - count, 0)
        for _ in repeat(None, place):
            step(client)
        while place < count:
            position, quaternion = pose_of(can, client)
            velocity, spin = velocity_of(can, client)
            if centred is not None:
                position, quaternion, velocity, spin = centred(position, quaternion, velocity, spin)
            step(client)
            touch(contacts_of(can, ground, physicsClientId=client))
            state((position, quaternion, velocity, spin))
            here(self._taken + place)
            after = place + 1
            if sparing and place < last:
                # the last step of all is looked at, whatever the motion
                after = min(place + looks.pause(quaternion, spin, timestep), last)  # type: ignore[union-attr]
            stand(after - place)
            if after > count:
                left = after - count
            for _ in repeat(None, min(after, count) - place - 1):
                step(client)
            place = after
        if looks is not None:
            looks.left = left
        self._times.append(stage.times)
        self._taken += count

    def chunk(self) -> Chunk:
        """Return what was looked at as a chunk."""
        times = np.concatenate(self._times)[self._places]
        numbers = chain.from_iterable(self._states)
        states = np.fromiter(chain.from_iterable(numbers), np.float64).reshape(-1, _STATE)
        quaternions = states[:, [6, 3, 4, 5]]
        good = np.isfinite(states).all(axis=1)
        count = len(states) if np.all(good) else int(np.argmin(good))
        contacts = np.fromiter(map(len, self._contacts), np.int64)
        contacts[count:] = 0

        def read(keep: Integers) -> Trajectory:
            point, force, depth, bearing = _resultants([self._contacts[n] for n in keep.tolist()])
            return Trajectory(
                time=times[keep],
                position=states[keep, :3],
                quaternion=quaternions[keep],
                velocity=states[keep, 7:10],
                angular_velocity=states[keep, 10:13],
                contact_point=point,
                contact_force=force * self._parts,
                penetration=depth,
                contact_count=bearing,
            )

        return Chunk(
            times=times,
            quaternions=quaternions[:count],
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
