"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; both are put at the same instant here. Forces and the locus come from MuJoCo's contact
sensors.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
from mujoco import rollout

from harness.case import Case, Value
from harness.engines.base import Capabilities, Floats
from harness.engines.chunk import Chunk
from harness.engines.mujoco.gaps import EFFORTS, GAPS
from harness.engines.mujoco.settings import DEFAULT_TIMESTEP, MATCHED_TIMESTEP, SETTINGS
from harness.engines.mujoco.world import MujocoWorld, from_body
from harness.engines.schedule import Schedule, Stage
from harness.engines.stepping import PhysicsEngine
from harness.trajectory import Integers, Trajectory

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class MujocoEngine(PhysicsEngine[MujocoWorld]):
    """MuJoCo: soft contact by convex optimisation, generalised coordinates."""

    name = "mujoco"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
    gaps = GAPS
    efforts = EFFORTS
    capabilities = Capabilities(
        honours=frozenset({"slip"}),
        imposes={
            "compliance": "contact is soft: it yields by solref and solimp, and so does friction",
        },
    )
    imposed_by_default = frozenset[str]()

    @property
    def version(self) -> str:
        """The version of MuJoCo."""
        return str(mujoco.mj_versionString())

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case.

        MuJoCo raises a coefficient of friction of zero to 1e-5, so that a frictionless plane needs
        a contact without friction, unless the case says otherwise.
        """
        chosen, slip = super().resolve(case), case.scene.effects.slip
        if slip is not None and slip.mu == 0.0 and "condim" not in dict(case.options):
            chosen["condim"] = 1
        return chosen

    def open(self, case: Case) -> MujocoWorld:
        """Compile the scene of a case."""
        return MujocoWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: MujocoWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        data = world.data
        state = np.empty(mujoco.mj_stateSize(world.model, _STATE))
        mujoco.mj_getState(world.model, data, state, _STATE)
        stage = _next(schedule, state)
        while stage is not None:
            befores, sensors, times = [], [], []
            count = 0
            while stage is not None and count < size:
                world.set_timestep(stage.timestep)
                after, seen = rollout.rollout(
                    world.model,
                    data,
                    state[None],
                    nstep=len(stage.times),
                    initial_warmstart=data.qacc_warmstart.copy()[None],
                )
                befores += [state[None], after[0, :-1]]
                sensors.append(seen[0])
                times.append(stage.times)
                count += len(stage.times)
                state = after[0, -1]
                stage = _next(schedule, state)
            yield _chunk(
                world, np.concatenate(times), np.concatenate(befores), np.concatenate(sensors)
            )


def _next(schedule: Schedule, state: Floats) -> Stage | None:
    """Return the stage that a state calls for."""
    spin = np.empty(3)
    mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
    return schedule.next(state[4:8].tolist(), spin.tolist())


def _chunk(world: MujocoWorld, times: Floats, states: Floats, sensors: Floats) -> Chunk:
    """Return the steps from states (n, 14) with the sensors of the same instants (n, 17)."""
    count = _sound(states)
    contacts = sensors[:, 0].copy()
    contacts[count:] = 0.0

    def read(keep: Integers) -> Trajectory:
        return _read(world, times[keep], states[keep], sensors[keep])

    return Chunk(
        times=times,
        quaternions=states[:count, 4:8],
        constraint_rows=contacts.astype(np.int64) * world.rows_per_contact,
        sound=count == len(states) and not _unstable(world.data),
        read=read,
    )


_BROKEN = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


def _unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo itself has found its numbers to be none, or huge."""
    return any(data.warning[kind].number for kind in _BROKEN)


def _sound(states: Floats) -> int:
    """Return how many of the states, from the first on, are states: finite, and time goes on."""
    # a sum is finite only if all of its terms are; one that overflows is no state either
    if np.isfinite(states.sum()) and (np.diff(states[:, 0]) > 0.0).all():
        return len(states)
    good = np.isfinite(states).all(axis=1)
    good &= np.diff(states[:, 0], prepend=-np.inf) > 0.0
    return int(np.argmin(good))


def _read(world: MujocoWorld, times: Floats, states: Floats, sensors: Floats) -> Trajectory:
    """Return states and the sensors of the same instants as a trajectory."""
    point, force, penetration, count = world.read_contact(sensors)
    quaternion = states[:, 4:8]
    return Trajectory(
        time=times,
        position=states[:, 1:4],
        quaternion=quaternion,
        velocity=states[:, 8:11],
        angular_velocity=from_body(quaternion, states[:, 11:14]),
        contact_point=point,
        contact_force=force,
        penetration=penetration,
        contact_count=count.astype(np.int64),
    )
