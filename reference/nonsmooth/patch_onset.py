"""How a patch of contact at rest begins to slip and turn together.

A patch at rest is held while force and moment lie inside the limit surface of its friction
(`reference.equations.patch_friction`). Beyond it the motion q = (u1, u2, a omega_z) that grows from
nothing keeps its direction, so that its acceleration A, which depends on the direction alone, is
along it:

    q = A(q/|q|),    N > 0,    normal mobility > 0.

On the surface itself the direction is its normal there, with A = 0: Newton's method begins with the
normal where the ray of the reaction meets it, and finds the direction beyond it in a few rounds.
Where that finds nothing it begins in directions all round; several solutions are indeterminate.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reference.equations.contact_laws import Contact, Equations, Mode
from reference.equations.frames import to_body, to_level
from reference.equations.newton_euler import GeneralEquations
from reference.equations.patch_friction import motion_against
from reference.equations.state_vector import LEAN, SLIP, TURN, Angles
from reference.nonsmooth.level_spin import BESIDE
from reference.nonsmooth.slip_onset import RIM, UnilateralHold
from reference.problem.outcome import Outcome
from reference.problem.states import Floats

ROUNDS = 60
# Directions round which Newton's method begins where the likely one leads nowhere.
STARTS = 24
# Imaginary step of derivatives, over the size of what is stepped; nothing is subtracted.
STEP = 1e-40
# What round-off of forces of size 1 leaves of an acceleration on the limit surface.
NOISE = 1e-14
# Of an acceleration: solved to this share, and two solutions this near are one.
SOLVED, SAME = 1e-8, 1e-4


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchOnset:
    """Onset of the motion of a patch: (u1, u2, a omega_z) = size sigma `toward`."""

    toward: tuple[float, float, float]
    size: float

    @property
    def direction(self) -> Floats:
        """Return the unit vector of the direction, shape (3,)."""
        return np.array(self.toward)


def moving(equations: Equations, y: Floats) -> Floats:
    """Return what friction opposes: the slip, (2, n), of a patch with a omega_z, (3, n)."""
    slip = y[SLIP]
    if not equations.patch:
        return slip
    column = y if y.ndim > 1 else y[:, None]
    turn = equations.patch * equations.turning(column)
    return np.array([*slip, turn if y.ndim > 1 else turn[0]])


def hardly_moves(equations: Equations, y: Floats) -> NDArray[np.bool_]:
    """Return whether a point has no slip, and a patch no motion but a round-off, shape (n,).

    Of states of shape (13, n).
    """
    least = equations.patch * BESIDE * (1 + np.abs(y[TURN]).max(axis=0))
    return np.asarray(np.linalg.norm(moving(equations, y), axis=0) <= least)


def rim_of(equations: Equations) -> UnilateralHold:
    """Return how friction holds the rim: at a point, or in a patch."""
    return _of_patch(equations.patch) if equations.patch else RIM


def towards(equations: Equations, y: Floats, ahead: Floats) -> Floats:
    """Return states that hardly move, in the direction of others, both of shape (13, n)."""
    motion = moving(equations, ahead)
    return rim_of(equations).infinitesimal(y, motion / np.linalg.norm(motion, axis=0))


def with_turning(y: Floats, turning: Floats) -> Floats:
    """Return states (13, n) that turn about the normal at the given rates, shape (n,)."""
    at = Angles.of(y[LEAN])
    level = to_level(y[TURN], at)
    columns = y.astype(np.result_type(y, turning))
    columns[TURN] = to_body(np.array([level[0], level[1], turning + np.zeros_like(at.S)]), at)
    return columns


@lru_cache(maxsize=8)
def _of_patch(radius: float) -> UnilateralHold:
    def infinitesimal(y: Floats, direction: Floats) -> Floats:
        # fast enough that its turning has a sense beside the round-off of the others
        small = radius * BESIDE * (1 + np.abs(y[TURN]).max(axis=0))
        columns = with_turning(y, small * direction[2] / radius)
        columns[SLIP] = small * direction[:2]
        return columns

    def acceleration(contact: Contact, y: Floats) -> Floats:
        about = to_level(contact.turning, Angles.of(y[LEAN]))[2]
        return np.array([*contact.slipping, radius * about])

    def reaction(equations: Equations, contact: Contact) -> tuple[Floats, Floats]:
        taken = np.array([*contact.force[:2], contact.moment[2] / radius])
        return -motion_against(taken), equations.mu_static * contact.force[2]

    return UnilateralHold(
        freed=RIM.freed,
        infinitesimal=infinitesimal,
        acceleration=acceleration,
        reaction=reaction,
        patch=True,
    )


def patch_onset(equations: GeneralEquations, y: Floats, mode: Mode) -> PatchOnset | Outcome:
    """Return the only admissible motion of a patch from rest, or why there is not one.

    Parameters
    ----------
    equations : GeneralEquations
        With a patch.
    y : ndarray, shape (13,)
    mode : Mode
        In which the patch moves.
    """
    columns = y[:, None]
    good, others, falls = _admissible(equations, columns, mode, _against(equations, columns, mode))
    if not good:
        columns = np.repeat(columns, STARTS, axis=1)
        good, others, falls = _admissible(equations, columns, mode, _all_round())
    if len(good) == 1:
        return good[0]
    if good or (others and not falls):
        return Outcome.INDETERMINATE
    return Outcome.INCONSISTENT if falls else Outcome.LIFTED


def growth(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the accelerations with which a patch would begin to move, shape (3, n).

    Of states at rest, shape (13, n), in a mode in which the patch moves; zero where it is held.
    """
    q = _solved(equations, y, mode, _against(equations, y, mode))
    return np.where(_is_solution(equations, y, mode, q)[0], q, 0.0)


def _all_round() -> Floats:
    """Return directions on a spiral round the sphere, shape (3, STARTS)."""
    height = 1 - (2 * np.arange(STARTS) + 1) / STARTS
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(STARTS)
    across = np.sqrt(1 - height**2)
    return np.array([across * np.cos(angle), across * np.sin(angle), height])


def _against(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the directions of what the reactions that hold a patch oppose, shape (3, n)."""
    held = equations.contact(y, replace(mode, slips=False))
    against = -rim_of(equations).reaction(equations, held)[0]
    return np.asarray(against / np.linalg.norm(against, axis=0))


def _solved(equations: GeneralEquations, y: Floats, mode: Mode, starts: Floats) -> Floats:
    """Return the motions to which Newton's method leads from directions, shape (3, n)."""
    q, _ = _accelerated(equations, y, mode, starts)
    along = np.maximum((q * starts).sum(axis=0), NOISE)
    q = starts * along
    for _ in range(ROUNDS):
        k = q.shape[1]
        size = np.linalg.norm(q, axis=0)
        shifted = np.repeat(q[:, None, :], 3, axis=1).astype(complex)
        shifted[range(3), range(3)] += 1j * STEP * size
        states = np.tile(y, (1, 3))
        found, _ = _accelerated(equations, states, mode, shifted.reshape(3, 3 * k))
        found = found.reshape(3, 3, k)
        slopes = np.moveaxis(found.imag / (STEP * size), -1, 0)
        residual = q - found[:, 0].real
        matrix = np.eye(3) - slopes
        matrix[~(np.abs(np.linalg.det(matrix)) > 0)] = np.eye(3)  # a start that leads nowhere
        update = np.linalg.solve(matrix, residual.T[..., None])[..., 0].T
        # a motion turns by half of itself at most
        length = np.linalg.norm(update, axis=0)
        most = np.maximum(0.5 * size, np.finfo(float).tiny)
        update *= 0.5 * size / np.maximum(length, most)
        q = q - update
        if (length <= SOLVED * size).all():
            break
    return np.asarray(q)


def _is_solution(
    equations: GeneralEquations, y: Floats, mode: Mode, q: Floats
) -> tuple[NDArray[np.bool_], Contact]:
    """Return whether motions are their own accelerations under a push, and their contact."""
    found, contact = _accelerated(equations, y, mode, q)
    size = np.linalg.norm(q, axis=0)
    noise = NOISE * np.maximum(np.abs(contact.force).max(axis=0), 1.0)
    solved = np.linalg.norm(q - found, axis=0) <= np.maximum(SOLVED * size, noise)
    return np.asarray(solved & (size > 0) & (contact.force[2] > 0)), contact


def _admissible(
    equations: GeneralEquations, y: Floats, mode: Mode, starts: Floats
) -> tuple[list[PatchOnset], int, bool]:
    """Return the motions found, how many more have no mobility, and whether a free can falls."""
    q = _solved(equations, y, mode, starts)
    solved, contact = _is_solution(equations, y, mode, q)
    size = np.linalg.norm(q, axis=0)
    falls = bool(np.median(contact.force[2] * contact.normal_mobility) > 0)
    good: list[PatchOnset] = []
    for index in np.flatnonzero(solved & (contact.normal_mobility > 0)):
        toward = q[:, index] / size[index]
        if all(np.abs(one.direction - toward).max() > SAME for one in good):
            one, two, three = toward.tolist()
            good.append(PatchOnset(toward=(one, two, three), size=float(size[index])))
    return good, int((solved & (contact.normal_mobility <= 0)).sum()), falls


def _accelerated(
    equations: GeneralEquations, y: Floats, mode: Mode, motion: Floats
) -> tuple[Floats, Contact]:
    """Return the acceleration of a patch that begins to move, shape (3, n), and its contact."""
    columns = y.astype(motion.dtype)
    contact = equations.begun(columns, mode, motion)
    return rim_of(equations).acceleration(contact, columns), contact
