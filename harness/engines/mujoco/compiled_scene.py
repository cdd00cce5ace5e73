"""A scene compiled by MuJoCo from MJCF, and what of it follows the timestep.

It is what MuJoCo and the engines that take their model from MuJoCo have in common: the text of the
model, the attributes that are tied to a timestep, mass and moments as they are compiled, the forces
of a shaken plane, and the contact as MuJoCo's own sensors tell it.

A shaken plane is a force on the centre of mass, `xfrc_applied`: gravity is the same all over the
can, and unlike `opt.gravity` a force may change from step to step within one call of an engine.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from harness.engines import (
    Case,
    Chunk,
    Floats,
    Integers,
    RefusedModelError,
    Trajectory,
    Value,
    mesh_points,
)
from harness.engines.mujoco.colliders import CYLINDER_ON_PLANE, mesh_in, shapes_in
from harness.engines.mujoco.settings import attributes, matched_solref, rows_of, stages
from models import Can
from models.gravity import shaking
from models.kinematics import to_world
from models.release import Release
from models.to_mjcf import DEPTH_SENSOR, NET_SENSOR, dof_damping, mjcf

_RELEASE = Release(phi=1.0)
"""Release in the model file; every run places the can anew."""

_FAR = 1.0
"""m: beyond this MuJoCo does not look for the distance of two geoms."""

_NEXT_TO_NOTHING = 1e-30
"""Damping too small to change a number, with which MuJoCo computes damping all the same."""

HAS_CONTACT_SENSORS = hasattr(mujoco.mjtSensor, "mjSENS_CONTACT")
"""Whether the version that is installed has them: 3.3.0 has not, 3.4.0 has."""


def fill_contact_sensors(model: mujoco.MjModel, data: mujoco.MjData, stage: int) -> None:
    """Write what the two sensors of contacts hold into sensors of these names: the first there are.

    It is called in every step, so that a contact by itself is not summed.
    """
    if stage != mujoco.mjtStage.mjSTAGE_ACC:
        return
    count, rows = data.ncon, np.zeros(8)
    if count:
        contact, force = data.contact, np.empty(6)
        points, frames = contact.pos, contact.frame.reshape(-1, 3, 3)
        if count == 1:
            mujoco.mj_contactForce(model, data, 0, force)
            rows[1:4], rows[4:7] = force[:3] @ frames[0], points[0]
        else:
            total = 0.0
            for number in range(count):
                mujoco.mj_contactForce(model, data, number, force)
                in_world = force[:3] @ frames[number]
                size = math.sqrt(in_world @ in_world)
                rows[1:4] += in_world
                rows[4:7] += size * points[number]
                total += size
            rows[4:7] /= total or 1.0
        rows[0], rows[7] = count, contact.dist.min()
    data.sensordata[:8] = rows


class CompiledScene:
    """One can on one plane as MuJoCo compiles it.

    Where the ground is a box, `half_box` is half of its size, m.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    flag : mapping of str to str
        Attributes of `option/flag` that the engine needs beside those of the settings.
    contact_sensors : bool
        Whether the engine has MuJoCo's sensors of the contact.
    """

    half_box = (2000.0, 2000.0, 1.0)

    def __init__(
        self,
        case: Case,
        chosen: Mapping[str, Value],
        timestep: float,
        flag: Mapping[str, str],
        *,
        contact_sensors: bool = True,
    ) -> None:
        option, geom, own_flag = attributes(case, chosen)
        self._shapes = shapes_in(chosen)
        rows = rows_of(case, timestep)
        everything = chosen.get("build") == "everything"
        text = mjcf(
            alike(case).scene,
            option={"timestep": repr(timestep)} | option,
            flag=dict(flag) | stages(chosen, case.scene.effects) | own_flag,
            geom=geom,
            contact_sensors=contact_sensors,
            filled_sensors=not HAS_CONTACT_SENSORS,
            every_sensor=everything,
            spring_timestep=None if rows is None else timestep,
        )
        if not HAS_CONTACT_SENSORS:
            mujoco.set_mjcb_sensor(None)  # it is called with a model that is only half compiled
        # a warning is an outcome, which `MjData.warning` counts, not a line of a log file in the
        # working folder
        mujoco.set_mju_user_warning(lambda _: None)
        try:
            self.model = _compiled(text, chosen, case.scene.can, self.half_box)
        except ValueError as error:
            raise RefusedModelError(case.engine, case.label(), str(error)) from error
        if contact_sensors and not HAS_CONTACT_SENSORS:
            mujoco.set_mjcb_sensor(fill_contact_sensors)
        self._scene, self._shaken = case.scene, case.scene.effects.shake is not None
        self._case, self._lawful, self._largest = case, rows is not None, timestep
        stiffest = case.profile != "default" and "solref" not in dict(case.options)
        self._tied = stiffest and not self._lawful
        damping = dof_damping(case.scene)
        if damping is not None and case.scene.effects.point_mass is not None:
            reason = (
                "MuJoCo damps the velocity of the can's centre, which is not that of the centre of "
                "mass beside a point mass; the reference carries both"
            )
            raise RefusedModelError(case.engine, case.label(), reason)
        if damping is not None:
            self.model.dof_damping[:] = damping
        elif everything:
            self.model.dof_damping[:] = _NEXT_TO_NOTHING
        self._body = self.model.body("can").id
        self._geoms = (self.model.geom("can").id, self.model.geom("ground").id)
        # of the constraints of one contact; they depend on its dimension and the cone
        condim = int(self.model.geom_condim[self._geoms[0]])
        pyramidal = self.model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
        self.rows_per_contact = 2 * (condim - 1) if pyramidal and condim > 1 else condim
        # without MuJoCo's sensors an adapter makes the same numbers itself
        self.found, self._depth = 0, 7
        if contact_sensors:
            self.found = int(self.model.sensor(NET_SENSOR).adr[0])
            self._depth = int(self.model.sensor(DEPTH_SENSOR).adr[0])

    @property
    def ground_half_width(self) -> float:
        """How far the ground goes from the origin, m."""
        return self.half_box[0] if "box" in self._shapes else math.inf

    def of_can(self, field: str) -> Floats:
        """Return what the engine has compiled of the can, by the name of the model's array."""
        value: Floats = getattr(self.model, field)[self._body]
        return value

    def distance(self, data: mujoco.MjData) -> float:
        """Return MuJoCo's own signed distance of the can to the ground where `data` has it, m."""
        mujoco.mj_kinematics(self.model, data)
        return float(mujoco.mj_geomDistance(self.model, data, *self._geoms, _FAR, None))

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self.of_can("body_mass"))

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        R_BP = np.empty(9)
        mujoco.mju_quat2Mat(R_BP, self.of_can("body_iquat"))
        R = R_BP.reshape(3, 3)
        tensor: Floats = R @ np.diag(self.of_can("body_inertia")) @ R.T
        return tensor

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return self.of_can("body_ipos").copy()

    @property
    def timestep(self) -> float:
        """The timestep of the compiled model, s."""
        return float(self.model.opt.timestep)

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on; a contact tied to the timestep goes with it."""
        if timestep != self.model.opt.timestep:
            self.model.opt.timestep = timestep
            if self._tied:
                self.model.geom_solref[:, :] = matched_solref(timestep)
            rows = rows_of(self._case, timestep, self._largest) if self._lawful else None
            if rows is not None:
                self.model.pair_solref[0] = rows.solref
                self.model.pair_solreffriction[0] = rows.solreffriction

    def forces(self, times: Floats) -> Floats | None:
        """Return `xfrc_applied` of the steps from these times (n,) on, shape (n, 6 bodies).

        None where the plane is at rest and nothing is applied.
        """
        if not self._shaken:
            return None
        applied = np.zeros((len(times), self.model.nbody, 6))
        applied[:, self._body, :3] = self.mass * shaking(self._scene, times, self.timestep)
        return applied.reshape(len(times), -1)

    def read_contact(self, sensors: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return point (n, 3), force (n, 3), depth (n,) and count (n,) of sensor rows (n, 8).

        MuJoCo's own resultant: the sum of all contact forces at their force-weighted centre. The
        contact frame of a resultant is the world's with the axes in order, so that its force needs
        no turning.
        """
        net = sensors[:, self.found : self.found + 7]
        count, force, point = net[:, 0], net[:, 1:4], net[:, 4:7]
        bears = (count > 0) & (force[:, 2] > 0.0)
        if bears.all():
            return point, force, -sensors[:, self._depth], count
        return (
            np.where(bears[:, None], point, np.nan),
            force,
            np.where(count > 0, -sensors[:, self._depth], np.nan),
            np.where(bears, count, 0.0),
        )

    def trajectory(self, time: Floats, states: Floats, sensors: Floats) -> Trajectory:
        """Return states, as in `chunk_of`, with the sensors of their instants."""
        point, force, depth, count = self.read_contact(sensors)
        states = states.T.copy().T  # a column at a time is read, some of them ten times
        quaternion = states[:, -10:-6]
        return Trajectory(
            time=time,
            position=states[:, -13:-10],
            quaternion=quaternion,
            velocity=states[:, -6:-3],
            angular_velocity=to_world(quaternion, states[:, -3:]),
            contact_point=point,
            contact_force=force,
            penetration=depth,
            contact_count=count.astype(np.int64),
        )


def _compiled(
    text: str, chosen: Mapping[str, Value], can: Can, half_box: tuple[float, float, float]
) -> mujoco.MjModel:
    """Return the model of an MJCF text in which the chosen shapes collide."""
    shapes, mesh = shapes_in(chosen), mesh_in(chosen)
    if shapes == CYLINDER_ON_PLANE and mesh is None:
        return mujoco.MjModel.from_xml_string(text)
    spec = mujoco.MjSpec.from_string(text)
    if mesh is not None:
        spec.add_mesh(name="can", uservert=mesh_points(mesh, can).ravel())
        spec.geom("can").type, spec.geom("can").meshname = mujoco.mjtGeom.mjGEOM_MESH, "can"
    if "box" in shapes:
        ground = spec.geom("ground")
        ground.type, ground.size, ground.pos = (
            mujoco.mjtGeom.mjGEOM_BOX,
            half_box,
            (0.0, 0.0, -half_box[2]),
        )
    return spec.compile()


def chunk_of(
    scene: CompiledScene,
    times: Floats,
    states: Floats,
    sensors: Floats,
    *,
    count: int,
    sound: bool,
    spans: Integers | None = None,
) -> Chunk:
    """Return steps with the sensors of the instants before them.

    Parameters
    ----------
    scene : CompiledScene
    times : ndarray, shape (n,)
        s.
    states : ndarray, shape (n, 13 or more)
        qpos and qvel in the last columns, the angular velocity in the body's frame.
    sensors : ndarray, shape (n, 8)
    count : int
        How many of the states from the first on are valid.
    sound : bool
        Whether the numbers have not broken, within these steps or right after them.
    spans : ndarray of int, shape (n,), optional
        Where not every step was read: for how many each stands.
    """
    worked = (sensors[:count, scene.found] * scene.rows_per_contact).astype(np.int64)
    if count < len(times):
        worked = np.append(worked, np.zeros(len(times) - count, dtype=np.int64))
    return Chunk(
        times=times,
        quaternions=states[:count, -10:-6],
        constraint_rows=worked,
        sound=sound and count == len(states),
        velocities=states[:count, -6:-3],
        readings=(states, sensors),
        trajectory=scene.trajectory,
        spans=spans,
    )


def alike(case: Case) -> Case:
    """Return a case with the release of the model file, equal for all cases of one model.

    MuJoCo weighs a constraint by an inverse inertia that it takes, with round-off, in the pose of
    the model file. Compiled from this, every release has one and the same model, to the bit.
    """
    return replace(case, scene=replace(case.scene, name="can", cite="", release=_RELEASE))
