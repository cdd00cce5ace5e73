"""Steps of MuJoCo in C: the states before them, with the sensors of the same instants.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; both are put at the same instant. Forces and the locus come from MuJoCo's contact
sensors.

At a fine timestep hundreds of steps pass between two samples, and `mujoco.rollout` writes the state
and the sensors of each. For a slow motion MuJoCo therefore steps from reading to reading in C and
writes nothing, with its sensors off, which no step depends on: the same steps, fewer numbers.
"""

from functools import partial
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from harness.engines import (
    Chunk,
    Fixed,
    Floats,
    Integers,
    SamplingInterval,
    Schedule,
    Stage,
    take_stage,
)
from harness.engines.mujoco.compiled_scene import chunk_of
from harness.engines.mujoco.world import MujocoWorld

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
"""Which state of MuJoCo: time, qpos and qvel, 14 numbers for a can."""


def control(world: MujocoWorld, times: Floats) -> dict[str, Any]:
    """Return the arguments of `mujoco.rollout` for the steps from these times (n,) on."""
    forces = world.forces(times)
    if forces is None:
        return {"nstep": len(times)}
    return {"control": forces[None], "control_spec": mujoco.mjtState.mjSTATE_XFRC_APPLIED}


def chunk_of_states(
    world: MujocoWorld,
    times: Floats,
    states: Floats,
    sensors: Floats,
    spans: Integers | None = None,
) -> Chunk:
    """Return the steps from states (n, 14) with the sensors of the same instants (n, 8).

    Where not every step was read, `spans` says for how many each stands.
    """
    count, sound = _sound(states), not _unstable(world.data)
    return chunk_of(world, times, states, sensors, count=count, sound=sound, spans=spans)


_BROKEN = [
    int(mujoco.mjtWarning.mjWARN_BADQPOS),
    int(mujoco.mjtWarning.mjWARN_BADQVEL),
    int(mujoco.mjtWarning.mjWARN_BADQACC),
]


def _unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo itself has warned of numbers that are not finite, or huge."""
    return bool(data.warning.number[_BROKEN].any())


def _sound(states: Floats) -> int:
    """Return how many states from the first on are valid: finite, at increasing times."""
    # without autoreset a number that breaks stays broken: the last state speaks for all before it;
    # time that has stopped starts again with the next stage, whose warnings MuJoCo has cleared
    if np.isfinite(states[-1]).all() and (states[1:, 0] > states[:-1, 0]).all():
        return len(states)
    good = np.isfinite(states).all(axis=1)
    good &= np.diff(states[:, 0], prepend=-np.inf) > 0.0
    return int(np.argmin(good))


WORTH_IT = 32
"""Steps between two readings, where no angle moves, from which reading less often pays: a reading
costs what three steps do."""

SENSORS_OFF = int(mujoco.mjtDisableBit.mjDSBL_SENSOR)


def sparse_sampling(world: MujocoWorld, schedule: Schedule) -> SamplingInterval | None:
    """Return the sampling interval of a run of which few steps are read; None to read every step.

    Every step is read where forces change from step to step: MuJoCo takes those in its batched loop
    alone.
    """
    sampling = schedule.sampling
    if sampling is None or not isinstance(schedule, Fixed) or world.forces(np.zeros(1)) is not None:
        return None
    return sampling if sampling.steps(schedule.largest) >= WORTH_IT else None


def state_of(world: MujocoWorld) -> Floats:
    """Return the state of MuJoCo, shape (14,)."""
    state = np.empty(mujoco.mj_stateSize(world.model, STATE))
    mujoco.mj_getState(world.model, world.data, state, STATE)
    return state


_NOTHING, _ROOM = np.empty((1, 0, 0)), 16384  # steps


class MujocoSteps:
    """Steps a world in C; holds the states before the steps that it reads, with their sensors.

    Parameters
    ----------
    world : MujocoWorld
    sampling : SamplingInterval or None
        Of a run of which most steps are not read; None reads every step.
    """

    def __init__(self, world: MujocoWorld, sampling: SamplingInterval | None) -> None:
        self._world, self._sampling = world, sampling
        self._state = state_of(world)
        self._model, self._data = [world.model], [world.data]
        # one for the run: each that MuJoCo makes for a call costs as much as two steps
        # which releases before 3.3 cannot
        own = getattr(rollout, "Rollout", None)
        self._rollout = rollout.rollout if own is None else own(nthread=0).rollout
        self._times: list[Floats] = []
        self._states = self._sensors = _NOTHING
        self._held = 0
        self._clock: list[float] = []
        self._motion, self._sensed = bytearray(), bytearray()
        self._spans: list[Integers] = []

    def state(self) -> tuple[list[float], list[float]]:
        """Return quaternion (scalar first) and angular velocity; fixed steps do not ask for it."""
        spin = np.empty(3)
        mujoco.mju_rotVecQuat(spin, self._state[11:14], self._state[4:8])
        return self._state[4:8].tolist(), spin.tolist()

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage."""
        if self._sampling is not None:
            self._take_sparsely(stage, self._sampling)
        else:
            self._roll(stage)
        return True

    def _roll(self, stage: Stage) -> None:
        """Step through a stage in one call of MuJoCo, which writes a reading of every step."""
        world, count = self._world, len(stage.times)
        states, sensors = self._room(count)
        world.set_timestep(stage.timestep)
        self._rollout(
            self._model,
            self._data,
            self._state[None],
            **{"nstep": count} | control(world, stage.times),
            initial_warmstart=world.data.qacc_warmstart.copy()[None],
            state=states[:, 1:],
            sensordata=sensors,
            skip_checks=True,  # they and their copies cost what twenty steps do
        )
        self._state = states[0, -1]
        self._times.append(stage.times)
        self._held += count

    def _room(self, count: int) -> tuple[Floats, Floats]:
        """Return where to write states, after the one from which they go on, and sensors."""
        held = self._held
        if held + count >= self._states.shape[1]:
            states = np.empty((1, max(held + count, _ROOM) + 1, len(self._state)))
            sensors = np.empty((1, states.shape[1], self._world.model.nsensordata))
            if held:
                states[:, :held] = self._states[:, :held]
                sensors[:, :held] = self._sensors[:, :held]
            self._states, self._sensors = states, sensors
        self._states[0, held] = self._state
        return self._states[:, held : held + count + 1], self._sensors[:, held : held + count]

    def _take_sparsely(self, stage: Stage, sampling: SamplingInterval) -> None:
        """Step through a stage with sensors in the steps that are read; hold these."""
        model, data, option = self._world.model, self._world.data, self._world.model.opt
        seen, step = int(option.disableflags), mujoco.mj_step
        # views of MuJoCo's own memory; a reading copies bytes, which is the least that keeps it
        motion, clock, sensors = self._motion.extend, self._clock.append, data.sensordata
        place, rate, spin = data.qpos, data.qvel, np.empty(3)
        quaternion, turning, sensed = place[3:], rate[3:], self._sensed.extend

        def read_and_step(steps: int) -> tuple[list[float], list[float]]:
            for _ in range(steps):
                clock(data.time)
                motion(place.tobytes())
                motion(rate.tobytes())
                mujoco.mju_rotVecQuat(spin, turning, quaternion)
                w, x, y, z = quaternion.tolist()
                option.disableflags = seen
                step(model, data)
                option.disableflags = unseen
                sensed(sensors.tobytes())
            return [x, y, z, w], spin.tolist()

        unseen = seen | SENSORS_OFF
        option.disableflags = unseen
        places, spans = take_stage(stage, sampling, read_and_step, partial(step, model, data))
        option.disableflags = seen
        if len(places) > 0:
            self._spans.append(spans)
            self._times.append(stage.times[places])

    def chunk(self) -> Chunk | None:
        """Return the readings since the last chunk; None without any."""
        if not self._times:
            return None
        times, spans = np.concatenate(self._times), None
        if self._sampling is None:
            states, sensors = self._states[0, : self._held], self._sensors[0, : self._held]
        else:
            states = np.empty((len(times), len(self._state)))
            states[:, 0] = self._clock
            states[:, 1:] = np.frombuffer(self._motion).reshape(len(times), -1)
            sensors = np.frombuffer(self._sensed).reshape(len(times), -1)
            spans = np.concatenate(self._spans)
        # they belong to the chunk now
        self._times, self._held, self._states, self._sensors = [], 0, _NOTHING, _NOTHING
        self._clock, self._motion, self._sensed = [], bytearray(), bytearray()
        self._spans = []
        return chunk_of_states(self._world, times, states, sensors, spans)
