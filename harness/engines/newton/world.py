"""A Newton model of a can that can be placed, stepped and read.

A step is collision, solver, and a copy of the new state to where the step starts from. Its launches
are captured once for each timestep, on the processor too: as a graph they cost a hundredth. Nothing
of a step is kept for the next but the state. Newton tells a contact's distance within the gap of
its shapes: the distance from the plane is asked for with a gap that every can is within.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import warp

from harness.engines import (
    MESH_SETTING,
    Case,
    Collision,
    Contact,
    Floats,
    Mesh,
    Value,
    declared_friction,
    hull_triangles,
    mesh_points,
    prism,
)
from harness.engines.newton.settings import CONVEX_HULL, CYLINDER, SHAPE, SIDES, STEEL
from harness.engines.suppress_output import silence
from models import Can, Pose, Twist, to_body
from models.gravity import gravity_vector
from models.mass import body as body_of

warp.config.log_level = warp.LOG_ERROR
with silence():  # Warp is started, which warns on standard error that there is no graphics card
    warp.init()
    import newton
    from newton import solvers

_DEVICE = "cpu"

_FAR = 10.0
"""m: a gap within which every can is that is asked; of 1 km a hull's distance is 37 um off."""

_OF_STEEL = ("iterations", "baumgarte", "cfm", "friction_anchor_beta", "contact_gap_gate")
_OF_XPBD = ("iterations", "rigid_contact_relaxation", "rigid_contact_con_weighting")


def handed(chosen: Mapping[str, Value]) -> dict[str, Value]:
    """Return the arguments that are handed to the solver; it has its own way with the others."""
    names = _OF_STEEL if chosen["solver"] == STEEL else _OF_XPBD
    return {name: chosen[name] for name in names if chosen[name] is not None}


class NewtonWorld:
    """One can on one plane in Newton.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        scene, solid = case.scene, body_of(case.scene)
        self._timestep, self._graphs = timestep, dict[float, Any]()
        builder = newton.ModelBuilder(
            up_axis=newton.Axis.Z, gravity=tuple(gravity_vector(scene).tolist())
        )
        steel = chosen["solver"] == STEEL
        if steel:
            solvers.SolverSteel.register_custom_attributes(builder)
        self._body = builder.add_body(
            mass=solid.mass, inertia=warp.mat33(*solid.inertia.ravel()), lock_inertia=True
        )
        mu = declared_friction(scene)
        shape = newton.ModelBuilder.ShapeConfig(
            density=0.0, mu=mu, mu_torsional=0.0, mu_rolling=0.0, gap=chosen["gap"]
        )
        self._can = _add_can(builder, self._body, scene.can, chosen, shape)
        builder.add_ground_plane(cfg=shape)
        self._model = builder.finalize(device=_DEVICE)
        arguments = handed(chosen)
        if steel:
            damping = float(chosen["rigid_body_angular_damping"])  # type: ignore[arg-type]
            self._model.steel.rigid_body_angular_damping.fill_(damping)
            self._solver = solvers.SolverSteel(self._model, **arguments)
        else:
            self._solver = solvers.SolverXPBD(self._model, **arguments)
        self._now, self._next = self._model.state(), self._model.state()
        self._before = warp.zeros_like(self._now.body_q)
        self._control = self._model.control()
        self._pipeline = newton.CollisionPipeline(self._model, broad_phase="nxn")
        self._contacts = self._pipeline.contacts()
        self._observed = self._solver.observables({"contact_f"}, contacts=self._contacts)
        self._near: tuple[Any, Any] | None = None
        self._far: tuple[Any, Any, Any] | None = None

    @property
    def mass(self) -> float:
        """Mass of the can, kg."""
        return float(self._model.body_mass.numpy()[self._body])

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes, shape (3,), kg m^2."""
        tensor = self._model.body_inertia.numpy()[self._body]
        moments: Floats = np.diagonal(tensor).astype(np.float64)
        return moments

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        self._timestep = timestep

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        w, x, y, z = pose.quaternion
        position = np.array((*pose.position, x, y, z, w), np.float32)
        velocity = np.array((*twist.velocity, *twist.angular_velocity), np.float32)
        for state in (self._now, self._next):
            state.body_q.assign(position[None])
            state.body_qd.assign(velocity[None])
            state.joint_q.assign(position)
            state.joint_qd.assign(velocity)

    def _launch(self) -> None:
        """Launch the kernels of a step."""
        now, new = self._now, self._next
        warp.copy(self._before, now.body_q)
        self._pipeline.collide(now, self._contacts)
        now.clear_forces()
        self._solver.step(
            now, new, self._control, self._contacts, self._timestep, observables=self._observed
        )
        for old, fresh in (
            (now.body_q, new.body_q),
            (now.body_qd, new.body_qd),
            (now.joint_q, new.joint_q),
            (now.joint_qd, new.joint_qd),
        ):
            warp.copy(old, fresh)

    def step(self) -> None:
        """Advance by one timestep."""
        if self._timestep not in self._graphs:
            kept = [
                array.numpy().copy()
                for array in (
                    *(self._now.body_q, self._now.body_qd),
                    *(self._now.joint_q, self._now.joint_qd),
                )
            ]
            self._launch()  # which compiles what is launched
            with warp.ScopedCapture(device=_DEVICE) as capture:
                self._launch()
            self._graphs[self._timestep] = capture.graph
            for state in (self._now, self._next):
                arrays = state.body_q, state.body_qd, state.joint_q, state.joint_qd
                for array, values in zip(arrays, kept, strict=True):
                    array.assign(values)
        warp.capture_launch(self._graphs[self._timestep])

    def pose(self) -> Pose:
        """Return where the can is."""
        position, quaternion = _frame(self._now.body_q.numpy()[self._body])
        return Pose(position=position, quaternion=quaternion)

    def twist(self) -> Twist:
        """Return how the can moves."""
        velocity, spin = np.split(self._now.body_qd.numpy()[self._body].astype(np.float64), [3])
        return Twist(velocity=velocity, angular_velocity=spin)

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        points, depths, own = self._touching(self._contacts, self._before)
        forces = self._observed.contact_f.numpy()[: len(own), :3].astype(np.float64)
        forces *= np.where(own, 1.0, -1.0)[:, None]
        bears = forces[:, 2] > 0.0
        loads = forces[bears, 2]
        return Contact(
            point=loads @ points[bears] / loads.sum() if bears.any() else np.full(3, np.nan),
            force=forces[bears].sum(axis=0),
            penetration=float(depths.max()) if len(depths) else math.nan,
            count=int(bears.sum()),
        )

    def _touching(self, contacts: Any, where: Any) -> tuple[Floats, Floats, Any]:  # noqa: ANN401
        """Return point on the can (n, 3), depth (n,), and whether the can is the first shape."""
        count = int(contacts.rigid_contact_count.numpy()[0])
        first, second = (
            each.numpy()[:count].astype(np.float64)
            for each in (contacts.rigid_contact_point0, contacts.rigid_contact_point1)
        )
        own = contacts.rigid_contact_shape0.numpy()[:count] == self._can
        on_can, on_plane = (
            np.where(own[:, None], *pair) for pair in ((first, second), (second, first))
        )
        position, quaternion = _frame(where.numpy()[self._body])
        points = position + on_can @ to_body(quaternion, np.eye(3)).T
        return points, on_plane[:, 2] - points[:, 2], own

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        near = self._model.shape_gap
        if self._far is None:
            wide = warp.full_like(near, _FAR)
            pipeline = newton.CollisionPipeline(self._model, broad_phase="nxn")
            self._far = wide, pipeline, pipeline.contacts()
        self._model.shape_gap, *asked = self._far
        depths = self._found(*asked).depths
        self._model.shape_gap = near
        return -float(depths.max()) if len(depths) else math.inf

    def collision(self) -> Collision:
        """Return the points within the gap of the shapes, without a step; normals are not told."""
        if self._near is None:
            pipeline = newton.CollisionPipeline(self._model, broad_phase="nxn")
            self._near = pipeline, pipeline.contacts()
        return self._found(*self._near)

    def _found(self, pipeline: Any, contacts: Any) -> Collision:  # noqa: ANN401
        """Return the points that a collision finds where the can is."""
        pipeline.collide(self._now, contacts)
        points, depths, _ = self._touching(contacts, self._now.body_q)
        return Collision(points=points, normals=np.full_like(points, math.nan), depths=depths)


def _add_can(
    builder: Any,  # noqa: ANN401 - Newton's
    body: int,
    can: Can,
    chosen: Mapping[str, Value],
    shape: Any,  # noqa: ANN401
) -> int:
    """Return the index of the shape that is the can's."""
    mesh: Mesh | None = chosen[MESH_SETTING.name]  # type: ignore[assignment] # as it was checked
    name = str(chosen[SHAPE])
    if mesh is None and name == CYLINDER:
        sizes = {"radius": can.radius, "half_height": can.half_height}
        return int(builder.add_shape_cylinder(body, **sizes, cfg=shape))
    add = getattr(builder, CONVEX_HULL if name == CYLINDER else name)
    points = mesh_points(mesh or prism(SIDES), can)
    hull = newton.Mesh(points, hull_triangles(points).ravel(), compute_inertia=False)
    return int(add(body, mesh=hull, cfg=shape))


def _frame(values: Any) -> tuple[Floats, Floats]:  # noqa: ANN401 - of Warp
    """Return position and quaternion, scalar first, of a transform."""
    position, (x, y, z, w) = np.split(values.astype(np.float64), [3])
    quaternion = np.array((w, x, y, z))
    return position, quaternion / np.linalg.norm(quaternion)
