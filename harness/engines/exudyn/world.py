"""An Exudyn system of a scene that can be placed, stepped and read.

The can is a rigid body whose node has Euler parameters; a rolling joint holds its lower rim on the
plane. A joint holds or it does not: a can that is placed on its rim or deeper rolls, one that is
placed higher flies. One that stands exactly upright flies, too: the joint has no lowest point.

Steps of one length are taken in one call of `SolveDynamic`, and sensors keep the state and the
joint's output before, between and after them.
"""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.engines import Case, Contact, Floats, Value
from models import Pose, Scene, Twist, to_body
from models.gravity import gravity_vector
from models.mass import body as body_of

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import exudyn
    from exudyn import itemInterface
    from exudyn.rigidBodyUtilities import RigidBodyInertia

exudyn.config.printToConsole = False  # on standard output, where a command prints JSON
exudyn.config.suppressWarnings = True

_NEAR = 1e-5
"""Share of the radius from the plane at which the joint holds the rim."""

_ALWAYS = 1e-300
"""s: period of writing of the sensors, and least step: shorter than any step."""

_UNTURNED = np.array((1.0, 0.0, 0.0, 0.0))
_CONJUGATE = np.array((1.0, -1.0, -1.0, -1.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JointSteps:
    """States before, between and after steps of one length, and what the joint did in each step.

    Parameters
    ----------
    motion : ndarray, shape (n + 1, 13)
        Position, quaternion (scalar first), velocity and angular velocity, in world coordinates.
    force : ndarray, shape (n, 3)
        On the can, mean of the step, N; zero where the joint is inactive.
    point : ndarray, shape (n, 3)
        Of the joint in the state before the step, m; NaN where it is inactive.
    finished : bool
        False if a step failed.
    """

    motion: Floats
    force: Floats
    point: Floats
    finished: bool


class _System:
    """A rigid body in Exudyn, with its rim in a rolling joint or free, and sensors that store it.

    Of the free body there is a system of its own: an inactive joint is evaluated too, and raises
    an error where the body stands upright.
    """

    def __init__(self, scene: Scene, *, held: bool) -> None:
        solid, kinds = body_of(scene), exudyn.OutputVariableType
        self._container = exudyn.SystemContainer()
        self.main = system = self._container.AddSystem()
        inertia = RigidBodyInertia(
            mass=solid.mass,
            inertiaTensor=solid.inertia,
            com=solid.centre.tolist(),
            inertiaTensorAtCOM=True,
        )
        made = system.CreateRigidBody(
            inertia=inertia,
            gravity=gravity_vector(scene).tolist(),
            nodeType=exudyn.NodeType.RotationEulerParameters,
            returnDict=True,
        )
        self.body = made["bodyNumber"]
        observed = [
            itemInterface.SensorNode(
                nodeNumber=made["nodeNumber"], outputVariableType=kind, **_STORED
            )
            for kind in (kinds.Coordinates, kinds.Coordinates_t)
        ]
        if held:
            ground = itemInterface.MarkerBodyRigid(bodyNumber=system.CreateGround())
            centre_of_rim = itemInterface.MarkerBodyRigid(
                bodyNumber=self.body, localPosition=[0.0, 0.0, -scene.can.half_height]
            )
            self.joint = system.AddObject(
                itemInterface.ObjectJointRollingDisc(
                    markerNumbers=[system.AddMarker(ground), system.AddMarker(centre_of_rim)],
                    discRadius=scene.can.radius,
                    discAxis=[0.0, 0.0, 1.0],
                    planeNormal=[0.0, 0.0, 1.0],
                )
            )
            observed += [
                itemInterface.SensorObject(
                    objectNumber=self.joint, outputVariableType=kind, **_STORED
                )
                for kind in (kinds.ForceLocal, kinds.RotationMatrix, kinds.Position)
            ]
        self.sensors = [system.AddSensor(sensor) for sensor in observed]
        system.Assemble()

    def place(self, coordinates: Floats, rates: Floats) -> None:
        """Start from these coordinates of the node and their rates, at rest inside."""
        data, kinds = self.main.systemData, exudyn.ConfigurationType
        multipliers = np.zeros(len(data.GetAECoordinates()))
        for kind in (kinds.Initial, kinds.Current):
            data.SetODE2Coordinates(coordinates, kind)
            data.SetODE2Coordinates_t(rates, kind)
            data.SetODE2Coordinates_tt(np.zeros(len(rates)), kind)
            data.SetAECoordinates(multipliers, kind)
            data.SetTime(0.0, kind)


class ExudynWorld:
    """One can on one plane in Exudyn.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        self._can, self._timestep = case.scene.can, timestep
        self._rolling, self._flying = (_System(case.scene, held=held) for held in (True, False))
        self._solver = getattr(exudyn.DynamicSolverType, str(chosen["solverType"]))
        self._settings = _simulation_settings(chosen)
        self._end: Floats | None = None  # force at the end of the last step, N
        self.place(Pose(position=np.zeros(3), quaternion=_UNTURNED), _AT_REST)

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self._of_body("physicsMass"))

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        xx, yy, zz, yz, xz, xy = self._of_body("physicsInertia")
        centre = self.centre_of_mass
        offset = centre @ centre * np.eye(3) - np.outer(centre, centre)
        tensor: Floats = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))) - self.mass * offset
        return tensor

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return np.array(self._of_body("physicsCenterOfMass")).ravel()

    def _of_body(self, parameter: str) -> Any:  # noqa: ANN401 - exudyn has no types
        return self._rolling.main.GetObjectParameter(self._rolling.body, parameter)

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        self._timestep = timestep

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        quaternion = pose.quaternion
        self.state = np.concatenate(
            (pose.position, quaternion, twist.velocity, twist.angular_velocity)
        )
        spin = to_body(quaternion, twist.angular_velocity)
        rate = 0.5 * _product(quaternion, np.concatenate(((0.0,), spin)))
        coordinates = np.concatenate((pose.position, quaternion - _UNTURNED))
        rates = np.concatenate((twist.velocity, rate))
        for each in (self._rolling, self._flying):
            each.place(coordinates, rates)
        flat = math.hypot(quaternion[1], quaternion[2]) == 0.0
        holds = not flat and self.signed_distance() < _NEAR * self._can.radius
        self._system = self._rolling if holds else self._flying
        self._contact, self._end = _NONE, None

    def advance(self, steps: int) -> JointSteps:
        """Take steps and return all of them; the state is then no numbers if one failed.

        After the first call accelerations and multipliers go on from what they were, so that
        TrapezoidalIndex2 gives the same bits however the steps are cut into calls.
        """
        times = self._settings.timeIntegration
        times.numberOfSteps, times.endTime = steps, steps * self._timestep
        times.generalizedAlpha.computeInitialAccelerations = self._end is None
        finished = True
        try:
            self._system.main.SolveDynamic(
                self._settings, solverType=self._solver, updateInitialValues=True
            )
        except (exudyn.SolverError, exudyn.ExudynError, ValueError):  # Newton's method failed
            finished = False
        stored = [
            self._system.main.GetSensorStoredData(sensor)[:, 1:] for sensor in self._system.sensors
        ]
        if not stored[0].size:  # the first step failed before anything was stored
            motion, nothing = self.state[None], np.zeros((0, 3))
            self.state = np.full(13, np.nan)
            return JointSteps(motion=motion, force=nothing, point=nothing, finished=False)
        motion = _motion(*stored[:2])
        finished = finished and len(motion) == steps + 1
        force, point = np.zeros((len(motion) - 1, 3)), np.full((len(motion) - 1, 3), np.nan)
        if self._system is self._rolling:
            local, axes, positions = stored[2:]
            ends = np.einsum("nij,nj->ni", axes.reshape(-1, 3, 3), local)
            if self._end is not None:  # a sensor finds no multiplier before the first step
                ends[0] = self._end
            force, point = 0.5 * (ends[:-1] + ends[1:]), positions[:-1]
            self._end = ends[-1]
        else:
            self._end = np.zeros(3)
        self.state = motion[-1] if finished else np.full(13, np.nan)
        return JointSteps(motion=motion, force=force, point=point, finished=finished)

    def step(self) -> None:
        """Advance by one timestep."""
        taken = self.advance(1)
        self._contact = _NONE
        if self._system is self._rolling and taken.finished:
            self._contact = Contact(
                point=taken.point[0],
                force=taken.force[0],
                penetration=-float(taken.point[0, 2]),
                count=1,
            )

    def pose(self) -> Pose:
        """Return where the can is."""
        return Pose(position=self.state[:3], quaternion=self.state[3:7])

    def twist(self) -> Twist:
        """Return how the can moves."""
        return Twist(velocity=self.state[7:10], angular_velocity=self.state[10:])

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        return self._contact

    def signed_distance(self) -> float:
        """Return the signed distance from the joint's point of the rim to the plane, m."""
        kind = exudyn.OutputVariableType.Position
        return float(self._rolling.main.GetObjectOutput(self._rolling.joint, kind)[2])

    def iterations(self) -> int:
        """Return the iterations of Newton's method in the last steps."""
        return int(self._system.main.sys["dynamicSolver"].it.newtonStepsCount)


_STORED: dict[str, Any] = {"storeInternal": True, "writeToFile": False}
_AT_REST = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))
_NONE = Contact(point=np.full(3, np.nan), force=np.zeros(3), penetration=math.nan, count=0)


def _simulation_settings(chosen: Mapping[str, Value]) -> Any:  # noqa: ANN401 - exudyn has no types
    """Return the settings of Exudyn for steps of one length, written nowhere."""
    made = exudyn.SimulationSettings()
    times, newton = made.timeIntegration, made.timeIntegration.newton
    made.solution.file.write = False
    made.solution.sensors.writePeriod = times.minimumStepSize = _ALWAYS
    times.verboseMode = 0
    # a step that fails ends the run: one that is shorter would be another case
    times.automaticStepSize = times.adaptiveStep = False
    times.generalizedAlpha.spectralRadius = chosen["spectralRadius"]
    for name in ("useModifiedNewton", "relativeTolerance", "absoluteTolerance", "maxIterations"):
        setattr(newton, name, chosen[name])
    return made


def _motion(coordinates: Floats, rates: Floats) -> Floats:
    """Return states of the node as position, quaternion, velocity and angular velocity."""
    quaternion = coordinates[:, 3:] + _UNTURNED
    quaternion /= np.linalg.norm(quaternion, axis=1)[:, None]
    # omega = 2 q' q* in world coordinates
    spin = 2.0 * _product(rates[:, 3:].T, (quaternion * _CONJUGATE).T)[1:].T
    return np.hstack((coordinates[:, :3], quaternion, rates[:, :3], spin))


def _product(a: Floats, b: Floats) -> Floats:
    """Return the product of quaternions, scalar first, shape (4,) or (4, n)."""
    w, x, y, z = a
    p, q, r, s = b
    return np.array(
        (
            w * p - x * q - y * r - z * s,
            w * q + x * p + y * s - z * r,
            w * r - x * s + y * p + z * q,
            w * s + x * r - y * q + z * p,
        )
    )
