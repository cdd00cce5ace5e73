"""A PyBullet world of a scene that can be placed, stepped and read.

The contact points that a step leaves behind belong to the state before the step. Quaternions are
scalar last in PyBullet and scalar first in the harness; `getBaseVelocity` is in world coordinates
already. The shaking of a plane is a gravity that is set anew before each step. Every call names its
client, so that worlds do not meet. Of a timestep in parts PyBullet hands over the impulse of the
last part, divided by the whole timestep. Steps that nobody looks at are the parts of one long step:
the same numbers in one call.
"""

import math
import tempfile
import weakref
from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from harness.engines import (
    MESH_SETTING,
    NO_POINTS,
    Case,
    Collision,
    Contact,
    Floats,
    RefusedModelError,
    Value,
    mesh_points,
    obj_text,
)
from harness.engines.pybullet.contact_points import numbers_of, resultants
from harness.engines.pybullet.frames import Frames, Reading, State
from harness.engines.pybullet.settings import (
    DYNAMICS,
    PROCESS_WIDE,
    SEQUENTIAL_IMPULSE,
    SOLVER,
    given,
    urdf_flags,
)
from harness.engines.pybullet.suppress_output import pybullet
from harness.engines.suppress_output import silence
from models import Pose, Twist, ground_urdf, urdf
from models.gravity import gravity_vector, shaking

_RIGID = 1e18  # N/m: what PyBullet gives a body that declares no stiffness
ANY_LINK = -2
"""What PyBullet takes for a link that is not named."""

_IDLE: list[int] = []
"""Clients of worlds that are gone; a new one takes three times as long until it has a plane."""


def _connected() -> int:
    """Return a client without bodies, with every parameter as in a new one."""
    if not _IDLE:
        return int(pybullet.connect(pybullet.DIRECT))
    client = _IDLE.pop()
    pybullet.resetSimulation(physicsClientId=client)
    pybullet.setPhysicsEngineParameter(numSubSteps=0, physicsClientId=client)  # kept by a reset
    return client


_REACH, _MESH = 1.0, "can.obj"  # m: distance up to which closest points are sought

_FEWEST_TOGETHER = 5  # steps: setting their number and setting it back costs three calls of a step
_UNCHANGED = (-1, -1, -2, *[-1] * 19)
"""For what follows `numSubSteps`: given by place, it costs a fifth of what it does by name."""


@lru_cache(maxsize=4096)
def steps_together(steps: int, timestep: float) -> int:
    """Return how many of two or more steps can be the parts of one, the same to the last bit.

    PyBullet divides the long step by their number to get the length of a part, and by that length
    to get their number again; a power of two always stays what it is.
    """
    return next(
        count
        for count in range(steps, 1, -1)
        if count * timestep / count == timestep and int(count * timestep / timestep) == count
    )


def in_parts(timestep: float, parts: int) -> float:
    """Return the longest timestep up to this one that is so many parts without a remainder.

    PyBullet takes as many parts as fit into the time that is left over: where a rounding leaves no
    room for the last, one fewer, and from then on the can is late by one.
    """
    mantissa, exponent = math.frexp(timestep)
    digits, odd = int(math.ldexp(mantissa, 53)), parts // (parts & -parts)
    return math.ldexp(digits - digits % odd, exponent - 53)


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
        self.client = _connected()
        self._finalizer = weakref.finalize(self, _IDLE.append, self.client)
        self._timestep = timestep
        here = {"physicsClientId": self.client}
        self._scene, self._shaken = case.scene, case.scene.effects.shake is not None
        self._gravity, self._time = gravity_vector(case.scene), 0.0
        pybullet.setGravity(*self._gravity.tolist(), **here)
        solver = dict(PROCESS_WIDE) | given(SOLVER, chosen)
        algorithm = solver.pop("constraintSolverType")
        pybullet.setPhysicsEngineParameter(**solver, **here)
        if algorithm != SEQUENTIAL_IMPULSE:
            with silence():
                number = getattr(pybullet, str(algorithm))
                pybullet.setPhysicsEngineParameter(constraintSolverType=number, **here)
        self._sub_steps = int(chosen["numSubSteps"])  # type: ignore[arg-type]
        self.parts = max(self._sub_steps, 1)
        pybullet.setTimeStep(in_parts(timestep, self.parts), **here)
        flags = sum(getattr(pybullet, name) for name in urdf_flags(chosen))
        with tempfile.TemporaryDirectory() as folder:
            path, mesh = Path(folder), chosen[MESH_SETTING.name]
            self.ground = self._load(path / "ground.urdf", ground_urdf())
            if mesh is not None:
                points = mesh_points(mesh, case.scene.can)  # type: ignore[arg-type] # as checked
                (path / _MESH).write_text(obj_text(points), encoding="utf-8")
            self.can = self._load(
                path / "can.urdf",
                urdf(case.scene, "" if mesh is None else _MESH),
                flags=flags,
                useMaximalCoordinates=bool(chosen["useMaximalCoordinates"]),
            )
        # as it is loaded, with the frame of its link at the origin of the world
        centre, axes = pybullet.getBasePositionAndOrientation(self.can, self.client)
        self._frames = Frames(centre, axes)
        self.off_centre = case.scene.effects.point_mass is not None
        dynamics = given(DYNAMICS, chosen)
        if dynamics:
            pybullet.changeDynamics(self.can, -1, **dynamics, **here)
        effects = case.scene.effects
        if effects.damping is not None and self.off_centre:
            reason = (
                "in the maximal coordinates that damping needs, PyBullet keeps a margin of 1 mm on "
                "a can whose centre of mass is off its centre; the reference carries both"
            )
            raise RefusedModelError(case.engine, case.label(), reason)
        if effects.compliance is not None:
            # PyBullet puts springs in series and adds dampers; by default a body has damping 0.1
            pybullet.changeDynamics(
                self.ground, -1, contactStiffness=_RIGID, contactDamping=0.0, **here
            )

    def _load(self, path: Path, text: str, **how: bool | int) -> int:
        """Return the body that PyBullet makes of a URDF text.

        PyBullet remembers files by their path, so the path must be new for each text.
        """
        path.write_text(text, encoding="utf-8")
        return int(pybullet.loadURDF(str(path), physicsClientId=self.client, **how))

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self._dynamics()[0])

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        R_BI = self._frames.rotation
        tensor: Floats = R_BI @ np.diag(self._dynamics()[2]) @ R_BI.T
        return tensor

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return np.array(self._frames.centre)

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        if timestep != self._timestep:
            self._timestep = timestep
            pybullet.setTimeStep(in_parts(timestep, self.parts), physicsClientId=self.client)

    def take_parts(self) -> None:
        """Step by what was a part of a timestep from now on."""
        if self.parts > 1:
            self._timestep = in_parts(self._timestep, self.parts) / self.parts
            self._sub_steps, self.parts = 0, 1
            self._step_by(self._timestep, self._sub_steps)

    def _dynamics(self) -> tuple[Any, ...]:
        info: tuple[Any, ...] = pybullet.getDynamicsInfo(self.can, -1, physicsClientId=self.client)
        return info

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving, at the time zero."""
        w, x, y, z = pose.quaternion.tolist()
        state: State = (
            pose.position.tolist(),
            (x, y, z, w),
            twist.velocity.tolist(),
            twist.angular_velocity.tolist(),
        )
        if self.off_centre:
            state = self._frames.principal(*state)
        position, quaternion, velocity, spin = state
        pybullet.resetBasePositionAndOrientation(
            self.can, position, quaternion, physicsClientId=self.client
        )
        pybullet.resetBaseVelocity(self.can, velocity, spin, physicsClientId=self.client)
        self._time = 0.0

    def step(self) -> None:
        """Advance by one timestep."""
        self.stepper(np.array([self._time]))(self.client)
        self._time += self._timestep

    def stepper(self, times: Floats) -> Callable[[int], object]:
        """Return a function of the client that takes one of the steps from these times on."""
        if not self._shaken:
            step: Callable[[int], object] = pybullet.stepSimulation
            return step
        gravities = (self._gravity + shaking(self._scene, times, self._timestep)).tolist()
        coming = iter(gravities)

        def shaken_step(client: int) -> None:
            pybullet.setGravity(*next(coming), client)
            pybullet.stepSimulation(client)

        return shaken_step

    def skip(self, steps: int, step: Callable[[int], object]) -> None:
        """Take so many steps by what `stepper` returned; nobody looks at what is between."""
        together = 0
        if steps >= _FEWEST_TOGETHER and self.parts == 1 and not self._shaken:
            together = steps_together(steps, self._timestep)
            self._step_by(together * self._timestep, together)
            try:
                step(self.client)
            finally:
                self._step_by(self._timestep, self._sub_steps)
        for _ in repeat(None, steps - together):
            step(self.client)

    def _step_by(self, timestep: float, parts: int) -> None:
        pybullet.setPhysicsEngineParameter(timestep, -1, -1, -1, parts, *_UNCHANGED, self.client)

    def state(self) -> State:
        """Return position, quaternion (scalar last), velocity and angular velocity of the can."""
        position, quaternion = pybullet.getBasePositionAndOrientation(self.can, self.client)
        velocity, spin = pybullet.getBaseVelocity(self.can, self.client)
        if self.off_centre:
            return self._frames.can(position, quaternion, velocity, spin)
        return position, quaternion, velocity, spin

    @property
    def reading(self) -> Reading | None:
        """Function that turns a state of PyBullet's frame into the can's; None for equal frames."""
        return self._frames.can if self.off_centre else None

    def pose(self) -> Pose:
        """Return where the can is."""
        position, (x, y, z, w), _, _ = self.state()
        return Pose(position=np.array(position), quaternion=np.array((w, x, y, z)))

    def twist(self) -> Twist:
        """Return how the can moves."""
        _, _, velocity, spin = self.state()
        return Twist(velocity=np.array(velocity), angular_velocity=np.array(spin))

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        points = pybullet.getContactPoints(self.can, self.ground, physicsClientId=self.client)
        row = resultants(numbers_of(points), np.array([len(points)]))[0]
        return Contact(
            point=row[:3], force=row[3:6] * self.parts, penetration=float(row[6]), count=int(row[7])
        )

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        pybullet.performCollisionDetection(self.client)
        points = pybullet.getContactPoints(self.can, self.ground, physicsClientId=self.client)
        if not points:
            return NO_POINTS
        return Collision(
            points=np.array([point[5] for point in points]),
            normals=np.array([point[7] for point in points]),
            depths=-np.array([point[8] for point in points]),
        )

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        points = pybullet.getClosestPoints(
            self.can, self.ground, _REACH, physicsClientId=self.client
        )
        return float(min(point[8] for point in points)) if points else np.inf
