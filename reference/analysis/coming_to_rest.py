"""The end of a disk that spins down: the time at which it lies flat, and how phi goes there.

In steady rolling about a centre at rest the energy of a thin disk above that of lying flat is 3/2
phi, and theta' is about -2 phi^(-1/2), dimensionless. A law that takes the power K phi^q then lets
phi fall as (t_s - t)^p with p = 1/(1 - q):

    film of air (Moffatt)               q = -2       p = 1/3
    boundary layers of air (Bildsten)   q = -5/4     p = 4/9
    viscous contour friction            q = -1       p = 1/2
    dry contour friction                q = -1/2     p = 2/3
    rolling resistance                  q = 1/2      p = 2
    angular damping                     q = 1        no end in finite time

(derived in tests/reference/test_coming_to_rest.py). The largest power as phi goes to zero is that
of the smallest q. The law holds while phi changes little in a turn of the contact point, phi' much
less than phi theta'. With p < 2 it does not hold to the end: at a phi of the order of the strength
of the law the disk is left behind by its own fall, tips about the contact point like a domino, and
meets the plane at a finite speed (Moffatt 2000 and Bildsten 2002 say the same of the fall of g).
So t_f, the time at which it lies flat, is not t_s, and the exponent is that of the window before.
Rolling resistance alone, with p = 2, leaves the ratio as it is: phi and its rate end together.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from reference.equations.contact_laws import Kind
from reference.problem.effects import Effects
from reference.problem.outcome import Outcome
from reference.problem.states import Floats
from reference.solution import Solution
from reference.unilateral.free_body import moves_in_a_plane

# Outcomes of a can that lies flat.
FLAT = frozenset({Outcome.FELL_FLAT, Outcome.CAME_TO_REST})
# |phi'| over phi theta' below which phi changes little in a turn of the contact point.
SLOW = 0.03
# Decades of phi that an exponent is fitted to, at least; below, a wobble hides it.
LEAST_DECADES = 0.3
SAMPLES = 400
# Of ln phi: what leaves the fitted power by more is no steady fall, as of a can that rocks.
STEADY = 0.1
# Rounds in which the window and the fit find each other.
ROUNDS = 4
# Terms of a geometric sequence that tell its limit; that of the terms before is the same but for
# this share of what is left; and the motion ends within so many of its last distances.
TERMS, AGREED, GOES_ON = 3, 0.1, 2.0
# Nutations that are enough for a limit of limits, and parts of them that its terms lie apart.
MANY, PARTS = 50, 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """The end of a motion that comes to lie flat.

    Attributes
    ----------
    time : float
        t_f, in sqrt(R/g).
    exponent : float or None
        p, fitted to phi = A (t_s - t)^p in the window; None where the window is too short, or phi
        rises and falls in it.
    predicted : float or None
        p of the law that takes the largest power as phi goes to zero; None without a fit.
    law : str
        Its name; empty without a fit.
    window : tuple of float
        phi at the end and at the beginning of the fit, rad.
    """

    time: float
    exponent: float | None
    predicted: float | None
    law: str
    window: tuple[float, float]


def powers(effects: Effects) -> dict[str, float]:
    """Return q of each law of dissipation that is declared: its power goes as phi^q."""
    laws = {
        "film of air": (effects.film, -2.0),
        "boundary layers of air": (effects.boundary_layer, -1.25),
        "viscous contour friction": (effects.contour_damping, -1.0),
        "dry contour friction": (effects.contour, -0.5),
        "rolling resistance": (effects.rolling_resistance, 0.5),
    }
    return {name: q for name, (strength, q) in laws.items() if strength > 0}


def is_regular(solution: Solution) -> bool:
    """Return whether a motion came to lie flat as its laws of dissipation have it.

    Friction against drilling, be it of a patch, is one of them, without an exponent: its law is
    that of phi far below h alone.

    A fall in a plane, whose contact point does not run along the rim, is none of theirs.
    """
    problem, effects = solution.problem, solution.problem.effects
    rests = _drills(effects) and solution.outcome is Outcome.CAME_TO_REST
    takes = bool(powers(effects)) or rests
    return solution.outcome in FLAT and takes and not moves_in_a_plane(problem)


def _drills(effects: Effects) -> bool:
    return effects.drilling > 0 or effects.patch > 0


def coming_to_rest(solution: Solution) -> Rest | None:
    """Return how a motion came to lie flat; None of one that did not."""
    if solution.outcome not in FLAT:
        return None
    laws = powers(solution.problem.effects)
    law = min(laws, key=lambda name: laws[name], default="")
    predicted = 1 / (1 - laws[law]) if law else None
    exponent, window = None, (0.0, 0.0)
    if predicted is not None and is_regular(solution):
        exponent, window = _fitted(solution, predicted)
    if exponent is None:
        law, predicted = "", None
    return Rest(
        time=_time(solution), exponent=exponent, predicted=predicted, law=law, window=window
    )


def _time(solution: Solution) -> float:
    """Return t_f: the limit of a sequence where the motion ended before the last of it.

    Of the phases of slip; or of nutations, where friction against drilling stops a disk that goes
    on to slip, or to stick. The end of what was followed, where neither tends to a limit.
    """
    if solution.outcome is Outcome.FELL_FLAT:
        return solution.t_end
    slips = [phase.start for phase in solution.phases if phase.kind is Kind.SLIP]
    limit = _limit(slips, solution.t_end)
    if limit is None and _drills(solution.problem.effects):
        maxima = solution.maxima.tolist()
        limit = _limit(maxima, solution.t_end)
        if limit is not None and len(maxima) >= MANY:
            # their ratio tends to its own limit as a power of phi: the limit of three such limits
            apart = maxima[:: -(len(maxima) // PARTS)][::-1]
            limit = _aitken(
                *(_aitken(*apart[n - 3 : n]) for n in range(len(apart) - 2, len(apart) + 1))
            )
    return solution.t_end if limit is None else max(limit, solution.t_end)


def _limit(times: list[float], end: float) -> float | None:
    """Return Aitken's limit of a sequence of times that goes on up to an end.

    None if it ends before that, or if its limit is not that of the terms before the last: its
    distances do not shrink by one ratio.
    """
    if len(times) <= TERMS:
        return None
    before, limit = _aitken(*times[-TERMS - 1 : -1]), _aitken(*times[-TERMS:])
    goes_on = end - times[-1] <= GOES_ON * (times[-1] - times[-2])
    agrees = abs(limit - before) <= AGREED * (limit - times[-1])
    return limit if goes_on and agrees else None


def _aitken(first: float, second: float, third: float) -> float:
    """Return the limit of a geometric sequence of three terms; the last if it has none."""
    before, last = second - first, third - second
    ratio = last / before if before else 1.0
    return third + last * ratio / (1 - ratio) if 0 < abs(ratio) < 1 else third


def _fitted(solution: Solution, guess: float) -> tuple[float | None, tuple[float, float]]:
    """Return the exponent and the window of phi that it is fitted to."""
    grid = solution.grid()
    phi = solution.at(grid).phi
    high, low, exponent = float(phi[0]), float(phi[0]) / 10, guess
    off = np.zeros(0)
    for _ in range(ROUNDS):
        last = grid[np.flatnonzero(phi > low)[-1]]
        times = np.linspace(0.0, last, SAMPLES)
        log_phi = np.log(solution.at(times).phi)
        exponent, end, scale = _power(times, log_phi, exponent)
        off = log_phi - np.log(scale) - exponent * np.log(end - times)
        # phi'/(phi theta') = p/((t_s - t) theta') with theta' = 2 phi^(-1/2)
        ages = (end - times) * 2 / np.sqrt(scale * (end - times) ** exponent)
        slow = np.flatnonzero(exponent < SLOW * ages)
        if not slow.size:
            return None, (low, high)
        left = end - times[slow[-1]]
        low = max(float(scale * left**exponent), high * 1e-6)
    if np.log10(high / low) < LEAST_DECADES or np.abs(off).max() > STEADY:
        return None, (low, high)
    return exponent, (low, high)


def _power(times: Floats, log_phi: Floats, guess: float) -> tuple[float, float, float]:
    """Return p, t_s and A of ln phi = ln A + p ln(t_s - t), by least squares."""
    span = times[-1] - times[0]
    ratio = float(np.exp((log_phi[-1] - log_phi[0]) / guess))
    left = span * min(max(ratio, 1e-9), 0.9) / (1 - min(max(ratio, 1e-9), 0.9))

    def line(log_left: float) -> tuple[float, float, float]:
        distance = np.log(times[-1] + np.exp(log_left) - times)
        slope, height = np.polyfit(distance, log_phi, 1)
        return float(np.sum((slope * distance + height - log_phi) ** 2)), slope, height

    bounds = np.log(left) - 6.0, np.log(left) + 4.0
    best = scipy.optimize.minimize_scalar(
        lambda x: line(x)[0], bounds=bounds, method="bounded", options={"xatol": 1e-9}
    ).x
    _, slope, height = line(best)
    return float(slope), float(times[-1] + np.exp(best)), float(np.exp(height))
