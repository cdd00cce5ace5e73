"""The slip of a rim followed through an impact with friction (Darboux 1880, Keller 1986).

    du/dp = D (-mu u_t/|u_t|, 1)

until it stops, sticks where the force of sticking lies inside the cone, and slides anew where it
does not. A slip whose direction stays makes this linear in p; where the direction turns it is
integrated to round-off in a time in which it is smooth, dp = |u_t| ds.

Infinite friction is the limit of this: a slip has the impulse (-u_t/|u_t|, 0) of the size q = mu p,
with p = 0. Mostly it stops before p is anything; an impact whose slip lifts the rim out of the
plane before that is over while it still slides, and its restitution is measured by q.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, cos, hypot, inf, isinf, sin, sqrt

import numpy as np
import scipy

from reference.nonsmooth.slip_onset import SAMPLES, roots_on_circle
from reference.problem.states import Floats

POISSON, ENERGETIC = "poisson", "energetic"
# Of the velocities: a slip below this share is round-off.
STOPPED = 1e-14
# Of an acceleration: its round-off.
HELD = 1e-12
TOLERANCE = 1e-13
# Of the velocities: the normal velocity at which a rim that jams is driven into the plane.
DRIVEN = 1e-10
ASTRAY = 100.0
NORMAL = 2


def push(mu: float, ahead: float, aside: float) -> Floats:
    """Return the impulse on a rim that slides in a direction; of a unit of normal impulse.

    Of infinite friction that of a unit of friction.
    """
    if isinf(mu):
        return np.array([-ahead, -aside, 0.0])
    return np.array([-mu * ahead, -mu * aside, 1.0])


def aligned(D: Floats, u: Floats, mu: float, closing: float) -> tuple[Floats, Floats]:
    """Return the slips that the friction against them leaves a velocity along themselves.

    Of the velocity u + closing D w/G, w the impulse of such a slip and G = (D w)_z. Times G, which
    has no pole, what of it is across the slip is a trigonometric polynomial of degree two in the
    angle of the slip: all of its roots are found.

    Returns
    -------
    angles, along : ndarray, shape (n,)
        Of the slips with G > 0, and G times the velocity along each.
    """

    def velocity(angles: Floats) -> tuple[Floats, Floats, Floats]:
        cos, sin = np.cos(angles), np.sin(angles)
        answer = D @ np.array([push(mu, c, s) for c, s in zip(cos, sin, strict=True)]).T
        v = u[:, None] * answer[NORMAL] + closing * answer
        return v[0] * cos + v[1] * sin, v[1] * cos - v[0] * sin, answer[NORMAL]

    angles = roots_on_circle(velocity(2 * np.pi * np.arange(SAMPLES) / SAMPLES)[1])
    if not angles.size:
        return angles, angles
    along, _, mobility = velocity(angles)
    good = (along > 0.0) & (mobility > 0.0)
    return angles[good], along[good]


@dataclass(slots=True)
class _Progress:
    """An impact on its way.

    Attributes
    ----------
    impulse, velocity : ndarray, shape (3,)
    pressed : float
        The normal impulse; of a slip under infinite friction its friction instead.
    work : float
        Of that impulse along the normal velocity.
    """

    impulse: Floats
    velocity: Floats
    pressed: float = 0.0
    work: float = 0.0


def followed(
    D: Floats, u: Floats, mu: float, e: float, law: str, *, jams: bool = False
) -> tuple[Floats, Floats]:
    """Return impulse and velocity after it of Poisson's or the energetic law: follow the slip."""
    now = _Progress(impulse=np.zeros(3), velocity=u.astype(float).copy())
    # of a rim that jams, whose normal velocity is zero, the impulse compresses before it lets go
    _phase(D, mu, now, compress=True, most=inf, work=inf, jams=jams)
    at_most, stored = now.pressed, -now.work
    if e > 0.0:
        most = (1 + e) * at_most if law == POISSON else inf
        work = e * e * stored if law == ENERGETIC else inf
        now.work = 0.0
        if work > 0.0:
            _phase(D, mu, now, compress=False, most=most, work=work)
    return now.impulse, now.velocity


def _phase(
    D: Floats,
    mu: float,
    now: _Progress,
    *,
    compress: bool,
    most: float,
    work: float,
    jams: bool = False,
) -> None:
    """Follow an impact to the end of its compression, or of its restitution.

    Compression ends where the normal velocity is zero and would rise; restitution where the normal
    impulse, or its work, is what is asked for.
    """
    size = max(float(np.abs(now.velocity).max()), np.finfo(float).tiny)
    slid = isinf(mu) and not compress and hypot(*now.velocity[:2]) > STOPPED * size
    for _ in range(16):
        slip, way = _direction(D, mu, now, size)
        if slip == 0.0 and slid:
            # of a restitution whose measure is the friction nothing is left
            return
        answer = _answer(D, mu, way, slip)
        if not _is_straight(mu, now, slip, answer):
            if _turn(D, mu, now, compress=compress, most=most, work=work, jams=jams):
                return
            jams = jams and now.velocity[NORMAL] >= 0.0
            continue
        # how much more until the slip stops, and until the phase is over
        stops = _until_stopped(mu, now, slip, answer)
        ends = _until(now, float(answer[NORMAL]), compress=compress, most=most, work=work)
        if jams and slip > 0.0:
            ends = inf
        if isinf(ends) and isinf(stops):
            return
        p = min(ends, stops)
        before = float(now.velocity[NORMAL])
        now.impulse = now.impulse + way * p
        now.pressed += p
        now.velocity = now.velocity + answer * p
        now.work += p * (before + float(now.velocity[NORMAL])) / 2
        if ends <= stops and compress:
            now.velocity[NORMAL] = 0.0
        if stops <= ends:
            _stop(mu, now, compress=compress)
        if ends <= stops:
            return


def _answer(D: Floats, mu: float, way: Floats, slip: float) -> Floats:
    """Return how the velocity changes with the impulse."""
    answer: Floats = np.asarray(D @ way)
    if slip == 0.0 and (isinf(mu) or hypot(*answer[:2]) <= HELD * np.abs(answer).max()):
        # what is held does not move by the round-off of what holds it
        answer[:2] = 0.0
    return answer


def _is_straight(mu: float, now: _Progress, slip: float, answer: Floats) -> bool:
    """Return whether a slip changes evenly with the impulse: without turning."""
    aside = abs(answer[0] * now.velocity[1] - answer[1] * now.velocity[0])
    return slip == 0.0 or mu == 0.0 or aside <= STOPPED * slip * float(np.abs(answer).max())


def _until_stopped(mu: float, now: _Progress, slip: float, answer: Floats) -> float:
    """Return how much impulse is left until the slip stops."""
    closing = -(now.velocity[0] * answer[0] + now.velocity[1] * answer[1])
    # without friction nothing stops it: it turns as it likes
    return slip * slip / closing if closing > 0 and mu > 0.0 else inf


def _stop(mu: float, now: _Progress, *, compress: bool) -> None:
    """Stop the slip: from now on the normal impulse is the measure of compression."""
    now.velocity[:2] = 0.0
    if isinf(mu) and compress:
        now.pressed = now.work = 0.0


def _direction(D: Floats, mu: float, now: _Progress, size: float) -> tuple[float, Floats]:
    """Return the slip, zero where it has stopped, and the impulse per unit of normal impulse."""
    slip = hypot(now.velocity[0], now.velocity[1])
    if slip > STOPPED * size:
        ahead, aside = (now.velocity[:2] / slip).tolist()
        return slip, push(mu, ahead, aside)
    now.velocity[:2] = 0.0
    return 0.0, _from_rest(D, mu)


def _until(now: _Progress, slope: float, *, compress: bool, most: float, work: float) -> float:
    """Return how much normal impulse is left of a phase while the velocity changes evenly."""
    fast = float(now.velocity[NORMAL])
    if compress:
        if fast >= 0.0 and slope > 0:
            return 0.0
        return -fast / slope if slope > 0 else inf
    if not isinf(most):
        return max(most - now.pressed, 0.0)
    # p (fast + slope p/2) = work - done
    left = max(work - now.work, 0.0)
    if slope == 0:
        return left / fast if fast > 0 else inf
    root = fast * fast + 2 * slope * left
    return 2 * left / (fast + sqrt(root)) if root >= 0 and fast + sqrt(root) > 0 else inf


def _from_rest(D: Floats, mu: float) -> Floats:
    """Return the impulse, per unit of normal impulse, on a rim that does not slide."""
    hold = np.append(-np.linalg.solve(D[:2, :2], D[:2, NORMAL]), 1.0)
    if hypot(*hold[:2]) <= mu:
        return hold

    # the slip that begins keeps its direction, along what friction leaves of its acceleration
    angles, along = aligned(D, np.zeros(3), mu, 1.0)
    if not angles.size:
        return hold
    angle = float(angles[np.argmax(along)])
    return push(mu, cos(angle), sin(angle))


def _rates(D: Floats, mu: float) -> Callable[[float, Floats], list[float]]:
    """Return the rates of a slip that turns, in the logarithm of the slip and its direction."""
    rubs = 1.0 if isinf(mu) else mu

    def rates(_: float, y: Floats) -> list[float]:
        # a trial step may go far astray before it is refused
        slip, c, s = np.exp(min(float(y[0]), ASTRAY)), cos(y[1]), sin(y[1])
        a = D @ push(mu, c, s)
        return [
            a[0] * c + a[1] * s,
            a[1] * c - a[0] * s,
            slip,
            slip * a[2],
            slip * y[3],
            -slip * rubs * c,
            -slip * rubs * s,
        ]

    return rates


def _turn(
    D: Floats,
    mu: float,
    now: _Progress,
    *,
    compress: bool,
    most: float,
    work: float,
    jams: bool,
) -> bool:
    """Follow a slip that turns; return whether the phase is over, and else the slip has stopped.

    A rim that jams is followed until its normal velocity has a sign: where it is driven into the
    plane the phase goes on, and where it rises after it has been below zero, by less than that, the
    plane has let go. In the logarithm of the slip and its direction, with dp = |u_t| ds, the
    equations are smooth.
    """
    start = hypot(now.velocity[0], now.velocity[1])
    size = max(float(np.abs(now.velocity).max()), start)
    limit = STOPPED * size / 2

    def over(_: float, y: Floats) -> float:
        if compress:
            return float(y[3])
        if not isinf(most):
            return float(y[2] - most)
        return float(y[4] - work)

    def stops(_: float, y: Floats) -> float:
        return float(y[0] - np.log(limit))

    def decided(_: float, y: Floats) -> float:
        # into the plane, or out of it after it has been below zero
        return float(abs(y[3]) if sinks else -y[3]) - DRIVEN * size

    way = push(mu, float(now.velocity[0]) / start, float(now.velocity[1]) / start)
    sinks = jams and float(D[NORMAL] @ way) < 0.0
    over.terminal, over.direction = True, 1.0  # type: ignore[attr-defined] # scipy's interface
    decided.terminal = True  # type: ignore[attr-defined]
    stops.terminal = True  # type: ignore[attr-defined]
    begun = [
        np.log(start),
        atan2(now.velocity[1], now.velocity[0]),
        now.pressed,
        float(now.velocity[NORMAL]),
        now.work,
        float(now.impulse[0]),
        float(now.impulse[1]),
    ]
    found = scipy.integrate.solve_ivp(
        _rates(D, mu),
        (0.0, 1e6 / float(np.abs(D).max())),
        begun,
        method="DOP853",
        rtol=TOLERANCE,
        atol=TOLERANCE * np.array([1.0, 1.0, size, size, size * size, size, size]) / 10,
        events=(decided if jams else over, stops),
    )
    y = found.y[:, -1]
    slip = float(np.exp(y[0]))
    now.pressed = float(y[2])
    now.impulse = np.array([y[5], y[6], now.impulse[NORMAL] if isinf(mu) else y[2]])
    now.velocity = np.array([slip * cos(y[1]), slip * sin(y[1]), y[3]])
    now.work = float(y[4])
    if jams and found.t_events[0].size:
        return float(y[3]) > 0.0
    if found.t_events[0].size:
        if compress:
            now.velocity[NORMAL] = 0.0
        return True
    _stop(mu, now, compress=compress)
    return False
