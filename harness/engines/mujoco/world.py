"""A compiled MuJoCo model of a scene that can be placed, stepped and read.

After a step qpos and qvel are new, while contacts and sensors belong to the state before it. The
angular velocity of a free joint is in the body's frame; everything here is handed over in the
world's.
"""

from collections.abc import Mapping

import mujoco
import numpy as np

from harness.engines import NO_POINTS, Case, Collision, Contact, Value
from harness.engines.mujoco.colliders import is_flag
from harness.engines.mujoco.compiled_scene import CompiledScene
from models.kinematics import to_body, to_world
from models.state import Pose, Twist

_NO_RESTART = {"autoreset": "disable"} if is_flag("autoreset") else {}
"""A run that diverges is to be seen, not restarted; before 3.2.1 its clock and warnings show it."""


class MujocoWorld(CompiledScene):
    """One can on one plane in MuJoCo.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        super().__init__(case, chosen, timestep, _NO_RESTART)
        self.data = mujoco.MjData(self.model)

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
            point=point[0].copy(),  # MuJoCo writes over it in the next step
            force=force[0].copy(),
            penetration=float(penetration[0]),
            count=int(count[0]),
        )

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        mujoco.mj_fwdPosition(self.model, self.data)
        if not self.data.ncon:
            return NO_POINTS
        contact = self.data.contact
        # the first axis of a contact's frame points from the first geom to the second, the can
        towards = np.where(contact.geom[:, 1] == self._geoms[0], 1.0, -1.0)
        return Collision(
            points=contact.pos.copy(),
            normals=contact.frame[:, :3] * towards[:, None],
            depths=-contact.dist,
        )

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        return self.distance(self.data)
