"""A PhysX scene of a can that can be placed, stepped and read, from a stage of USD.

Numbers are of single precision. PhysX keeps contacts and anchors of friction from step to step:
where the can is placed it is first lifted out of reach for a step, so that nothing is kept. The
contact points are asked for in a step of no length, and the distance of the can from the plane in
one with a contact offset as large as the can, after which the can is placed again where it was.
"""

import gc
import math
import tempfile
import warnings
import weakref
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import ovphysx
import ovstage
from numpy.typing import NDArray
from ovphysx.types import TensorType

from harness.engines import Case, Collision, Contact, Floats, HarnessError, Value
from harness.engines.physx.settings import CUSTOM_GEOMETRY
from harness.engines.physx.stage import ALOFT, stage_text
from models import Pose, Twist

_MOST_CONTACTS = 64

_NO_TIME = 1e-9
"""s: the shortest step, in which contacts are found and nothing moves by what can be told."""


@cache
def _prepare() -> None:
    """Take the processor, no thread of its own, and the schemas of PhysX: once in a process."""
    ovphysx.PhysX.set_cpu_mode(True)
    ovphysx.set_global_config(ovphysx.GlobalConfigKey.NUM_THREADS, 0)
    package = metadata.distribution("physx-usd-schemas")
    folders = [
        package.locate_file(f"physx_usd_schemas/{module}/resources")
        for module in ("PhysxSchema", "OmniUsdPhysicsDeformableSchema")
    ]
    ovstage.population.register_usd_schemas([*map(str, folders), str(ovphysx.newton_schema_root())])


class OpenWorldError(HarnessError, RuntimeError):
    """A world is open whose cylinders are of the other kind: PhysX has one kind in a process."""

    def __str__(self) -> str:
        """Say how both kinds are had."""
        return (
            f"PhysX keeps {CUSTOM_GEOMETRY} for a whole process while a stage is attached, and a "
            "world with another value is open; close that first, or run the two in processes of "
            "their own"
        )


def _choose_cylinder(custom: Value) -> None:
    """Choose what a cylinder is in every stage that is attached from now on.

    Raises
    ------
    OpenWorldError
        While a world is open that has the other.
    """
    key = getattr(ovphysx.GlobalConfigKey, CUSTOM_GEOMETRY)
    if ovphysx.get_global_config(key) == custom:
        return
    gc.collect()  # of worlds that nobody can reach any more
    try:
        ovphysx.set_global_config(key, custom)
    except RuntimeError as error:
        if "stage is attached" not in str(error):
            raise
        raise OpenWorldError from error


def _close(physx: Any, stage: Any, bindings: list[Any]) -> None:  # noqa: ANN401 - has no types
    """Give back what a world holds."""
    for binding in bindings:
        binding.destroy()
    physx.wait_task(physx.detach_ovstage())
    stage.destroy()
    physx.destroy()


_KINDS = (
    TensorType.RIGID_BODY_POSE,
    TensorType.RIGID_BODY_VELOCITY,
    TensorType.RIGID_BODY_MASS,
    TensorType.RIGID_BODY_INERTIA,
    TensorType.RIGID_BODY_CONTACT_OFFSET,
)


class _Tensor:
    """A property of the can, and where it is read to: its shape costs more than its values."""

    def __init__(self, physx: Any, kind: TensorType) -> None:  # noqa: ANN401 - has no types
        self.binding = physx.create_tensor_binding(pattern="/World/Can", tensor_type=kind)
        self._values = np.zeros(self.binding.shape, np.float32)

    def read(self) -> NDArray[np.float32]:
        """Return the values, until they are read again."""
        self.binding.read(self._values)
        return self._values


class PhysxWorld:
    """One can on one plane in PhysX.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        _prepare()
        _choose_cylinder(chosen[CUSTOM_GEOMETRY])
        self._size = case.scene.can.bounding_radius
        self._timestep = timestep
        self.physx = ovphysx.PhysX()
        stage = ovstage.Stage(f"can-{id(self)}")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "can.usda"
            file.write_text(stage_text(case, chosen), encoding="utf-8")
            domains = ovstage.PopulationDomain.ALL
            ovstage.population.open_usd(stage, str(file), ordinal=1, domains=domains)
            stage.advance_write_floor(ordinal=1).wait()
            self.physx.wait_task(self.physx.attach_ovstage(stage, read_ordinal=1))
            self.physx.wait_all()

        with warnings.catch_warnings():  # there is no other way yet to what a contact does
            warnings.simplefilter("ignore", DeprecationWarning)
            self._tensors = [_Tensor(self.physx, kind) for kind in _KINDS]
            self._contacts = self.physx.create_contact_binding(
                sensor_patterns=["/World/Can"],
                filter_patterns=["/World/Ground"],
                filters_per_sensor=1,
                max_contact_data_count=_MOST_CONTACTS,
            )
        self._pose, self._velocity, self._mass, self._inertia, self._reach = self._tensors
        bindings = [*(tensor.binding for tensor in self._tensors), self._contacts]
        weakref.finalize(self, _close, self.physx, stage, bindings)
        self.physx.warmup()
        self._offset = self._reach.read().copy()

    @property
    def mass(self) -> float:
        """Mass of the can, kg."""
        return float(self._mass.read().ravel()[0])

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self._inertia.read().reshape(3, 3)).astype(np.float64)
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
        self._place(
            np.array([[*pose.position, x, y, z, w]], np.float32),
            np.array([[*twist.velocity, *twist.angular_velocity]], np.float32),
        )

    def _place(self, pose: NDArray[np.float32], velocity: NDArray[np.float32]) -> None:
        aloft = np.array([[0.0, 0.0, ALOFT * self._size, 0.0, 0.0, 0.0, 1.0]], np.float32)
        for where, how in ((aloft, np.zeros_like(velocity)), (pose, velocity)):
            self._pose.binding.write(where)
            self._velocity.binding.write(how)
            if where is aloft:
                self.physx.step_sync(_NO_TIME)

    def step(self) -> None:
        """Advance by one timestep."""
        self.physx.step_sync(self._timestep)

    def pose(self) -> Pose:
        """Return where the can is."""
        position, (x, y, z, w) = np.split(self._pose.read()[0].astype(np.float64), [3])
        quaternion = np.array((w, x, y, z))
        return Pose(position=position, quaternion=quaternion / np.linalg.norm(quaternion))

    def twist(self) -> Twist:
        """Return how the can moves."""
        velocity, spin = np.split(self._velocity.read()[0].astype(np.float64), [3])
        return Twist(velocity=velocity, angular_velocity=spin)

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        loads, points, normals, gaps = self._touching()
        bears = loads > 0.0
        force, point = np.zeros(3), np.full(3, np.nan)
        if bears.any():
            friction = np.zeros((1, 3), np.float32)
            self._contacts.read_net_friction_forces(friction)
            force = loads @ normals + friction[0].astype(np.float64)
            point = loads @ points / loads.sum()
        return Contact(
            point=point,
            force=force,
            penetration=-float(gaps.min()) if len(gaps) else math.nan,
            count=int(bears.sum()),
        )

    def _touching(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return normal force (n,), point (n, 3), normal (n, 3) and gap (n,) of each contact."""
        found = [np.zeros((_MOST_CONTACTS, width), np.float32) for width in (1, 3, 3, 1)]
        count, start = np.zeros((1, 1), np.uint32), np.zeros((1, 1), np.uint32)
        self._contacts.read_normal_contact_data(*found, count, start)
        loads, points, normals, gaps = (
            each[: int(count[0, 0])].astype(np.float64) for each in found
        )
        return loads[:, 0], points, normals, gaps[:, 0]

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        self._reach.binding.write(np.full_like(self._offset, self._size))
        depths = self.collision().depths
        self._reach.binding.write(self._offset)
        return -float(depths.max()) if len(depths) else math.inf

    def collision(self) -> Collision:
        """Return the points that are found where the can is, which stays there."""
        pose, velocity = self._pose.read().copy(), self._velocity.read().copy()
        self._place(pose, np.zeros_like(velocity))
        self.physx.step_sync(_NO_TIME)
        _, points, normals, gaps = self._touching()
        self._place(pose, velocity)
        return Collision(points=points, normals=normals, depths=-gaps)
