"""Derivatives of bounces to some twenty digits, by central differences in 84-digit arithmetic.

Bounces that differ by a part in 1e14 in one number of the release or of the can, each by the
Taylor series of `make_golden`; the peaks are searched for along the series. Neither a first
integral, a quadrature nor a derivative is used. Run this file to rewrite derivatives.json (an
hour; less with gmpy2):

    python -m tests.reference.golden.make_derivatives
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import mpmath as mp

from tests.reference.golden.make_golden import (
    CANS,
    Release,
    evaluate,
    first_root,
    step_size,
    taylor,
)

DIGITS = 22
SHIFT = mp.mpf(10) ** -14
NAMES = ("phi", "phi_dot", "psi_dot", "theta_dot", "a", "c", "h")
# Beside phi_min and phi_max a peak is looked for in so many places of a step.
PIECES = 8
# Can, nutation as a fraction of the balancing angle or 1 minus a distance from it; rates.
RELEASES = [
    ("paper", 0.7, (0.0, 0.12, -0.06)),
    ("paper", 0.05, (0.0, 0.0112, -0.0112)),
    ("paper", 0.4, (-0.05, 0.3, 0.2)),
    ("hoop", 0.3, (0.0, 1e-3, 5e-4)),
    ("thin disk", 0.3, (0.0, 0.002, 0.01)),
    ("paper", 0.99, (0.0, 1e-2, 2e-2)),
    ("tall", 0.2, (0.03, 0.05, -0.1)),
    # a fast bounce, one beside the separatrix, one of another can that is all but planar
    ("paper", 0.6, (0.2, 3.0, -1.0)),
    ("paper", 1 - 1e-6, (0.0, 1e-3, 2e-3)),
    ("uniform cylinder", 0.5, (0.0, 1e-3, -9e-4)),
    # deep bounces
    ("paper", 0.7, (0.0, 1e-6, -5e-7)),
    ("uniform cylinder", 0.4, (-0.1, -1e-5, 2e-5)),
]

State = list[mp.mpf]
Function = Callable[[mp.mpf], mp.mpf]


def friction(release: Release, state: State, rates: State) -> mp.mpf:
    """Return |F|/N from the acceleration of the centre of mass; negative where the plane pulls.

    Parameters
    ----------
    state, rates : list of mpf
        phi, Phi, Psi, Theta and their derivatives.
    """
    h = mp.mpf(release.h)
    phi, Phi, Psi, Theta = state[:4]
    _, dPhi, dPsi, dTheta = rates[:4]
    S, C = mp.sin(phi), mp.cos(phi)
    # the middle of the can moves with (Phi height, aside) and upwards with -Phi along, in axes that
    # turn with psi, while the contact does not slip
    height, along = -(S + h * C), h * S - C
    ahead = Phi * height
    aside = Theta + Psi * (C - h * S)
    d_height, d_along = -(C - h * S) * Phi, (h * C + S) * Phi
    d_ahead = dPhi * height + Phi * d_height
    d_aside = dTheta + dPsi * (C - h * S) - Psi * Phi * (S + h * C)
    upwards = -dPhi * along - Phi * d_along
    N = 1 + upwards
    return mp.hypot(d_ahead - Psi * aside, d_aside + Psi * ahead) / N


def peak(of: Function, low: mp.mpf, high: mp.mpf) -> mp.mpf:
    """Return the largest magnitude between two times around it, by golden sections."""
    golden = (mp.sqrt(5) - 1) / 2
    left, right = high - golden * (high - low), low + golden * (high - low)
    f_left, f_right = abs(of(left)), abs(of(right))
    for _ in range(110):
        if f_left > f_right:
            high, right, f_right = right, left, f_left
            left = high - golden * (high - low)
            f_left = abs(of(left))
        else:
            low, left, f_left = left, right, f_right
            right = low + golden * (high - low)
            f_right = abs(of(right))
    ends = (of(low), of(high), of((low + high) / 2))
    return max(ends, key=abs)


def of_friction(release: Release, series: list[State]) -> Function:
    """Return |F|/N as a function of the time of a step."""

    def at(t: mp.mpf) -> mp.mpf:
        values = [evaluate(s, t) for s in series[:4]]
        slopes = [evaluate([n * x for n, x in enumerate(s)][1:], t) for s in series[:4]]
        return friction(release, values, slopes)

    return at


def of_rate(_: Release, series: list[State]) -> Function:
    """Return the precession rate as a function of the time of a step."""
    return lambda t: evaluate(series[2], t)


PEAKS = {"peak_psi_dot": of_rate, "peak_friction_ratio": of_friction}


@dataclass
class Best:
    """The largest value of a quantity so far, and between which times of which step it is."""

    value: mp.mpf = -1
    of: Function | None = None
    low: mp.mpf = 0
    high: mp.mpf = 0

    def look(self, of: Function, time: mp.mpf, step: mp.mpf) -> None:
        """Look for a larger value in a step that begins at a time."""
        for piece in range(PIECES + 1):
            at = step * piece / PIECES
            if (value := abs(of(at))) > self.value:
                low = max(at - step / PIECES, -time)
                self.value, self.of, self.low, self.high = value, of, low, at + step / PIECES


def bounce(release: Release) -> dict[str, mp.mpf]:
    """Return the numbers of the first bounce; a release that falls opens it."""
    start = (release.phi, release.phi_dot, release.psi_dot, release.theta_dot, 0, 0)
    state = [mp.mpf(value) for value in start]
    time, maxima, bottom = mp.mpf(0), [], mp.mpf(0)
    if release.phi_dot < 0 or (release.phi_dot == 0 and taylor(state, release)[1][1] < 0):
        maxima.append((time, state[4]))
    best = {name: Best() for name in PEAKS}
    while len(maxima) < 2:
        series = taylor(state, release)
        step = step_size(series)
        for name, quantity in PEAKS.items():
            best[name].look(quantity(release, series), time, step)
        root = first_root(series[1], step)
        if root is not None and not (root < step * mp.mpf(10) ** -30):
            if evaluate([n * s for n, s in enumerate(series[1])][1:], root) < 0:
                maxima.append((time + root, evaluate(series[4], root)))
            elif maxima:
                bottom = evaluate(series[0], root)
        time += step
        state = [evaluate(s, step) for s in series]
    (t0, first), (t1, last) = maxima
    out = {"period": t1 - t0, "angle_of_turn": last - first, "phi_min": bottom}
    for name, found in best.items():
        if found.of is not None:
            out[name] = peak(found.of, found.low, found.high)
    return out


def derivatives(release: Release) -> dict[str, dict[str, str]]:
    """Return central differences of the bounce by each number; of a rest by phi_dot none."""
    out: dict[str, dict[str, str]] = {}
    for name in NAMES:
        value = mp.mpf(getattr(release, name))
        if name == "phi_dot" and not value:
            continue
        shift = abs(value) * SHIFT
        ahead, behind = (
            bounce(replace(release, **{name: value + sign * shift})) for sign in (1, -1)
        )
        for key, one in ahead.items():
            slope = (one - behind[key]) / (2 * shift)
            out.setdefault(key, {})[name] = mp.nstr(slope, DIGITS)
    return out


def main() -> None:
    """Write derivatives.json; of releases that are there already, what is there."""
    path = Path(__file__).with_name("derivatives.json")
    known = json.loads(path.read_text()) if path.exists() else []
    rows = []
    for name, fraction, (phi_dot, psi_dot, theta_dot) in RELEASES:
        can = CANS[name]
        phi = fraction * math.atan(1 / can["h"])
        rates = {"phi_dot": phi_dot, "psi_dot": psi_dot, "theta_dot": theta_dot}
        release = Release(**can, phi=phi, **rates)
        fields = {field: getattr(release, field) for field in Release.__slots__}
        row = {"can": name, **fields}
        same = [one for one in known if {key: one[key] for key in row} == row]
        rows.append(same[0] if same else {**row, "derivatives": derivatives(release)})
        print(name, release, rows[-1]["derivatives"]["angle_of_turn"], flush=True)  # noqa: T201
        path.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
