"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; both are put at the same instant here. Forces and the locus come from MuJoCo's contact
sensors.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

from harness.case import Case, Value
from harness.engines.base import Capabilities, Floats
from harness.engines.mujoco.settings import DEFAULT_TIMESTEP, MATCHED_TIMESTEP, SETTINGS
from harness.engines.mujoco.world import MujocoWorld, from_body
from harness.engines.stepping import Chunk, PhysicsEngine
from harness.trajectory import Trajectory

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class MujocoEngine(PhysicsEngine[MujocoWorld]):
    """MuJoCo: soft contact by convex optimisation, generalised coordinates."""

    name = "mujoco"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
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

    def chunks(self, world: MujocoWorld, steps: int, size: int) -> Iterator[Chunk]:
        """Step so many times from where the world is, at most `size` steps a chunk."""
        model, data = world.model, world.data
        state = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, state, _STATE)
        for done in range(0, steps, size):
            after, sensors = rollout.rollout(
                model,
                data,
                state[None],
                nstep=min(size, steps - done),
                initial_warmstart=data.qacc_warmstart.copy()[None],
            )
            before = np.vstack((state, after[0, :-1]))
            sound = _sound(before)
            count = np.where(sound, sensors[0, :, 0], 0.0)
            yield Chunk(
                trajectory=_read(world, before[sound], sensors[0, sound], done)
                if sound.any()
                else None,
                constraint_rows=count.astype(np.int64) * world.rows_per_contact,
                sound=bool(sound.all()) and not _unstable(data),
            )
            state = after[0, -1]


_BROKEN = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


def _unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo itself has found its numbers to be none, or huge."""
    return any(data.warning[kind].number for kind in _BROKEN)


def _sound(states: Floats) -> NDArray[np.bool_]:
    """Return which of the states, from the first to the last good one, are states, shape (n,)."""
    going_on = np.concatenate((np.ones(1, dtype=np.bool_), np.diff(states[:, 0]) > 0.0))
    good = np.isfinite(states).all(axis=1) & going_on
    return np.logical_and.accumulate(good)


def _read(world: MujocoWorld, states: Floats, sensors: Floats, done: int) -> Trajectory:
    """Return states (n, 14) and the sensors of the same instants (n, 17) as a trajectory."""
    point, force, penetration, count = world.read_contact(sensors)
    quaternion = states[:, 4:8]
    return Trajectory(
        # counted, not summed: the engine's own clock drifts by round-off
        time=np.arange(done, done + len(states)) * np.float64(world.timestep),
        position=states[:, 1:4],
        quaternion=quaternion,
        velocity=states[:, 8:11],
        angular_velocity=from_body(quaternion, states[:, 11:14]),
        contact_point=point,
        contact_force=force,
        penetration=penetration,
        contact_count=count.astype(np.int64),
    )
