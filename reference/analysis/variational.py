"""Growth of small disturbances of a motion, by its variational equations along its pieces.

With y' = f(y) in the time sigma of `reference.equations.state_vector`, a disturbance d of the
state obeys

    d' = J(y) d,    J = df/dy,

which is linear: no disturbance is too small or too large. After each piece d is scaled to size 1
and the logarithm of its size is stored (renormalisation; Benettin, Galgani, Giorgilli and
Strelcyn, Meccanica 15, 1980). J is taken along imaginary steps, J v = Im f(y + i s v)/s, exact to
round-off (Squire and Trapp, SIAM Review 40, 1998), and each piece is one step of the Radau
collocation that made it (`reference.nonsmooth.radau_iia`), with a matrix for Newton's.

The time is a state, t' = S. The difference d of two motions at the same sigma becomes their
difference at the same time, d - f d_t/S.

Where something comes to rest or turns round (a slip, a turning that friction holds, the contact
point on the rim) the law changes, f jumps from f- to f+, and a disturbed motion gets there at
another sigma: later by the tau at which what comes to rest, G y, rests in it as well. So

    tau = -(G f-).(G d)/|G f-|^2,    d+ = P (d + tau f-) - tau f+

(the saltation matrix of Aizerman and Gantmakher), with P without what G sees: across its direction
friction has made a slip that ends straight already. What begins to move does so without a jump of
f, and the disturbance goes on.

What friction holds at the release (a turning about the normal, the level part of the turning) is no
velocity that a disturbed motion has for long: moments of finite size stop it within a time of the
size of the disturbance. What is left of a disturbance is

    d+ = d - V (G V)^-1 G d,

V the change of the velocities by unit impulses of those moments, with the contact kept: a
projection in the metric of the mass.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import scipy

from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import (
    LEAN,
    PSI,
    ROWS,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
    Angles,
    sizes,
)
from reference.nonsmooth.level_spin import level_turning
from reference.nonsmooth.radau_iia import basis, coefficients, integrator, points
from reference.nonsmooth.segments import Segment
from reference.problem.effects import Effects
from reference.problem.problem import Problem
from reference.problem.states import Floats

# What the rates depend on, and what they move: all but the place and the works.
CORE = np.array([LEAN, W1, W2, W3, PSI, TOTAL, TIME, U1, U2])
NUMBER = {row: place for place, row in enumerate(CORE.tolist())}
# Imaginary steps, over the size of what is stepped: nothing is subtracted, so as small as may be.
STEP = 1e-40
# A slip that is this small where a piece begins, and goes on, has come to rest and turned.
RESTS = 1e-13
# What begins from rest has no direction at the start of its piece. Its rates there are extrapolated
# from so far into the piece, and twice as far: the error is the square of that, and the direction
# has a rounding over it.
BEHIND = 1e-5
# A slip as slow as this is at its end, and its last steps are left out: they take a time of this
# size, by which disturbances are missed. Nearer to the end round-off turns the slip.
ENDING = 1e-10
CREEPS = "dry friction along the rim lets the contact point creep"
LETS_GO = "the rim slips from a static friction above the kinetic: its force jumps"
Forcing: TypeAlias = Callable[[Floats, Mode], Floats]
DISTURBED = ("phi", "theta", "psi_dot", "theta_dot")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Disturbances along one piece, at its collocation points.

    Attributes
    ----------
    states : ndarray, shape (13, n)
        Of the motion; the last at the end of the piece.
    rates : ndarray, shape (9, n)
        Of the rows `CORE`, in sigma.
    disturbances : ndarray, shape (9, m, n)
        Of the rows `CORE`, at the same sigma, scaled.
    logarithms : ndarray, shape (m,)
        Of the scales: exp of them times the above is what was disturbed.
    piece : Segment
    start : ndarray, shape (9, m)
        Disturbances at the start of the piece, scaled.
    """

    states: Floats
    rates: Floats
    disturbances: Floats
    logarithms: Floats
    piece: Segment
    start: Floats

    def at(self, c: float) -> Floats:
        """Return the disturbances at a place in [0, cut] of the piece, shape (9, m), not scaled."""
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


def without_tangent(effects: Effects, pieces: tuple[Segment, ...]) -> str:
    """Return why disturbances of a motion obey no equations that are here; empty if they do."""
    lets_go = effects.mu_static is not None and effects.mu_static > (effects.mu or 0.0)
    if lets_go and any(piece.mode.slips for piece in pieces):
        return LETS_GO
    return CREEPS if any(piece.mode.creeps for piece in pieces) else ""


def jacobian(equations: GeneralEquations, y: Floats, mode: Mode) -> tuple[Floats, Floats]:
    """Return rates of the rows `CORE`, shape (9, n), and their derivatives, shape (9, 9, n).

    Parameters
    ----------
    equations : GeneralEquations
    y : ndarray, shape (13, n)
    mode : Mode
    """
    k, n = CORE.size, y.shape[1]
    step = STEP * sizes(CORE, y[CORE])
    columns = np.repeat(y[:, None, :], k, axis=1).astype(complex)
    columns[CORE, np.arange(k)] += 1j * step
    values = equations.rates(columns.reshape(ROWS, k * n), mode, along=False)
    values = values.reshape(ROWS, k, n)[CORE]
    return values[:, 0].real, values.imag / step


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
    forcing: Forcing | None = None,
) -> Iterator[Stretch]:
    """Yield the disturbances along each piece of a motion.

    Parameters
    ----------
    equations : GeneralEquations
        Of the motion that the pieces are.
    pieces : tuple of Piece
    start : ndarray, shape (9, m)
        Disturbances of the rows `CORE` at the release.
    forcing : callable, optional
        What is added to J d, from states of shape (13, n) and their mode, shape (9, m, n): of
        disturbances of the constants of the equations.
    """
    now, logarithms = _held(equations, pieces[0], start), np.zeros(start.shape[1])
    before: tuple[Segment, Floats] | None = None
    for piece, ending in zip(pieces, _endings(pieces), strict=True):
        if ending:
            continue
        if before is not None:
            now = _across(equations, *before, piece, now)
        scale = np.linalg.norm(now, axis=0)
        scale[scale == 0] = 1.0
        now, logarithms = now / scale, logarithms + np.log(scale)
        y = piece.at(piece.cut * points())
        rates, J = jacobian(equations, y, piece.mode)
        core = [NUMBER[row] for row in equations.core(piece.mode).tolist()]
        forced = None if forcing is None else forcing(y, piece.mode) / np.exp(logarithms)[:, None]
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
        now, before = disturbances[:, :, -1], (piece, rates[:, -1])


def _held(equations: GeneralEquations, piece: Segment, start: Floats) -> Floats:
    """Return disturbances without the motions that moments of friction hold from the release on."""
    mode, y = piece.mode, piece.start
    if not equations.moments_that_hold(mode):
        return start
    held = bool(equations.contour and not mode.runs)
    turning = bool(equations.drilling and not mode.turns)
    G = _forms(y, turning=turning, level=mode.rests, running=held)
    impulses = np.zeros((CORE.size, len(G)))
    velocities = [NUMBER[row] for row in (W1, W2, W3, U1, U2)]
    impulses[velocities] = equations.impulses(y, mode)
    return np.asarray(start - impulses @ np.linalg.solve(G @ impulses, G @ start))


def _change(
    J: Floats, length: float, start: Floats, core: list[int], forced_by: Floats | None = None
) -> Floats:
    """Solve the collocation equations of one step, shape (9, m, points); after the core the rest.

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


def _across(
    equations: GeneralEquations, last: Segment, rates: Floats, piece: Segment, now: Floats
) -> Floats:
    """Return disturbances after the end of a piece at which a motion comes to rest."""
    G = _comes_to_rest(last, piece)
    if not G.size:
        return now
    after = _rates_at_start(equations, piece)
    coming = G @ rates
    tau = -(coming @ G @ now) / (coming @ coming)
    now = now + np.outer(rates, tau)
    # velocities come to rest, and the lean stays
    velocities = G.copy()
    velocities[:, NUMBER[LEAN]] = 0.0
    now = now - np.linalg.pinv(velocities) @ (G @ now)
    return np.asarray(now - np.outer(after, tau))


def _rates_at_start(equations: GeneralEquations, piece: Segment) -> Floats:
    """Return rates of the rows `CORE` at the start of a piece, shape (9,), in its mode."""
    mode, y = piece.mode, piece.start[:, None]
    begins = mode.slips and np.hypot(*y[[U1, U2], 0]) <= RESTS
    if equations.resistance and not mode.rests:
        begins = begins or bool(np.hypot(*level_turning(y)[:, 0]) <= RESTS)
    if not begins:
        return np.asarray(equations.rates(y, mode, along=False)[CORE, 0])
    near = piece.at(np.array([BEHIND, 2 * BEHIND]))
    one, two = equations.rates(near, mode, along=False)[CORE].T
    return np.asarray(2 * one - two)


def _endings(pieces: tuple[Segment, ...]) -> list[bool]:
    """Return which pieces are the last of a slip that comes to rest, or of the motion."""
    out, comes = [False] * len(pieces), False
    for number in range(len(pieces) - 2, 0, -1):
        here, after = pieces[number], pieces[number + 1]
        comes = here.mode.slips and (comes or not after.mode.slips)
        comes = comes and bool(np.hypot(*here.start[[U1, U2]]) <= ENDING)
        out[number] = comes
    return out


def _comes_to_rest(last: Segment, piece: Segment) -> Floats:
    """Return the forms of the state that vanish from here on, or turn round, shape (g, 9)."""
    before, after = last.mode, piece.mode
    still = np.hypot(*piece.start[[U1, U2]]) <= RESTS
    return _forms(
        last.end,
        slip=bool(before.slips and (not after.slips or still)),
        turning=bool(before.turns and after.turns != before.turns),
        level=after.rests and not before.rests,
        running=bool(before.runs and after.runs != before.runs),
    )


def _forms(
    y: Floats,
    *,
    slip: bool = False,
    turning: bool = False,
    level: bool = False,
    running: bool = False,
) -> Floats:
    """Return derivatives of velocities of a state, shape (13,), in the rows `CORE`."""
    at, w = Angles.of(y[LEAN]), y[[W1, W3]]
    forms: list[dict[int, float]] = [{U1: 1.0}, {U2: 1.0}] if slip else []
    # rates of S and C with ln tan(phi/2) are S C and -S S
    if turning:
        by_lean = at.S * at.C * w[0] - at.S * at.S * w[1]
        forms.append({LEAN: float(by_lean), W1: float(at.S), W3: float(at.C)})
    if level:
        by_lean = -at.S * at.S * w[0] - at.S * at.C * w[1]
        forms += [
            {LEAN: float(by_lean), W1: float(at.C), W3: -float(at.S)},
            {W2: 1.0},
        ]
    if running:
        by_lean = at.S * at.C * w[1] + at.S * at.S * w[0]
        forms.append({LEAN: float(by_lean), W1: -float(at.C), W3: float(at.S)})
    out = np.zeros((len(forms), CORE.size))
    for row, form in enumerate(forms):
        for index, weight in form.items():
            out[row, NUMBER[index]] = weight
    return out
