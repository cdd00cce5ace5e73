"""Sixty digits of one motion: its turning points, its period, and what an ulp of the input does.

Precession and spin by the series of `reference.integrable.frobenius` in sixty digits, with no
difference from
a reference anywhere: cancellation is met with digits. Roots by a scan of the effective potential
and all its extrema; the period by Gauss's rule, graded towards all of them.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import mpmath as mp
import numpy as np

from tests.reference.hostile.made import Made

DIGITS = 60
# At pi/2 the terms fall like 2^-n, deeper down faster.
TERMS = 190
SCAN = 160
# A part spans a decade of the distance from a neighbouring root: 24 nodes leave 1e-13.
RULE = tuple(part.tolist() for part in np.polynomial.legendre.leggauss(24))
EPS = mp.mpf(2) ** -53
# Down to this share of the release a turning point is looked for.
DEEPEST = mp.mpf(10) ** -30
INPUTS = ("phi", "phi_dot", "psi_dot", "theta_dot")
CAN = ("a", "c", "h")
MEASURES = ("period", "phi_min", "turn", "rotation")
# An ulp: the quadrature of the period leaves 1e-13, and smaller changes would be lost in it.
STEP = 2 * EPS


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """A motion in sixty digits.

    Attributes
    ----------
    period, phi_min, phi_max : mpf or None
        None where a turning point is missing.
    turn, rotation : mpf or None
        By which psi and theta change in a period.
    gap : mpf
        Of the minima of |g| between and beside the turning points, in the energy: the least.
    gap_at : mpf or None
        Where that is; None where there is no minimum.
    """

    period: mp.mpf | None
    phi_min: mp.mpf | None
    phi_max: mp.mpf | None
    turn: mp.mpf | None
    rotation: mp.mpf | None
    gap: mp.mpf
    gap_at: mp.mpf | None


def numbers_of(made: Made) -> dict[str, mp.mpf]:
    """Return can and release, exactly."""
    p = made.parameters
    values = {"a": p.a, "c": p.c, "h": p.h, **{name: getattr(made, name) for name in INPUTS}}
    return {name: mp.mpf(value) for name, value in values.items()}


@lru_cache(maxsize=1)
def _universal() -> tuple[list[mp.mpf], ...]:
    """Series of S, T, T', T T', phi T'/T and 2 phi T'^2/T."""
    with mp.workdps(DIGITS):
        sine = [
            mp.mpf(0) if n % 2 == 0 else (-1) ** (n // 2) / mp.factorial(n) for n in range(TERMS)
        ]
        tangent, slope = [mp.mpf(0)], []
        for n in range(1, TERMS + 1):
            square = mp.fdot(tangent[:n], tangent[n - 1 :: -1])
            slope.append((int(n == 1) + square) / 2)
            tangent.append(slope[n - 1] / n)
        product = [mp.fdot(tangent[: n + 1], slope[n::-1]) for n in range(TERMS)]
        square = [mp.fdot(slope[: n + 1], slope[n::-1]) for n in range(TERMS)]
        over = tangent[1:]
        cosecant: list[mp.mpf] = []
        quartic: list[mp.mpf] = []
        for n in range(TERMS):
            for out, source in ((cosecant, slope[n]), (quartic, 2 * square[n])):
                known = mp.fdot(over[1 : n + 1], out[:n][::-1]) if n else mp.mpf(0)
                out.append((source - known) / over[0])
    return sine, tangent[:TERMS], slope, product, cosecant, quartic


class Potential:
    """g = E - V of one release, in sixty digits."""

    def __init__(self, numbers: dict[str, mp.mpf]) -> None:
        self.a, self.c, self.h = (numbers[name] for name in CAN)
        a_p, c_p = self.a + self.h**2, self.c + 1
        k = self.c / (self.a + self.c * a_p)
        self.residue = 1 - k * a_p
        self._series(k, k * c_p, self.h * k, k * a_p)
        phi, psi_dot = numbers["phi"], numbers["psi_dot"]
        b, s = mp.sin(phi) ** 2 * psi_dot, psi_dot + numbers["theta_dot"]
        b1, s1, b2, s2 = self.solutions(phi)
        self.K, self.B = s * b2 - b * s2, b * s1 - s * b1
        self.inertia = a_p + 1
        self.energy = mp.mpf(0)
        self.energy = self.inertia * numbers["phi_dot"] ** 2 / 2 - self.g(phi)
        self.release = phi

    def _series(self, _k: mp.mpf, kc: mp.mpf, hk: mp.mpf, ka: mp.mpf) -> None:
        sine, tangent, slope, product, cosecant, quartic = _universal()
        L = 1 - ka
        b1, s1, b2, s2 = [mp.mpf(0)], [mp.mpf(1)], [mp.mpf(1)], [mp.mpf(0)]
        for n in range(1, TERMS):
            for b, s, log in ((b1, s1, False), (b2, s2, True)):
                new = kc * mp.fdot(sine[n - 1 :: -1], s) if n > 1 else kc * sine[0] * s[0]
                new -= kc * mp.fdot(tangent[n - 1 :: -1], b) + hk * b[n - 1]
                b.append((new - (L * b1[n] if log else 0)) / n)
                bend = kc * mp.fdot(tangent[n - 1 :: -1], s) + hk * s[n - 1]
                bend += mp.fdot(quartic[n::-1], b) - ka * mp.fdot(cosecant[n::-1], b)
                bend -= kc * mp.fdot(product[n - 1 :: -1], b[:n])
                bend -= 2 * hk * mp.fdot(slope[n - 1 :: -1], b[:n])
                s.append((bend - (L * s1[n] if log else 0)) / n)
        self._coefficients = [part[::-1] for part in (b1, s1, b2, s2)]

    def solutions(self, phi: mp.mpf) -> tuple[mp.mpf, ...]:
        """Return b1, s1, b2 and s2, the logarithm of the latter two that of phi."""
        # coefficients fall like pi^-n: the rest is below the digits
        terms = int(DIGITS * 2.4 / mp.log(mp.pi / phi)) + 8
        b1, s1, b2, s2 = (mp.polyval(part[-terms:], phi) for part in self._coefficients)
        log = self.residue * mp.log(phi)
        return b1, s1, b2 + log * b1, s2 + log * s1

    def momenta(self, phi: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """Return b = sin^2 phi psi' and the spin psi' + theta' at `phi`."""
        b1, s1, b2, s2 = self.solutions(phi)
        return self.K * b1 + self.B * b2, self.K * s1 + self.B * s2

    def g(self, phi: mp.mpf) -> mp.mpf:
        """Energy of nutation at `phi`."""
        b, s = self.momenta(phi)
        S, C = mp.sin(phi), mp.cos(phi)
        q, w = b / S, s - b / (1 + C)
        kinetic = (self.a * q**2 + self.c * w**2 + (w - self.h * q) ** 2) / 2
        return self.energy - kinetic - S - self.h * C

    def slopes(self, phi: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """Return the derivatives of g with respect to b and to the spin at `phi`."""
        b, s = self.momenta(phi)
        S, C = mp.sin(phi), mp.cos(phi)
        q, w = b / S, s - b / (1 + C)
        v = w - self.h * q
        return -self.a * q / S + (self.c * w + v) / (1 + C) + self.h * v / S, -self.c * w - v


def truth_of(numbers: dict[str, mp.mpf]) -> Truth:
    """Solve one release in sixty digits."""
    with mp.workdps(DIGITS):
        well = Potential(numbers)
        r, resting = well.release, numbers["phi_dot"] == 0
        slope = mp.diff(well.g, r)
        low = high = None
        gaps: list[mp.mpf] = []
        if resting and slope < 0:
            high = r
        elif resting:
            low = r
        if high is None:
            high = _first_root(well, r, mp.pi / 2, gaps, resting=resting)
        if low is None:
            low = _first_root(well, r, DEEPEST * r, gaps, resting=resting)
        period = turn = rotation = None
        if low is not None and high is not None:
            period, turn, rotation = _cycle(well, low, high, gaps)
        gap, gap_at = min(((abs(well.g(x)), x) for x in gaps), default=(mp.inf, None))
        return Truth(
            period=period,
            phi_min=low,
            phi_max=high,
            turn=turn,
            rotation=rotation,
            gap=gap,
            gap_at=gap_at,
        )


def _first_root(
    well: Potential, start: mp.mpf, stop: mp.mpf, gaps: list[mp.mpf], *, resting: bool
) -> mp.mpf | None:
    """First root of g on the way; the extrema of g met are added to `gaps`."""
    # log-spaced from the start at both scales: of the distance, and of the nutation
    ratio = mp.log(stop / start)
    shares = [mp.mpf(10) ** (-30 + mp.mpf(i) * 30 / 40) for i in range(40)]
    shares += [mp.mpf(i) / SCAN for i in range(1, SCAN + 1)]
    places = [start * mp.exp(ratio * share) for share in sorted(shares)]
    scale = well.g if not resting else (lambda x: well.g(x) / abs(x - start))
    values = [scale(x) for x in places]
    for i, value in enumerate(values):
        if i + 1 < len(values) and i > 0 and values[i - 1] > value <= values[i + 1]:
            least = _minimum(scale, places[i - 1], places[i], places[i + 1])
            gaps.append(least)
            if scale(least) < 0 < value:
                return _root(scale, places[i - 1], least)
        if value < 0:
            return _root(scale, places[i - 1], places[i]) if i else None
    return None


def _minimum(f: object, left: mp.mpf, middle: mp.mpf, right: mp.mpf) -> mp.mpf:
    """Minimum of a function inside a bracket, by its derivative."""
    low, high = min(left, right), max(left, right)
    del middle
    for _ in range(160):
        x = (low + high) / 2
        if mp.diff(f, x, h=(high - low) * mp.mpf(10) ** -12) > 0:
            high = x
        else:
            low = x
        if high - low < mp.mpf(10) ** -24 * high:
            break
    return (low + high) / 2


def _root(f: object, left: mp.mpf, right: mp.mpf) -> mp.mpf:
    return mp.findroot(f, (left, right), solver="anderson", tol=mp.mpf(10) ** -90, verify=False)


def _cycle(
    well: Potential, low: mp.mpf, high: mp.mpf, gaps: list[mp.mpf]
) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """Return twice the time, the turn and the rotation between the turning points.

    The variable is x in phi = low + (high - low) sin^2(x/2).
    """
    swing = high - low
    # of the root g vanishes to as many digits as it is known to: near it its slope takes over
    edge = mp.mpf(10) ** -12

    def rates(x: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        time = slowness(x)
        phi = low + swing * mp.sin(x / 2) ** 2
        b, s = well.momenta(phi)
        psi_dot = b / mp.sin(phi) ** 2
        return time, psi_dot * time, (s - psi_dot) * time

    def slowness(x: mp.mpf) -> mp.mpf:
        up = mp.sin(x / 2) ** 2
        down = 1 - up
        if up < edge**2 or down < edge**2:
            end = low if up < edge**2 else high
            return 1 / mp.sqrt(abs(mp.diff(well.g, end)) / swing)
        g = well.g(low + swing * up)
        return 1 / mp.sqrt(g / (swing**2 * up * down))

    inside = sorted(2 * mp.asin(mp.sqrt((x - low) / swing)) for x in gaps if low < x < high)
    splits = [mp.mpf(0), *inside, mp.pi]
    parts = []
    for left, right in pairwise(splits):
        # graded towards both ends, where the neighbouring root may be near
        shares = [mp.mpf(10) ** -k for k in range(11, 0, -1)]
        nodes = [0, *shares, mp.mpf(1) / 2, *[1 - share for share in shares[::-1]], 1]
        parts += [left + (right - left) * node for node in nodes[:-1]]
    parts.append(mp.pi)
    whole = [mp.mpf(0)] * 3
    for left, right in pairwise(parts):
        half, middle = (right - left) / 2, (right + left) / 2
        for x, weight in zip(*RULE, strict=True):
            for place, value in enumerate(rates(middle + half * x)):
                whole[place] += half * weight * value
    period, turn, rotation = (2 * mp.sqrt(well.inertia / 2) * integral for integral in whole)
    return period, turn, rotation


def relative(measure: str, one: mp.mpf, known: mp.mpf) -> mp.mpf:
    """Return by how much a measure differs: an angle over 1 rad, or over itself if it is larger."""
    scale = max(mp.mpf(1), abs(known)) if measure in {"turn", "rotation"} else abs(known)
    return abs(one - known) / scale


def conditioning(made: Made, truth: Truth) -> dict[str, float]:
    """Return the relative change of each measure for half an ulp of each number given.

    `gap` is the change of the least gap over the gap: beyond 1 round-off decides what follows.
    """
    with mp.workdps(DIGITS):
        return _conditioning(numbers_of(made), truth)


def _conditioning(numbers: dict[str, mp.mpf], truth: Truth) -> dict[str, float]:
    changed = dict.fromkeys((*MEASURES, "gap"), mp.mpf(0))
    for name, value in numbers.items():
        if value == 0:
            continue
        other = truth_of({**numbers, name: value * (1 + STEP)})
        for key in changed:
            one, two = getattr(truth, key), getattr(other, key)
            if one is None or two is None or mp.inf in (one, two):
                continue
            changed[key] += relative(key, two, one) / STEP * EPS
    return {key: float(value) for key, value in changed.items()}


def ulps_of_the_gap(made: Made, truth: Truth) -> float:
    """Return how many ulps of everything, all together, close the least gap of the energy.

    Everything is each number given, and the first integrals and the energy that follow from them:
    what a solver in doubles holds rounded. Each is moved in the direction that closes the gap. At
    an extremum of g the place moves the gap to second order only. Infinite without such a gap.
    """
    if truth.gap_at is None:
        return float("inf")
    with mp.workdps(DIGITS):
        numbers, at = numbers_of(made), truth.gap_at
        well = Potential(numbers)
        moved = [
            Potential({**numbers, name: value * (1 + 2 * EPS)}).g(at) - well.g(at)
            for name, value in numbers.items()
            if value
        ]
        b1, s1, b2, s2 = well.solutions(at)
        dg_db, dg_ds = well.slopes(at)
        moved += [
            2 * EPS * well.K * (dg_db * b1 + dg_ds * s1),
            2 * EPS * well.B * (dg_db * b2 + dg_ds * s2),
            2 * EPS * well.energy,
        ]
        return float(truth.gap / mp.fsum(map(abs, moved)))


def ulps_decide_the_ending(made: Made, truth: Truth, ulps: int) -> bool:
    """Whether so many ulps make a bounce, or undo it: of everything together, or of one number."""
    if ulps_of_the_gap(made, truth) <= ulps:
        return True
    numbers = numbers_of(made)
    for name, value in numbers.items():
        for share in (2 * ulps * EPS, -2 * ulps * EPS) if value else ():
            other = truth_of({**numbers, name: value * (1 + share)})
            if (other.period is None) != (truth.period is None):
                return True
    return False


def moved_by_ulps(
    made: Made, truth: Truth, ulps: int, enough: float, measures: tuple[str, ...] = MEASURES
) -> float:
    """Return by how much so many ulps of each number move a measure, added up until it is enough.

    Of the measures that which is moved most. Infinite where they decide whether there is a period.
    """
    numbers = numbers_of(made)
    total = dict.fromkeys(measures, 0.0)
    for name in ("psi_dot", "theta_dot", "phi", "a", "c", "h", "phi_dot"):
        moved = dict.fromkeys(measures, 0.0)
        for share in (2 * ulps * EPS, -2 * ulps * EPS) if numbers[name] else ():
            other = truth_of({**numbers, name: numbers[name] * (1 + share)})
            if (other.period is None) != (truth.period is None):
                return float("inf")
            for key in measures if truth.period is not None else ():
                changed = float(relative(key, getattr(other, key), getattr(truth, key)))
                moved[key] = max(moved[key], changed)
        for key in measures:
            total[key] += moved[key]
        if max(total.values()) > enough:
            break
    return max(total.values())
