"""Disturbances of a motion across the switches of its law: saltation matrices.

Where something comes to rest or turns round (a slip, a turning that friction holds, the contact
point on the rim) the law changes, f jumps from f- to f+, and a disturbed motion gets there at
another sigma: later by the tau at which what comes to rest, G y, rests in it as well. So

    tau = -(l.G d)/(l.G f-),    d+ = P (d + tau f-) - tau f+

(the saltation matrix of Aizerman and Gantmakher). A slip ends straight: across its direction
friction stops it at a rate that goes as one over what is left of it, and P is what that leaves.
Along its direction friction is the same however small the slip, and l is the left null vector of
the derivative of its rates. What begins to move does so without a jump of f, and the disturbance
goes on, but where a static friction above the kinetic lets go.

What friction holds at the release (a turning about the normal, the level part of the turning) is no
velocity that a disturbed motion has for long: moments of finite size stop it within a time of the
size of the disturbance. What is left of a disturbance is

    d+ = d - V (G V)^-1 G d,

V the change of the velocities by unit impulses of those moments, with the contact kept: a
projection in the metric of the mass.

Where a plane that gives way ceases to push, or begins to, or where static friction lets go, f jumps
from f- to f+ where a margin g of the state and of the constants p is zero; an impact, or what stops
a rim that sticks where it lands, is a change M of the state and of p:

    tau = -(g_y d + g_p)/(g_y f-),    d+ = M_y (d + tau f-) + M_p - tau f+.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from reference.analysis.linearisation import NUMBER, Quantity, by_state, core_of, jacobian
from reference.analysis.unilateral_tangents import UnilateralEquations
from reference.compliant.equations import RISE, CompliantEquations
from reference.compliant.integrator import FLIGHT
from reference.equations.contact_laws import Mode
from reference.equations.frames import length
from reference.equations.newton_euler import SLIP_1, SLIP_2, GeneralEquations
from reference.equations.patch_friction import friction_limit
from reference.equations.state_vector import LEAN, SLIP, TURN, U1, U2, W1, W2, W3, Angles
from reference.nonsmooth.level_spin import level_turning
from reference.nonsmooth.patch_onset import hardly_moves
from reference.nonsmooth.segments import Segment
from reference.problem.states import Floats

# A slip that is this small where a piece begins, and goes on, has come to rest and turned.
RESTS = 1e-13
# What begins from rest has no direction at the start of its piece. Its rates there are extrapolated
# from so far into the piece, and twice as far: the error is the square of that, and the direction
# has a rounding over it.
BEHIND = 1e-5
# A slip as slow as this is at its end, and its last steps are left out: they take a time of this
# size, by which disturbances are missed. Nearer to the end round-off turns the slip.
ENDING = 1e-10
# A patch has its turning from a difference, with fewer digits.
ENDING_OF_PATCH = 3e-9
# Ends of pieces, slower than this, from which what is left of a slip is extrapolated to its end.
CUTS, SLOW = 4, 1e-5
ByConstants: TypeAlias = Callable[[Quantity, Floats, Mode], Floats]
"""From a quantity, of states of shape (rows, n) and a mode, to its derivatives by m constants.

Of values of shape (..., n) they have the shape (..., m, n).
"""


def lets_go(equations: GeneralEquations, before: Mode, after: Mode) -> bool:
    """Return whether a rim begins to slip by less friction than what held it."""
    if before.flies or after.flies or before.slips or not after.slips:
        return False
    return equations.mu_static > equations.mu


def slack(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return what is left of static friction, mu_static N - |F|, of states real or complex.

    Of a patch less the mu N on whose limit surface its force and moment lie.
    """
    contact = equations.contact(y, mode)
    force, radius = contact.force, equations.patch
    if radius:
        taken = friction_limit(np.array([force[0], force[1], contact.moment[2] / radius]))
    else:
        taken = length(force[0], force[1])
    return np.asarray(equations.mu_static * force[2] - taken)


def touching(equations: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the margin that is zero where the plane begins and ceases to push, shape (n,)."""
    if isinstance(equations, UnilateralEquations):
        return equations.touching(y, mode)
    assert isinstance(equations, CompliantEquations)  # noqa: S101 - no other can flies
    return equations.touching(y)


def held(equations: GeneralEquations, piece: Segment, start: Floats) -> Floats:
    """Return disturbances without the motions that moments of friction hold from a start on."""
    mode, y = piece.mode, piece.start
    if mode.flies or not equations.moments_that_hold(mode):
        return start
    running = bool(equations.contour and not mode.runs)
    drills = bool(equations.drilling and not mode.turns)
    turning = drills or bool(equations.patch and not mode.slips)
    G = _forms(y, turning=turning, level=mode.rests, running=running)
    impulses = np.zeros((len(start), len(G)))
    velocities = [NUMBER[row] for row in (W1, W2, W3, U1, U2)]
    impulses[velocities] = equations.impulses(y, mode)
    return np.asarray(start - impulses @ np.linalg.solve(G @ impulses, G @ start))


class PieceEnd(NamedTuple):
    """The end of a piece, with the disturbances and their logarithms, as of `Stretch`."""

    piece: Segment
    rates: Floats
    disturbances: Floats
    logarithms: Floats


def across(
    equations: GeneralEquations,
    ends: list[PieceEnd],
    left_out: float,
    piece: Segment,
    logarithms: Floats,
    *,
    by_constants: ByConstants | None,
) -> Floats:
    """Return disturbances at the start of a piece, of the ends of those before it.

    Where a slip comes to rest they are extrapolated to that instant from the last few ends.
    """
    last = ends[-1]
    if last.piece.mode.flies or piece.mode.flies:
        return _touched(equations, last, piece, by_constants)
    if lets_go(equations, last.piece.mode, piece.mode):
        return _crossed(equations, last, piece, by_constants, margin=slack)
    comes = last.piece.mode.slips and not piece.mode.slips
    left, used = [left_out], [last]
    for end, later in zip(ends[-2::-1], ends[:0:-1], strict=True):
        slow = np.hypot(*end.piece.end[[U1, U2]]) <= SLOW
        if not (comes and slow and end.piece.mode == last.piece.mode):
            break
        left.append(left[-1] + later.piece.length * later.piece.cut)
        used.append(end)
    out = np.zeros_like(last.disturbances)
    for place, end in enumerate(used):
        others = [t for number, t in enumerate(left) if number != place]
        weight = np.prod([t / (t - left[place]) for t in others])
        scale = np.exp(end.logarithms - logarithms)
        out += weight * scale * _salted(equations, end, piece)
    return out


def _touched(
    equations: GeneralEquations, end: PieceEnd, piece: Segment, by_constants: ByConstants | None
) -> Floats:
    """Return disturbances after the plane has begun, or ceased, to push."""
    lands, flies = end.piece.mode.flies, piece.mode.flies
    jump = (piece.start - end.piece.end)[[*TURN, *SLIP, RISE]]
    if lands and flies and np.abs(jump).max() <= RESTS:
        return end.disturbances
    if not lands:
        return _crossed(equations, end, piece, by_constants, margin=touching)
    # what rests there, be it at zero already, has been stopped: by an impulse, or by a force that
    # begins at zero within a time that vanishes with the disturbance
    stopped = [] if flies else equations.moments_that_hold(piece.mode)
    stopped = stopped if piece.mode.slips and not flies else [*stopped, SLIP_1, SLIP_2]

    def struck(own: GeneralEquations, y: Floats, _: Mode) -> Floats:
        columns = y.T.astype(complex)
        if isinstance(own, CompliantEquations):
            out = [own.landed(column, FLIGHT, stopped) for column in columns]
        else:
            assert isinstance(own, UnilateralEquations)  # noqa: S101 - no other can flies
            out = [own.struck(column, flies=piece.mode.flies) for column in columns]
        return np.stack(out, axis=1)[core_of(y)]

    now = _crossed(equations, end, piece, by_constants, margin=touching, change=struck)
    return held(equations, piece, now) if isinstance(equations, UnilateralEquations) else now


def _crossed(
    equations: GeneralEquations,
    end: PieceEnd,
    piece: Segment,
    by_constants: ByConstants | None,
    *,
    margin: Quantity,
    change: Quantity | None = None,
) -> Floats:
    """Return disturbances after f has jumped, and the state changed, where a margin is nothing.

    Parameters
    ----------
    equations : GeneralEquations
    end : PieceEnd
    piece : Segment
        After it.
    by_constants : callable or None
    margin : Quantity
        g.
    change : Quantity, optional
        M, from states to their rows of the core.
    """
    tau = delay(equations, end, margin, by_constants)
    now = end.disturbances + np.outer(end.rates, tau)
    if change is not None:
        y, mode = end.piece.end[:, None], end.piece.mode
        now = by_state(change, equations, y, mode) @ now
        now = now + _explicit(change, end, by_constants)
    return np.asarray(now - np.outer(_rates_at_start(equations, piece), tau))


def delay(
    equations: GeneralEquations,
    end: PieceEnd,
    margin: Quantity,
    by_constants: ByConstants | None,
) -> Floats:
    """Return by how much later in sigma a margin is nothing, shape (m,), scaled."""
    gradient = by_state(margin, equations, end.piece.end[:, None], end.piece.mode)
    moved = gradient @ end.disturbances + _explicit(margin, end, by_constants)
    return np.asarray(-moved / (gradient @ end.rates))


def _explicit(quantity: Quantity, end: PieceEnd, by_constants: ByConstants | None) -> Floats:
    """Return derivatives by constants at the end of a piece, scaled as its disturbances."""
    if by_constants is None:
        return np.zeros(1)
    slopes = by_constants(quantity, end.piece.end[:, None], end.piece.mode)[..., 0]
    return np.asarray(slopes / np.exp(end.logarithms))


def _salted(equations: GeneralEquations, end: PieceEnd, piece: Segment) -> Floats:
    """Return disturbances after the end of a piece at which a motion comes to rest."""
    last, rates, now = end.piece, end.rates, end.disturbances
    G = _comes_to_rest(last, piece, patch=bool(equations.patch))
    if not G.size:
        return now
    after = _rates_at_start(equations, piece)
    stopped, along = _stopped(equations, last, G)
    tau = -(along @ G @ now) / (along @ G @ rates)
    now = now + np.outer(rates, tau)
    return np.asarray(now - stopped @ (G @ now) - np.outer(after, tau))


def _stopped(equations: GeneralEquations, last: Segment, G: Floats) -> tuple[Floats, Floats]:
    """Return the change by which friction stops G d across its direction, and l of what is along.

    Friction answers G d by J E G d, E any velocities with G E = 1, until G J E has stopped it.
    """
    velocities = G.copy()
    velocities[:, NUMBER[LEAN]] = 0.0
    _, J = jacobian(equations, last.end[:, None], last.mode)
    answer = J[:, :, 0] @ np.linalg.pinv(velocities)
    left, size, right = np.linalg.svd(G @ answer)
    inverse = right[:-1].T / size[:-1] @ left[:, :-1].T
    return np.asarray(answer @ inverse), np.asarray(left[:, -1])


def _rates_at_start(equations: GeneralEquations, piece: Segment) -> Floats:
    """Return rates of the core at the start of a piece, shape (k,), in its mode."""
    mode, y = piece.mode, piece.start[:, None]
    core = core_of(y)
    if mode.flies:
        return np.asarray(equations.rates(y, mode, along=False)[core, 0])
    still = hardly_moves(equations, y)[0] if equations.patch else np.hypot(*y[SLIP, 0]) <= RESTS
    begins = mode.slips and bool(still)
    if equations.resistance and not mode.rests:
        begins = begins or bool(np.hypot(*level_turning(y)[:, 0]) <= RESTS)
    if not begins:
        return np.asarray(equations.rates(y, mode, along=False)[core, 0])
    near = piece.at(np.array([BEHIND, 2 * BEHIND]))
    one, two = equations.rates(near, mode, along=False)[core].T
    return np.asarray(2 * one - two)


def endings(pieces: tuple[Segment, ...], patch: float) -> list[bool]:
    """Return which pieces are the last of a slip that comes to rest, or of the motion."""
    out, comes = [False] * len(pieces), False
    least = ENDING_OF_PATCH if patch else ENDING
    for number in range(len(pieces) - 2, 0, -1):
        here, after = pieces[number], pieces[number + 1]
        comes = here.mode.slips and not here.mode.flies and (comes or not after.mode.slips)
        comes = comes and bool(np.hypot(*here.start[[U1, U2]]) <= least)
        out[number] = comes
    return out


def _comes_to_rest(last: Segment, piece: Segment, *, patch: bool) -> Floats:
    """Return the forms of the state that vanish from here on, or turn round, shape (g, k).

    The slip of a patch that turns passes zero as anything else does.
    """
    before, after = last.mode, piece.mode
    still = not patch and np.hypot(*piece.start[[U1, U2]]) <= RESTS
    slip = bool(before.slips and (not after.slips or still))
    return _forms(
        last.end,
        slip=slip,
        turning=(slip and patch) or bool(before.turns and after.turns != before.turns),
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
    """Return derivatives of velocities of a state, shape (rows,), by its core, shape (g, k)."""
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
    out = np.zeros((len(forms), core_of(y).size))
    for row, form in enumerate(forms):
        for index, weight in form.items():
            out[row, NUMBER[index]] = weight
    return out
