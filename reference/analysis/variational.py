"""Growth of small disturbances of a motion, by its variational equations along its pieces.

With y' = f(y) in the time sigma of `reference.equations.state_vector`, a disturbance d of the
state obeys

    d' = J(y) d,    J = df/dy,

which is linear: no disturbance is too small or too large. After each piece d is scaled to size 1
and the logarithm of its size is stored (renormalisation; Benettin, Galgani, Giorgilli and
Strelcyn, Meccanica 15, 1980). Each piece is one step of the Radau collocation that made it
(`reference.nonsmooth.radau_iia`), with J (`reference.analysis.linearisation`) for Newton's matrix.

The time is a state, t' = S. The difference d of two motions at the same sigma becomes their
difference at the same time, d - f d_t/S.

Across a switch of the law they go by `reference.analysis.saltation`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from reference.analysis.linearisation import CORE, NUMBER, core_of, jacobian
from reference.analysis.saltation import CUTS, ByConstants, PieceEnd, across, endings, held
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import (
    LEAN,
    PSI,
    TIME,
    TOTAL,
    W1,
    W3,
    Angles,
)
from reference.nonsmooth.radau_iia import basis, coefficients, integrator, points
from reference.nonsmooth.segments import Segment
from reference.problem.problem import Problem
from reference.problem.states import Floats

CREEPS = "dry friction along the rim lets the contact point creep"
DISTURBED = ("phi", "theta", "psi_dot", "theta_dot")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Disturbances along one piece, at its collocation points.

    Attributes
    ----------
    states : ndarray, shape (rows, n)
        Of the motion; the last at the end of the piece.
    rates : ndarray, shape (k, n)
        Of the core (`reference.analysis.linearisation.core_of`), in sigma.
    disturbances : ndarray, shape (k, m, n)
        Likewise, at the same sigma, scaled.
    logarithms : ndarray, shape (m,)
        Of the scales: exp of them times the above is what was disturbed.
    piece : Segment
    start : ndarray, shape (k, m)
        Disturbances at the start of the piece, scaled.
    """

    states: Floats
    rates: Floats
    disturbances: Floats
    logarithms: Floats
    piece: Segment
    start: Floats

    def at(self, c: float) -> Floats:
        """Return the disturbances at a place in [0, cut] of the piece, shape (k, m), not scaled."""
        change = coefficients(self.disturbances - self.start[:, :, None])
        scaled = self.start + change @ basis(np.array([c / self.piece.cut]))[0]
        return np.asarray(scaled * np.exp(self.logarithms))

    @property
    def times(self) -> Floats:
        """Return the times of the states, shape (n,)."""
        return np.asarray(self.states[TIME])

    def angles(self) -> Floats:
        """Return angles between the orientations at the same time, shape (m, n), scaled."""
        at = Angles.of(self.states[LEAN])
        late = self.disturbances[NUMBER[TIME]] / self.rates[NUMBER[TIME]]
        lean, psi, total = (
            self.disturbances[NUMBER[row]] - self.rates[NUMBER[row]] * late
            for row in (LEAN, PSI, TOTAL)
        )
        aside, about = at.S * psi, total - at.S * at.T * psi
        return np.asarray(np.sqrt((at.S * lean) ** 2 + aside**2 + about**2))


def without_tangent(pieces: tuple[Segment, ...]) -> str:
    """Return why disturbances of a motion obey no equations that are here; empty if they do."""
    return CREEPS if any(piece.mode.creeps for piece in pieces) else ""


def release_disturbances(problem: Problem) -> Floats:
    """Return disturbances of a release, rows `CORE`, a column each of `DISTURBED`, shape (9, 4)."""
    S, C = np.sin(problem.phi), np.cos(problem.phi)
    out = np.zeros((CORE.size, len(DISTURBED)))
    phi, theta, psi_dot, theta_dot = range(len(DISTURBED))
    out[NUMBER[LEAN], phi] = 1 / S
    out[NUMBER[W1], phi], out[NUMBER[W3], phi] = problem.psi_dot * C, -problem.psi_dot * S
    out[NUMBER[TOTAL], theta] = 1.0
    out[NUMBER[W1], psi_dot], out[NUMBER[W3], psi_dot] = S, C
    out[NUMBER[W3], theta_dot] = 1.0
    return out


def stretches(
    equations: GeneralEquations,
    pieces: tuple[Segment, ...],
    start: Floats,
    by_constants: ByConstants | None = None,
) -> Iterator[Stretch]:
    """Yield the disturbances along each piece of a motion.

    Parameters
    ----------
    equations : GeneralEquations
        Of the motion that the pieces are.
    pieces : tuple of Piece
    start : ndarray, shape (k, m)
        Disturbances of the core at the release.
    by_constants : callable, optional
        Derivatives of quantities by those constants of the equations that the disturbances are
        of, zero of all others.
    """
    now, logarithms = held(equations, pieces[0], start), np.zeros(start.shape[1])
    ends: list[PieceEnd] = []
    left_out = 0.0
    for piece, ending in zip(pieces, endings(pieces, equations.patch), strict=True):
        if ending:
            left_out += piece.length * piece.cut
            continue
        if ends:
            now = across(equations, ends, left_out, piece, logarithms, by_constants=by_constants)
        scale = np.linalg.norm(now, axis=0)
        scale[scale == 0] = 1.0
        now, logarithms = now / scale, logarithms + np.log(scale)
        y = piece.at(piece.cut * points())
        rates, J = jacobian(equations, y, piece.mode)
        core = [NUMBER[row] for row in equations.core(piece.mode).tolist()]
        forced = None
        if by_constants is not None:
            forced = by_constants(_rates, y, piece.mode) / np.exp(logarithms)[:, None]
        change = _change(J, piece.length * piece.cut, now, core, forced)
        disturbances = now[:, :, None] + change
        yield Stretch(
            states=y,
            rates=rates,
            disturbances=disturbances,
            logarithms=logarithms,
            piece=piece,
            start=now,
        )
        now, left_out = disturbances[:, :, -1], 0.0
        ends = [*ends[1 - CUTS :], PieceEnd(piece, rates[:, -1], now, logarithms)]


def _rates(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    return np.asarray(equations.rates(y, mode, along=False)[core_of(y)])


def _change(
    J: Floats, length: float, start: Floats, core: list[int], forced_by: Floats | None = None
) -> Floats:
    """Solve the collocation equations of one step, shape (k, m, points); after the core the rest.

    The rows of the core depend on each other alone, and all others on them.
    """
    A, m = length * integrator(), start.shape[1]
    k, n = len(core), A.shape[0]
    matrix = np.einsum("ab,ijb->iajb", A, J[np.ix_(core, core)]).reshape(k * n, k * n)
    forced = np.einsum("iajb,jm->iam", matrix.reshape(k, n, k, n), start[core])
    if forced_by is not None:
        forced = forced + np.einsum("ab,imb->iam", A, forced_by[core])
    # scipy's, as in `reference.nonsmooth.radau_iia`: it makes no threads of matrices so small
    *_, change, _ = scipy.linalg.lapack.dgesv(np.eye(k * n) - matrix, forced.reshape(k * n, m))
    along = start[core, None] + change.reshape(k, n, m)
    rates = np.einsum("ijb,jbm->imb", J[:, core], along)
    if forced_by is not None:
        rates = rates + forced_by
    return np.asarray(rates @ A.T)
