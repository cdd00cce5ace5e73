"""Consecutive steps of PyBullet: read in the leanest way there is, understood when looked at.

There is no batched stepping: each step is a call, and so is each of the three readings. Their
numbers go into flat arrays at once, since millions of tuples kept alive would keep the garbage
collector busy; the contacts that a step leaves are paired with the state before it.
"""

from array import array
from typing import Any

import numpy as np
import pybullet

from harness.engines.chunk import Chunk
from harness.engines.pybullet.world import PybulletWorld, resultant
from harness.trajectory import Floats, Integers, Trajectory

_ROWS_PER_CONTACT = 3  # the normal and two directions of friction
_STATE = 13  # numbers of a state: position, quaternion, velocity, angular velocity
_POINT = 19  # numbers of a contact point that matter, in PyBullet's order
_NONE = (0.0,) * _POINT


class Steps:
    """The states before consecutive steps, and the contacts that the steps solved."""

    def __init__(self) -> None:
        self._states = array("d")
        self._points = array("d")
        self._counts = array("q")
        self._several: dict[int, tuple[tuple[Any, ...], ...]] = {}

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self._counts)

    def take(self, world: PybulletWorld, count: int) -> None:
        """Step so many times, reading the state before each step and the contacts after it."""
        client, can, ground = world.client, world.can, world.ground
        step, pose_of = pybullet.stepSimulation, pybullet.getBasePositionAndOrientation
        velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
        state, points, counts = self._states.extend, self._points.extend, self._counts.append
        for _ in range(count):
            position, quaternion = pose_of(can, client)
            velocity, spin = velocity_of(can, client)
            step(client)
            contacts = contacts_of(can, ground, physicsClientId=client)
            state(position)
            state(quaternion)
            state(velocity)
            state(spin)
            if len(contacts) == 1:
                (p,) = contacts
                points((*p[5], *p[6], *p[7], p[8], p[9], p[10], *p[11], p[12], *p[13]))
            else:
                self._several[len(self._counts)] = contacts
                points(_NONE)
            counts(len(contacts))

    def chunk(self, times: Floats) -> Chunk:
        """Return the steps as a chunk, with the times before each of them."""
        states = np.frombuffer(self._states).reshape(-1, _STATE)
        quaternions = states[:, [6, 3, 4, 5]]
        good = np.isfinite(states).all(axis=1)
        count = len(self) if np.all(good) else int(np.argmin(good))
        contacts = np.array(self._counts, dtype=np.int64)
        contacts[count:] = 0

        def read(keep: Integers) -> Trajectory:
            point, force, depth, bearing = self._contacts(keep)
            return Trajectory(
                time=times[keep],
                position=states[keep, :3],
                quaternion=quaternions[keep],
                velocity=states[keep, 7:10],
                angular_velocity=states[keep, 10:13],
                contact_point=point,
                contact_force=force,
                penetration=depth,
                contact_count=bearing,
            )

        return Chunk(
            times=times,
            quaternions=quaternions[:count],
            constraint_rows=contacts * _ROWS_PER_CONTACT,
            sound=count == len(self),
            read=read,
        )

    def _contacts(self, keep: Integers) -> tuple[Floats, Floats, Floats, Integers]:
        """Return point (n, 3), force (n, 3), depth (n,) and bearing points (n,) of some steps."""
        p = np.frombuffer(self._points).reshape(-1, _POINT)[keep]
        normal = p[:, 10:11]
        bears = normal[:, 0] > 0.0
        # weighted and divided again, as of several points, so that both ways give the same bits
        weighted = normal * (p[:, 0:3] + p[:, 3:6]) / 2.0
        point = np.divide(weighted, normal, out=np.full_like(weighted, np.nan), where=normal > 0.0)
        force = normal * p[:, 6:9] + p[:, 11:12] * p[:, 12:15] + p[:, 15:16] * p[:, 16:19]
        force[~bears] = 0.0
        depth, bearing = -p[:, 9], bears.astype(np.int64)
        for row, place in enumerate(keep.tolist()):
            if place in self._several:
                x, y, z, f_x, f_y, f_z, deepest, number, _ = resultant(self._several[place])
                point[row], force[row] = (x, y, z), (f_x, f_y, f_z)
                depth[row], bearing[row] = deepest, int(number)
        return point, force, depth, bearing
