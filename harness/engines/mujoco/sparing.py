"""Steps of a slow motion, read only where the recorder needs it: the same steps, fewer numbers.

At a fine timestep hundreds of steps pass between two samples. `mujoco.rollout` writes the state and
the sensors of each; here MuJoCo steps from look to look in C and writes nothing, with its sensors
off, which no step depends on.
"""

import mujoco
import numpy as np

from harness.engines.base import Floats
from harness.engines.looks import Looks
from harness.engines.mujoco.chunks import STATE
from harness.engines.mujoco.world import MujocoWorld
from harness.engines.schedule import Fixed, Schedule, Stage
from harness.trajectory import Integers

WORTH_IT = 32
"""Steps between two looks, where no angle moves, from which looking less often pays: a look costs
what three steps do."""

_OFF = int(mujoco.mjtDisableBit.mjDSBL_SENSOR)


def spares(world: MujocoWorld, schedule: Schedule) -> bool:
    """Whether most steps of a run are to be taken without a look.

    Not where forces change from step to step: MuJoCo takes those in its batched loop alone.
    """
    looks = schedule.looks
    still = world.forces(np.zeros(1)) is None
    fixed = looks is not None and isinstance(schedule, Fixed)
    return still and fixed and looks.steps(schedule.largest) >= WORTH_IT  # type: ignore[union-attr]


def glanced(
    world: MujocoWorld, stage: Stage, looks: Looks
) -> tuple[Floats, Floats, Integers, Integers]:
    """Step through a stage from where the world is.

    Returns
    -------
    states, sensors : ndarray, shape (n, 14) and (n, 8)
        Before each of the steps that were looked at.
    places, spans : ndarray of int, shape (n,)
        Which steps these are, and for how many each stands.
    """
    model, data, option = world.model, world.data, world.model.opt
    seen = int(option.disableflags)
    state, spin = np.empty(mujoco.mj_stateSize(model, STATE)), np.empty(3)
    states, sensors, places, spans = [], [], [], []
    count, last = len(stage.times), stage.ahead - 1
    place, left = min(looks.left, count), max(looks.left - count, 0)
    option.disableflags = seen | _OFF
    if place > 0:
        mujoco.mj_step(model, data, nstep=place)
    while place < count:
        mujoco.mj_getState(model, data, state, STATE)
        option.disableflags = seen
        mujoco.mj_step(model, data)
        option.disableflags = seen | _OFF
        states.append(state.copy())
        sensors.append(data.sensordata.copy())
        places.append(place)
        after = place + 1
        if place < last:
            # the last step of all is looked at, whatever the motion
            w, x, y, z = state[4:8].tolist()
            mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
            after = min(place + looks.pause((x, y, z, w), spin.tolist(), stage.timestep), last)
        spans.append(after - place)
        if after > count:
            left = after - count
        unseen = min(after, count) - place - 1
        if unseen > 0:
            mujoco.mj_step(model, data, nstep=unseen)
        place = after
    option.disableflags = seen
    looks.left = left
    rows = np.array(states).reshape(len(states), len(state))
    read = np.array(sensors).reshape(len(states), len(data.sensordata))
    return rows, read, np.array(places, dtype=np.int64), np.array(spans, dtype=np.int64)
