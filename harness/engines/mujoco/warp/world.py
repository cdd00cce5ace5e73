"""A scene in MuJoCo Warp: MuJoCo's compiled model as arrays of Warp, a step as a recorded graph.

A step is some sixty launches of kernels, each of which costs Python more than the processor. They
are captured once, and launched again as one graph; with the first and the last of them, which keep
the state before the step and the sensors of that state, a step needs nothing of Python at all.

A contact that is farther away than the margin is not among MuJoCo Warp's contacts. For distances a
second model has a margin that every can is within.
"""

from collections.abc import Callable, Mapping

import mujoco
import numpy as np
import warp

from harness.engines import Case, Collision, Floats, RefusedModelError, Value
from harness.engines.mujoco.array_stepping import ArrayWorld
from harness.engines.mujoco.colliders import CYLINDER_ON_PLANE
from harness.engines.mujoco.settings import FAINTEST
from harness.engines.suppress_output import silence

warp.config.log_level = warp.LOG_ERROR
with silence():  # Warp is started, which warns on standard error that there is no graphics card
    warp.init()
    import mujoco_warp

_ROWS = 4096
"""Steps between two readings of the arrays."""

_MOST_CONTACTS, _MOST_ROWS = 8, 48
"""Contacts and constraint rows that there is room for: a cylinder on a plane has four contacts,
with ten rows each where it rolls in a pyramid."""

_FAR = 1e3
"""m: a margin within which every can is."""

_FOLLOWING = ("geom_solref", "pair_solref", "pair_solreffriction")
"""Arrays of the model that may change with the timestep."""

_DEVICE = "cpu"


@warp.kernel  # type: ignore[untyped-decorator]
def _before(  # noqa: PLR0917 - as a kernel is launched
    place: warp.array[int],
    body: int,
    forces: warp.array2d[float],
    qpos: warp.array2d[float],
    qvel: warp.array2d[float],
    applied: warp.array2d[warp.spatial_vector],
    rows: warp.array2d[float],
) -> None:
    """Keep the state before a step, and put the forces of the step on the can."""
    at = place[0]
    for i in range(7):
        rows[at, i] = qpos[0, i]
    for i in range(6):
        rows[at, 7 + i] = qvel[0, i]
    force = warp.vec3(forces[at, 0], forces[at, 1], forces[at, 2])
    applied[0, body] = warp.spatial_vector(force, warp.vec3(0.0, 0.0, 0.0))


@warp.kernel  # type: ignore[untyped-decorator]
def _after(
    place: warp.array[int],
    sensors: warp.array2d[float],
    rows: warp.array2d[float],
) -> None:
    """Keep the sensors, which belong to the state before the step, and go on to the next row."""
    at = place[0]
    for i in range(8):
        rows[at, 13 + i] = sensors[0, i]
    place[0] = at + 1


def _captured(launch: Callable[[], None]) -> warp.Graph:
    """Return the graph of what a function launches; it is called once before, and so compiled."""
    launch()
    with warp.ScopedCapture(device=_DEVICE) as capture:
        launch()
    return capture.graph


class WarpWorld(ArrayWorld):
    """One can on one plane in MuJoCo Warp.

    The box that is a ground is small, for a corner of it is a single number of 24 bits.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    half_box = (5.0, 5.0, 1.0)

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        super().__init__(case, chosen, timestep, {})
        self.real = np.float32
        self.begin()
        # as MuJoCo does in each step, and MuJoCo Warp does not
        for friction in (self.model.geom_friction, self.model.pair_friction):
            friction[friction < FAINTEST] = FAINTEST
        try:
            with warp.ScopedDevice(_DEVICE):
                self._put()
        except (NotImplementedError, ValueError) as error:
            raise RefusedModelError(case.engine, case.label(), str(error)) from error
        self._graph: warp.Graph | None = None
        self._far: tuple[mujoco_warp.Data, warp.Graph] | None = None

    def _put(self) -> None:
        """Hand MuJoCo's model over to Warp."""
        self._warp, self._data = self._on_device(self.model)
        self._place = warp.zeros(1, dtype=int)
        self._rows = warp.zeros((_ROWS, 21), dtype=float)
        self._forces = warp.zeros((_ROWS, 3), dtype=float)

    def _on_device(self, model: mujoco.MjModel) -> tuple[mujoco_warp.Model, mujoco_warp.Data]:
        """Return a model and its data as arrays of Warp."""
        data = mujoco.MjData(model)
        room = {"nconmax": _MOST_CONTACTS, "njmax": _MOST_ROWS}
        return mujoco_warp.put_model(model), mujoco_warp.put_data(model, data, **room)

    def of_can(self, field: str) -> Floats:
        """Return what MuJoCo Warp has of the can, by the name of the model's array."""
        value: Floats = getattr(self._warp, field).numpy()[0, self._body].astype(np.float64)
        return value

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on; a contact tied to the timestep goes with it."""
        if timestep != self.timestep:
            super().set_timestep(timestep)
            self._warp.opt.timestep.fill_(timestep)
            for name in _FOLLOWING:
                array = getattr(self._warp, name)
                if array.size:
                    array.assign(getattr(self.model, name)[None].astype(np.float32))

    def _step(self) -> None:
        """Launch the kernels of a step."""
        data, places = self._data, [self._place, self._body, self._forces]
        given = [*places, data.qpos, data.qvel, data.xfrc_applied, self._rows]
        warp.launch(_before, 1, given)
        mujoco_warp.step(self._warp, data)
        warp.launch(_after, 1, [self._place, data.sensordata, self._rows])

    def _start(self, qpos: Floats, qvel: Floats) -> None:
        """Put a state, shapes (1, 7) and (1, 6); a step starts from it and the warm start alone."""
        self._data.qpos.assign(qpos.astype(np.float32))
        self._data.qvel.assign(qvel.astype(np.float32))
        self._data.qacc_warmstart.zero_()

    def advance(self, state: Floats | None, forces: Floats | None, steps: int) -> Floats:
        """Take steps; return a row for each, and one of the state after the last."""
        if self._graph is None:
            with warp.ScopedDevice(_DEVICE):
                self._graph = _captured(self._step)
        parts = []
        if state is not None:
            self._start(state[None, :7], state[None, 7:])
        for start in range(0, steps, _ROWS):
            count = min(_ROWS, steps - start)
            self._place.zero_()
            if forces is not None:
                padded = np.zeros((_ROWS, 3), np.float32)
                padded[:count] = forces[start : start + count]
                self._forces.assign(padded)
            for _ in range(count):
                warp.capture_launch(self._graph)
            parts.append(self._rows.numpy()[:count].astype(np.float64))
        last = np.full((1, 21), np.nan)
        last[0, :7], last[0, 7:13] = self._data.qpos.numpy()[0], self._data.qvel.numpy()[0]
        return np.concatenate((*parts, last))

    @property
    def iterations(self) -> int:
        """Iterations of the solver in the last step."""
        return int(self._data.solver_niter.numpy()[0])

    def collision(self) -> Collision:
        """Return the points where the can touches, and those above the plane, without a step."""
        if self._far is None:
            with warp.ScopedDevice(_DEVICE):
                self._far = self._far_off()
        data, graph = self._far
        data.qpos.assign(self._state[None, :7].astype(np.float32))
        warp.capture_launch(graph)
        count, contact = int(data.nacon.numpy()[0]), data.contact
        points, frames, distances, geoms = (
            array.numpy()[:count].astype(np.float64)
            for array in (contact.pos, contact.frame, contact.dist, contact.geom)
        )
        # from the first geom to the second, the can
        towards = np.where(geoms[:, 1:] == self._geoms[0], 1.0, -1.0)
        return Collision(points=points, normals=frames[:, 0] * towards, depths=-distances)

    def _far_off(self) -> tuple[mujoco_warp.Data, warp.Graph]:
        """Return data of a model with a wide margin, and a graph that finds their contacts.

        Of other shapes than a cylinder on a plane a wide margin is another algorithm: none there.
        """
        wide = self._shapes == CYLINDER_ON_PLANE
        margins = self.model.geom_margin, self.model.pair_margin
        kept = [margin.copy() for margin in margins]
        for margin in margins:
            margin[:] = _FAR if wide else margin
        model, data = self._on_device(self.model)
        for margin, own in zip(margins, kept, strict=True):
            margin[:] = own

        def find() -> None:
            mujoco_warp.kinematics(model, data)
            mujoco_warp.com_pos(model, data)
            mujoco_warp.collision(model, data)

        return data, _captured(find)
