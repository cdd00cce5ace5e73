"""Engines that take MuJoCo's compiled model and step it in a compiled loop over arrays.

One call takes many steps and hands over the state before each of them with the sensors of that
state, as rows of two arrays. What such an engine computes in single precision is handed over in
double, its quaternion of unit length to double precision.
"""

from abc import abstractmethod
from collections.abc import Iterator
from typing import TypeVar

import mujoco
import numpy as np

from harness.engines import (
    SMALLEST_TILT,
    Case,
    Chunk,
    Collision,
    Contact,
    Floats,
    PhysicsEngine,
    Precision,
    Schedule,
    Stage,
    Value,
    rim_within,
    step_by_stages,
)
from harness.engines.mujoco import settings as declared
from harness.engines.mujoco.colliders import CYLINDER_ON_PLANE
from harness.engines.mujoco.compiled_scene import CompiledScene, chunk_of
from models.kinematics import to_body, to_world
from models.state import Pose, Twist


class ArrayWorld(CompiledScene):
    """One can on one plane, stepped many times in one call; an adapter calls `begin`."""

    real: type[np.float32 | np.float64]
    """Of the numbers that the engine computes with."""
    _given: Floats | None
    """qpos and qvel to start from, shape (13,); None to go on."""
    _sensors: Floats
    """Of the state before the last step, shape (1, 8)."""

    def begin(self) -> None:
        """Put the can where the model file has it, at rest."""
        self._hold(np.concatenate((self.model.qpos0, np.zeros(6))))

    def _hold(self, state: Floats) -> None:
        """Take qpos and qvel, shape (13,), as the engine can hold them."""
        self._given = state.astype(self.real).astype(np.float64)
        self._state = self._given.copy()
        _normalise(self._state)
        self._time = 0.0

    @abstractmethod
    def advance(self, state: Floats | None, forces: Floats | None, steps: int) -> Floats:
        """Take steps; return a row of numbers for each and one of the state after the last.

        Parameters
        ----------
        state : ndarray, shape (13,), or None
            qpos and qvel to start from, with nothing left of what was before; None to go on. The
            first call has a state.
        forces : ndarray, shape (steps, 3), or None
            On the centre of mass, N, one for each step.
        steps : int

        Returns
        -------
        ndarray, shape (steps + 1, 21)
            qpos and qvel before each step, and the sensors of that state; of the last row the
            sensors mean nothing.
        """

    @abstractmethod
    def collision(self) -> Collision:
        """Return the points where the can touches, and those above the plane, without a step."""

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m.

        Of other shapes that do not overlap such an engine has no distance: it is MuJoCo's.
        """
        if self._shapes != CYLINDER_ON_PLANE:
            data = mujoco.MjData(self.model)
            data.qpos[:] = self._state[:7]
            return self.distance(data)
        return -float(self.collision().depths.max())

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        spin = to_body(pose.quaternion, twist.angular_velocity)
        self._hold(np.concatenate((pose.position, pose.quaternion, twist.velocity, spin)))

    def pushes(self, times: Floats) -> Floats | None:
        """Return the forces on the centre of mass from these times (n,) on, N; None without any."""
        applied = self.forces(times)
        return None if applied is None else applied.reshape(len(times), -1, 6)[:, self._body, :3]

    def roll(self, times: Floats) -> tuple[Floats, Floats]:
        """Step from each of these times (n,); return the states before (n, 13), sensors (n, 8)."""
        rows = self.advance(self._given, self.pushes(times), len(times))
        _normalise(rows)
        self._state, self._sensors = rows[-1, :13], rows[-2:-1, 13:]
        self._time, self._given = float(times[-1]) + self.timestep, None
        return rows[:-1, :13], rows[:-1, 13:]

    def step(self) -> None:
        """Advance by one timestep."""
        self.roll(np.array([self._time]))

    @property
    def state(self) -> tuple[Floats, Floats]:
        """Quaternion, scalar first, and angular velocity in world coordinates; may be NaN."""
        return self._state[3:7], to_world(self._state[3:7], self._state[10:])

    @property
    def spin(self) -> Floats:
        """Angular velocity in the body's frame, rad/s, shape (3,)."""
        return self._state[10:]

    def pose(self) -> Pose:
        """Return where the can is."""
        return Pose(position=self._state[:3], quaternion=self._state[3:7])

    def twist(self) -> Twist:
        """Return how the can moves."""
        return Twist(velocity=self._state[7:10], angular_velocity=self.state[1])

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        point, force, penetration, count = self.read_contact(self._sensors)
        return Contact(
            point=point[0],
            force=force[0],
            penetration=float(penetration[0]),
            count=int(count[0]),
        )


def _normalise(rows: Floats) -> None:
    """Give the quaternions in rows, shape (..., 13 or more), unit length to double precision."""
    with np.errstate(all="ignore"):  # numbers that broke are found by who reads them
        rows[..., 3:7] /= np.linalg.norm(rows[..., 3:7], axis=-1, keepdims=True)


class ArraySteps:
    """Steps a world stage by stage, a stage in one call, and holds the rows of one stage or more.

    Parameters
    ----------
    world : ArrayWorld
    """

    def __init__(self, world: ArrayWorld) -> None:
        self._world = world
        self._parts: list[tuple[Floats, Floats, Floats]] = []
        self._sound = True

    def state(self) -> tuple[list[float], list[float]]:
        """Return quaternion (scalar first) and angular velocity, which choose the next stage."""
        quaternion, spin = self._world.state
        return quaternion.tolist(), spin.tolist()

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage; return False where its numbers broke."""
        self._world.set_timestep(stage.timestep)
        self._parts.append((stage.times, *self._world.roll(stage.times)))
        self._sound = all(np.isfinite(numbers).all() for numbers in self._world.state)
        return self._sound

    def chunk(self) -> Chunk | None:
        """Return the rows since the last chunk; None without any."""
        if not self._parts:
            return None
        times, states, sensors = map(np.concatenate, zip(*self._parts, strict=True))
        self._parts = []
        good = np.isfinite(states).all(axis=1)
        count = len(states) if good.all() else int(np.argmin(good))
        return chunk_of(self._world, times, states, sensors, count=count, sound=self._sound)


_ROUNDINGS = 10.0
"""Of the direction to the rim: five are the most that was found of any can."""

RIM_DIRECTION = (
    "near the vertical the direction to the lowest point of the rim is a difference of nearly "
    "equal vectors: in single precision the contact is off by some 1e-7 R/phi"
)
"""What it adds to every can."""

W = TypeVar("W", bound=ArrayWorld)


class ArrayEngine(PhysicsEngine[W]):
    """An engine that takes MuJoCo's compiled model and steps it in a compiled loop."""

    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which the engine goes its own way in a case.

        In single precision the rim is known to R eps/phi, at the smallest tilt that is probed.
        """
        rows, precision = declared.imposed_in(case, self.resolve(case)), self.precision(case)
        if precision is Precision.DOUBLE:
            return rows
        can, known = case.scene.can, _ROUNDINGS * precision.epsilon / SMALLEST_TILT
        rim = rim_within(can, known * can.bounding_radius)
        return rows | {name: share + rows.get(name, 0.0) for name, share in rim.items()}

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide."""
        return declared.for_effects(case, timestep)

    def chunks(self, world: W, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        return step_by_stages(ArraySteps(world), schedule, size)

    def bare_loop(self, world: W, steps: int) -> None:
        """Step so many times in one call."""
        world.roll(np.arange(steps) * np.float64(world.timestep))
