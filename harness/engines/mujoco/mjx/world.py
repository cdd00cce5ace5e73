"""A scene in MJX: MuJoCo's compiled model as arrays of JAX, stepped in one compiled loop.

The loop carries position, velocity and the warm start of the solver, all that a step of MuJoCo
starts from. Timestep and `solref` are among its arguments, so that a step of another length is no
other program; one compiled loop serves every model of the same structure.

MJX has no sensor of the resultant of contacts; its numbers are made here, as MuJoCo makes them.
"""

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, TypeAlias

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from mujoco import mjx
from numpy.typing import NDArray

from harness.engines import Case, Collision, Floats, RefusedModelError, Value
from harness.engines.mujoco.array_stepping import ArrayWorld
from harness.engines.mujoco.mjx.settings import X64

_ROWS = 256
"""Steps in a call at most, and those of the longest stage of adaptive steps."""

if jax.config.jax_compilation_cache_dir is None:  # or where the user has one
    _CACHES = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    jax.config.update("jax_compilation_cache_dir", str(_CACHES / "rockingcan" / "jax"))

_FOLLOWING = ("geom_solref", "pair_solref", "pair_solreffriction")
"""Arrays of the model that may change with the timestep."""

Carried: TypeAlias = tuple[Any, ...]
"""qpos, qvel, the warm start of the solver, and the iterations of the last step."""


@contextmanager
def computing(*, double: bool) -> Iterator[None]:
    """Let JAX compute in this precision on the processor, and leave others in the process alone."""
    with jax.enable_x64(double), jax.default_device(_processor()):
        yield


def _processor() -> jax.Device:
    """Return the processor as JAX's device."""
    return jax.local_devices(backend="cpu")[0]


def _solved(data: mjx.Data) -> mjx.DataJAX:
    """Return where MJX has its contacts, the forces and the counts of its solver."""
    return data._impl  # noqa: SLF001 - there is no other way to them


def _resultant(model: mjx.Model, data: mjx.Data) -> jax.Array:
    """Return what MuJoCo's sensors of the contact would, shape (8,).

    The number of contacts, their force and its centre, and the distance of the deepest.
    """
    contact, forces = _solved(data).contact, _solved(data).efc_force
    pyramidal = model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
    each = []
    for place, address in enumerate(contact.efc_address.tolist()):
        dimension = int(contact.dim[place])
        if pyramidal and dimension > 1:
            edges = forces[address : address + 4]
            friction = contact.friction[place]
            own = jnp.stack(
                (
                    forces[address : address + 2 * (dimension - 1)].sum(),
                    (edges[0] - edges[1]) * friction[0],
                    (edges[2] - edges[3]) * friction[1],
                )
            )
        else:
            own = jnp.zeros(3, forces.dtype)
            own = own.at[: min(dimension, 3)].set(forces[address : address + min(dimension, 3)])
        each.append(own @ contact.frame[place])
    near = contact.dist < contact.includemargin
    force = jnp.where(near[:, None], jnp.stack(each), 0.0)
    weight = jnp.linalg.norm(force, axis=1)
    centre = (weight[:, None] * contact.pos).sum(axis=0) / weight.sum()
    head, tail = near.sum(keepdims=True), contact.dist.min(keepdims=True)
    return jnp.concatenate((head, force.sum(axis=0), centre, tail), dtype=forces.dtype)


def _steps(  # noqa: PLR0917 - the first two are bound
    structure: jax.tree_util.PyTreeDef,
    body: int,
    arrays: list[jax.Array],
    carried: Carried,
    forces: jax.Array | None,
    steps: int,
) -> tuple[Carried, jax.Array]:
    """Take steps; return what is carried on and the rows of the steps, shape (_ROWS, 21)."""
    model = jax.tree.unflatten(structure, arrays)
    data = mjx.make_data(model)

    def step(place: int, loop: tuple[Carried, jax.Array]) -> tuple[Carried, jax.Array]:
        (qpos, qvel, warm, _), rows = loop
        now = data.replace(qpos=qpos, qvel=qvel, qacc_warmstart=warm)
        if forces is not None:
            applied = now.xfrc_applied.at[body, :3].set(forces[place])
            now = now.replace(xfrc_applied=applied)
        after = mjx.step(model, now)
        row = jnp.concatenate((qpos, qvel, _resultant(model, after)))
        iterations = _solved(after).solver_niter.astype(jnp.int32)
        carried = (after.qpos, after.qvel, after.qacc_warmstart, iterations)
        return carried, rows.at[place].set(row)

    rows = jnp.zeros((_ROWS, 21), data.qpos.dtype)
    done: tuple[Carried, jax.Array] = jax.lax.fori_loop(0, steps, step, (carried, rows))
    return done


def _tangents(  # noqa: PLR0917 - the first two are bound
    structure: jax.tree_util.PyTreeDef,
    body: int,
    arrays: list[jax.Array],
    carried: Carried,
    tangents: Carried,
    forces: jax.Array | None,
    steps: int,
) -> tuple[Carried, jax.Array, Carried, jax.Array]:
    """Take steps and differentiate them, forward; return what is carried, rows, and both's changes.

    `tangents` are k changes of qpos, qvel and the warm start, shapes (k, 7), (k, 6) and (k, 6).
    """
    *state, iterations = carried

    def taken(*state: jax.Array) -> tuple[Carried, jax.Array]:
        (*after, _), rows = _steps(structure, body, arrays, (*state, iterations), forces, steps)
        return tuple(after), rows

    def along(tangent: Carried) -> tuple[tuple[Carried, jax.Array], tuple[Carried, jax.Array]]:
        both: tuple[tuple[Carried, jax.Array], tuple[Carried, jax.Array]]
        both = jax.jvp(taken, tuple(state), tangent)
        return both

    (after, rows), (changes, of_rows) = jax.vmap(along, out_axes=(None, 0))(tangents)
    return (*after, iterations), rows, changes, of_rows


def _near(
    structure: jax.tree_util.PyTreeDef, arrays: list[jax.Array], qpos: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return the points that MJX finds, their frames, and their distances, m."""
    model = jax.tree.unflatten(structure, arrays)
    placed = mjx.kinematics(model, mjx.make_data(model).replace(qpos=qpos))
    contact = _solved(mjx.collision(model, placed)).contact
    return contact.pos, contact.frame, contact.dist


@lru_cache(maxsize=32)
def _compiled(
    structure: jax.tree_util.PyTreeDef, body: int
) -> tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]:
    """Return the loop, the contacts and the loop with its derivative, compiled when first called.

    They are for models of one structure.
    """
    # one thread: a step has nothing to share out
    options = {"xla_cpu_multi_thread_eigen": False}
    return (
        jax.jit(partial(_steps, structure, body), compiler_options=options),
        jax.jit(partial(_near, structure), compiler_options=options),
        jax.jit(partial(_tangents, structure, body), compiler_options=options),
    )


class MjxWorld(ArrayWorld):
    """One can on one plane in MJX.

    The box that is a ground is smaller than MuJoCo's: MJX leaves a point out by a mask of -1e6,
    which squared lengths from 1 km on outweigh.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    half_box = (300.0, 300.0, 1.0)

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        super().__init__(case, chosen, timestep, {}, contact_sensors=False)
        double = bool(chosen[X64])
        self.real = np.float64 if double else np.float32
        self._computing = partial(computing, double=double)
        try:
            with self._computing(), warnings.catch_warnings():
                # that of a base with more than 20 corners it keeps every second: the prism has more
                warnings.filterwarnings("ignore", "Mesh .* has a coplanar face", UserWarning)
                self._put()
        except NotImplementedError as error:
            raise RefusedModelError(case.engine, case.label(), str(error)) from error
        self._carried: Carried = ()
        self.begin()

    def _put(self) -> None:
        """Hand MuJoCo's model over to JAX."""
        self._mjx = mjx.put_model(self.model, device=_processor())
        mjx.make_data(self._mjx)  # refuses what a step cannot do
        self._arrays, structure = jax.tree.flatten(self._mjx)
        self.loop, self._contacts, self._tangents = _compiled(structure, self._body)

    def of_can(self, field: str) -> Floats:
        """Return what MJX has of the can, by the name of the model's array."""
        return np.asarray(getattr(self._mjx, field)[self._body], dtype=np.float64)

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on; a contact tied to the timestep goes with it."""
        if timestep != self.timestep:
            super().set_timestep(timestep)
            with self._computing():
                following = {name: getattr(self.model, name) for name in _FOLLOWING}
                following["opt.timestep"] = np.array(self.timestep)
                # put on the device like the model: arrays that are not are another program
                self._mjx = self._mjx.tree_replace(jax.device_put(following, _processor()))
                self._arrays = jax.tree.leaves(self._mjx)

    def advance(self, state: Floats | None, forces: Floats | None, steps: int) -> Floats:
        """Take steps; return a row for each, and one of the state after the last."""
        # numpy's arrays go in, whatever came out: arrays of another origin are another program
        parts = []
        if state is not None:
            self._carried = self._beginning(state)
        with self._computing():
            for count, applied in self._calls(forces, steps):
                carried, rows = self.loop(self._arrays, self._carried, applied, count)
                self._carried = tuple(map(np.asarray, carried))
                parts.append(np.asarray(rows, dtype=np.float64)[:count])
        last = np.full((1, 21), np.nan)
        last[0, :13] = np.concatenate(self._carried[:2])
        return np.concatenate((*parts, last))

    def differentiate(
        self, tangents: Floats, forces: Floats | None, steps: int
    ) -> tuple[Floats, Floats]:
        """Take steps from where the can was placed, and differentiate them.

        Parameters
        ----------
        tangents : ndarray, shape (k, 13)
            Changes of qpos and qvel at the start.
        forces : ndarray, shape (steps, 3), or None
            On the centre of mass, N.
        steps : int

        Returns
        -------
        ndarray, shape (steps, 13)
            qpos and qvel before each step.
        ndarray, shape (steps, 13, k)
            Their changes; not numbers where MJX has no derivative.
        """
        assert self._given is not None  # noqa: S101 - it was placed
        carried = self._beginning(self._given)
        moved: Carried = tuple(
            part.astype(self.real)
            for part in (tangents[:, :7], tangents[:, 7:], np.zeros((len(tangents), 6)))
        )
        parts, changes = [], []
        with self._computing():
            for count, applied in self._calls(forces, steps):
                now = self._tangents(self._arrays, carried, moved, applied, count)
                carried, moved = tuple(map(np.asarray, now[0])), tuple(map(np.asarray, now[2]))
                parts.append(np.asarray(now[1], dtype=np.float64)[:count, :13])
                changes.append(np.asarray(now[3], dtype=np.float64)[:, :count, :13])
        return np.concatenate(parts), np.moveaxis(np.concatenate(changes, axis=1), 0, 2)

    def _beginning(self, state: Floats) -> Carried:
        """Return what a cold start from qpos and qvel, shape (13,), carries."""
        halves = state[:7].astype(self.real), state[7:].astype(self.real)
        return (*halves, np.zeros(6, self.real), np.zeros((), np.int32))

    def _calls(
        self, forces: Floats | None, steps: int
    ) -> Iterator[tuple[int, NDArray[np.floating] | None]]:
        """Yield for each call how many steps it takes, and its forces, shape (_ROWS, 3)."""
        for start in range(0, steps, _ROWS):
            count = min(_ROWS, steps - start)
            applied = None
            if forces is not None:
                applied = np.zeros((_ROWS, 3), self.real)
                applied[:count] = forces[start : start + count]
            yield count, applied

    @property
    def iterations(self) -> int:
        """Iterations of the solver in the last step."""
        return int(self._carried[3])

    def collision(self) -> Collision:
        """Return the points where the can touches, and those above the plane, without a step."""
        with self._computing():
            found = self._contacts(self._arrays, self._state[:7].astype(self.real))
        points, frames, distances = (np.asarray(each, dtype=np.float64) for each in found)
        return Collision(points=points, normals=frames[:, 0], depths=-distances)
