"""A PyBullet world of a scene that can be placed, stepped and read.

The contact points that a step leaves behind belong to the state before it. Quaternions are scalar
last in PyBullet and scalar first here; `getBaseVelocity` is in world coordinates already. Every
call names its client, so that worlds do not meet.
"""

import math
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pybullet

from harness.case import Case, Value
from harness.engines.base import Contact, Floats
from harness.engines.pybullet.settings import DYNAMICS, PROCESS_WIDE, SOLVER, URDF_FLAGS
from models.state import Pose, Twist
from models.urdf import ground_urdf, urdf

ContactPoint: TypeAlias = tuple[Any, ...]
Resultant: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

_REACH = 1.0  # m: distance up to which closest points are sought


class PybulletWorld:
    """One can on one plane in PyBullet.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        self.client = pybullet.connect(pybullet.DIRECT)
        self._finalizer = weakref.finalize(self, pybullet.disconnect, self.client)
        self._timestep = timestep
        here = {"physicsClientId": self.client}
        pybullet.setGravity(0.0, 0.0, -case.scene.gravity, **here)
        pybullet.setTimeStep(timestep, **here)
        solver = {s.name: chosen[s.name] for s in SOLVER if chosen[s.name] is not None}
        pybullet.setPhysicsEngineParameter(**(dict(PROCESS_WIDE) | solver), **here)
        flags = 0
        for setting in URDF_FLAGS:
            if setting.name.startswith("URDF_") and chosen[setting.name]:
                flags |= getattr(pybullet, setting.name)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            self.ground = self._load(path / "ground.urdf", ground_urdf())
            self.can = self._load(
                path / "can.urdf",
                urdf(case.scene),
                flags=flags,
                useMaximalCoordinates=bool(chosen["useMaximalCoordinates"]),
            )
        dynamics = {s.name: chosen[s.name] for s in DYNAMICS if chosen[s.name] is not None}
        if dynamics:
            pybullet.changeDynamics(self.can, -1, **dynamics, **here)

    def _load(self, path: Path, text: str, **how: bool | int) -> int:
        """Return the body that PyBullet makes of a URDF text.

        PyBullet remembers files by their path, so the path must be new for each text.
        """
        path.write_text(text, encoding="utf-8")
        body: int = pybullet.loadURDF(str(path), physicsClientId=self.client, **how)
        return body

    @property
    def mass(self) -> float:
        """Mass of the can, kg."""
        return float(self._dynamics()[0])

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes, shape (3,), kg m^2."""
        return np.array(self._dynamics()[2], dtype=np.float64)

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        if timestep != self._timestep:
            self._timestep = timestep
            pybullet.setTimeStep(timestep, physicsClientId=self.client)

    def _dynamics(self) -> tuple[Any, ...]:
        info: tuple[Any, ...] = pybullet.getDynamicsInfo(self.can, -1, physicsClientId=self.client)
        return info

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving."""
        w, x, y, z = pose.quaternion.tolist()
        pybullet.resetBasePositionAndOrientation(
            self.can, pose.position.tolist(), (x, y, z, w), physicsClientId=self.client
        )
        pybullet.resetBaseVelocity(
            self.can,
            twist.velocity.tolist(),
            twist.angular_velocity.tolist(),
            physicsClientId=self.client,
        )

    def step(self) -> None:
        """Advance by one timestep."""
        pybullet.stepSimulation(physicsClientId=self.client)

    def pose(self) -> Pose:
        """Return where the can is."""
        position, (x, y, z, w) = pybullet.getBasePositionAndOrientation(
            self.can, physicsClientId=self.client
        )
        return Pose(position=position, quaternion=np.array((w, x, y, z)))

    def twist(self) -> Twist:
        """Return how the can moves."""
        velocity, angular_velocity = pybullet.getBaseVelocity(self.can, physicsClientId=self.client)
        return Twist(velocity=velocity, angular_velocity=angular_velocity)

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        x, y, z, fx, fy, fz, depth, count, _ = resultant(
            pybullet.getContactPoints(self.can, self.ground, physicsClientId=self.client)
        )
        return Contact(
            point=np.array((x, y, z)),
            force=np.array((fx, fy, fz)),
            penetration=depth,
            count=int(count),
        )

    def gap(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        points = pybullet.getClosestPoints(
            self.can, self.ground, _REACH, physicsClientId=self.client
        )
        return float(min(point[8] for point in points)) if points else np.inf


def resultant(points: Sequence[ContactPoint]) -> Resultant:
    """Return the resultant of PyBullet's contact points between can and ground.

    Parameters
    ----------
    points : sequence of tuple
        As `getContactPoints` returns them: 5 and 6 positions on can and ground, 7 normal towards
        the can, 8 distance, 9 normal force, 10 to 13 two friction forces, each followed by its
        direction.

    Returns
    -------
    tuple of 9 floats
        Force-weighted point (3), force on the can (3), depth of the deepest point, number of points
        that bear a force, number of points in the solver. Cached points without force stay out of
        the locus: they may be half a can away.
    """
    px = py = pz = fx = fy = fz = total = bearing = 0.0
    depth = -math.inf
    for point in points:
        depth = max(depth, -point[8])
        n = point[9]
        if n <= 0.0:
            continue
        ax, ay, az = point[5]
        bx, by, bz = point[6]
        nx, ny, nz = point[7]
        f1, (ux, uy, uz), f2, (vx, vy, vz) = point[10:14]
        fx += n * nx + f1 * ux + f2 * vx
        fy += n * ny + f1 * uy + f2 * vy
        fz += n * nz + f1 * uz + f2 * vz
        px += n * (ax + bx) / 2.0
        py += n * (ay + by) / 2.0
        pz += n * (az + bz) / 2.0
        total += n
        bearing += 1.0
    if not points:
        depth = math.nan
    if total == 0.0:
        return (math.nan, math.nan, math.nan, 0.0, 0.0, 0.0, depth, 0.0, float(len(points)))
    return (px / total, py / total, pz / total, fx, fy, fz, depth, bearing, float(len(points)))
