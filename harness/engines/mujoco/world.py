"""A compiled MuJoCo model of a scene that can be placed, stepped and read.

After a step qpos and qvel are new, while contacts and sensors belong to the state before it. The
angular velocity of a free joint is in the body's frame; everything here is handed over in the
world's.

A shaken plane is a force on the centre of mass, `xfrc_applied`: gravity is the same all over the
can, and unlike `opt.gravity` a force may change from step to step within one call of MuJoCo.
"""

from dataclasses import replace

import mujoco
import numpy as np

from harness.engines import Case, Contact, Floats, RefusedModelError, Value
from harness.engines.mujoco.settings import attributes, matched_solref, soft_solref, stages
from models.gravity import shaking
from models.kinematics import to_body, to_world
from models.mjcf_contact import friction_solref
from models.release import Release
from models.state import Pose, Twist
from models.to_mjcf import DEPTH_SENSOR, NET_SENSOR, dof_damping, mjcf

_RELEASE = Release(phi=1.0)
"""Release in the model file; every run places the can anew."""

_NEXT_TO_NOTHING = 1e-30
"""Damping too small to change a number, with which MuJoCo computes damping all the same."""

_FAR = 1.0
"""m: beyond this MuJoCo does not look for the distance of two geoms."""


class MujocoWorld:
    """One can on one plane in MuJoCo.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: dict[str, Value], timestep: float) -> None:
        option, geom, flag = attributes(case, chosen)
        soft = soft_solref(case, timestep)
        text = mjcf(
            alike(case).scene,
            option={"timestep": repr(timestep)} | option,
            # a run that diverges is to be seen, not restarted
            flag={"autoreset": "disable"} | stages(chosen, case.scene.effects) | flag,
            geom=geom,
            contact_sensors=True,
            every_sensor=chosen["build"] == "everything",
            spring_timestep=None if soft is None else timestep,
        )
        # a warning is an outcome, which `MjData.warning` counts, not a line of a log file in the
        # working folder
        mujoco.set_mju_user_warning(lambda _: None)
        try:
            self.model = mujoco.MjModel.from_xml_string(text)
        except ValueError as error:
            raise RefusedModelError(case.engine, case.label(), str(error)) from error
        self.data = mujoco.MjData(self.model)
        self._scene, self._shaken = case.scene, case.scene.effects.shake is not None
        self._case, self._soft = case, soft is not None
        stiffest = case.profile != "default" and "solref" not in dict(case.options)
        self._tied = stiffest and not self._soft
        damping = dof_damping(case.scene)
        if damping is not None and case.scene.effects.point_mass is not None:
            reason = (
                "MuJoCo damps the velocity of the can's centre, which is not that of the centre of "
                "mass beside a point mass; the reference carries both"
            )
            raise RefusedModelError(case.engine, case.label(), reason)
        if damping is not None:
            self.model.dof_damping[:] = damping
        elif chosen["build"] == "everything":
            self.model.dof_damping[:] = _NEXT_TO_NOTHING
        self._body = self.model.body("can").id
        self._geoms = (self.model.geom("can").id, self.model.geom("ground").id)
        self._net = self.model.sensor(NET_SENSOR).adr[0]
        self._depth = self.model.sensor(DEPTH_SENSOR).adr[0]

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self.model.body_mass[self._body])

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        principal = self.model.body_inertia[self._body]
        R_BP = np.empty(9)
        mujoco.mju_quat2Mat(R_BP, self.model.body_iquat[self._body])
        R = R_BP.reshape(3, 3)
        tensor: Floats = R @ np.diag(principal) @ R.T
        return tensor

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        centre: Floats = self.model.body_ipos[self._body].copy()
        return centre

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
            if self._soft:
                self.model.pair_solref[0] = soft_solref(self._case, timestep)
                self.model.pair_solreffriction[0] = friction_solref(timestep)

    @property
    def rows_per_contact(self) -> int:
        """Constraint rows of one contact, which depend on its dimension and the cone."""
        condim = int(self.model.geom_condim[self._geoms[0]])
        pyramidal = self.model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
        return 2 * (condim - 1) if pyramidal and condim > 1 else condim

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:3], self.data.qpos[3:] = pose.position, pose.quaternion
        self.data.qvel[:3] = twist.velocity
        self.data.qvel[3:] = to_body(pose.quaternion, twist.angular_velocity)

    def step(self) -> None:
        """Advance by one timestep."""
        forces = self.forces(np.array([self.data.time]))
        if forces is not None:
            self.data.xfrc_applied[:] = forces.reshape(-1, 6)
        mujoco.mj_step(self.model, self.data)

    def forces(self, times: Floats) -> Floats | None:
        """Return `xfrc_applied` of the steps from these times (n,) on, shape (n, 6 bodies).

        None where the plane is at rest and nothing is applied.
        """
        if not self._shaken:
            return None
        applied = np.zeros((len(times), self.model.nbody, 6))
        applied[:, self._body, :3] = self.mass * shaking(self._scene, times, self.timestep)
        return applied.reshape(len(times), -1)

    def pose(self) -> Pose:
        """Return where the can is."""
        return Pose(position=self.data.qpos[:3], quaternion=self.data.qpos[3:])

    def twist(self) -> Twist:
        """Return how the can moves."""
        return Twist(
            velocity=self.data.qvel[:3],
            angular_velocity=to_world(self.data.qpos[3:], self.data.qvel[3:]),
        )

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        point, force, penetration, count = self.read_contact(self.data.sensordata[None])
        return Contact(
            point=point[0],
            force=force[0].copy(),  # MuJoCo writes over it in the next step
            penetration=float(penetration[0]),
            count=int(count[0]),
        )

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        mujoco.mj_kinematics(self.model, self.data)
        return float(mujoco.mj_geomDistance(self.model, self.data, *self._geoms, _FAR, None))

    def read_contact(self, sensors: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return point (n, 3), force (n, 3), depth (n,) and count (n,) of sensor rows (n, 8).

        MuJoCo's own resultant: the sum of all contact forces at their force-weighted centre. The
        contact frame of a resultant is the world's with the axes in order, so that its force needs
        no turning.
        """
        net = sensors[:, self._net : self._net + 7]
        count, force, point = net[:, 0], net[:, 1:4], net[:, 4:7]
        bears = (count > 0) & (force[:, 2] > 0.0)
        return (
            np.where(bears[:, None], point, np.nan),
            force,
            np.where(count > 0, -sensors[:, self._depth], np.nan),
            np.where(bears, count, 0.0),
        )


def alike(case: Case) -> Case:
    """Return a case with the release of the model file, equal for all cases of one model.

    MuJoCo weighs a constraint by an inverse inertia that it takes, with round-off, in the pose of
    the model file. Compiled from this, every release has one and the same model, to the bit.
    """
    return replace(case, scene=replace(case.scene, name="can", cite="", release=_RELEASE))
