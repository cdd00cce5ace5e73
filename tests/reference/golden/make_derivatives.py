"""Derivatives of bounces to some twenty digits, by central differences in 84-digit arithmetic.

Bounces that differ by a part in 1e14 in one number of the release or of the can, each by the
Taylor series of `make_golden`; the peaks are searched for along the series. Neither a first
integral, a quadrature nor a derivative is used. Run this file to rewrite derivatives.json (some
tens of minutes; a few with gmpy2):

    python -m tests.reference.golden.make_derivatives
"""

import json
import math
from collections.abc import Callable
from dataclasses import replace
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
    ("paper", 0.5, (0.2, 0.12, 0.4)),
    ("paper", 1 - 1e-5, (0.0, 1e-4, 2e-4)),
    ("thin disk", 0.3, (0.0, 0.002, 0.01)),
    ("thin disk", 1 - 1e-8, (0.0, 1e-6, 0.1)),
    ("tall", 0.2, (0.03, 0.05, -0.1)),
    ("tall", 0.6, (0.0, -1e-8, 1.5e-8)),
    ("hoop", 0.3, (0.0, 1e-3, 5e-4)),
    ("hoop", 0.5, (0.02, 1.0, 2.0)),
    ("uniform cylinder", 0.4, (-0.01, 1e-6, -3e-6)),
]

State = list[mp.mpf]


def friction(release: Release, state: State, rates: State) -> mp.mpf | None:
    """Return |F|/N from the acceleration of the centre of mass, if the plane pushes.

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
    if N <= 0:
        return None
    return mp.hypot(d_ahead - Psi * aside, d_aside + Psi * ahead) / N


def peak(of: Callable[[mp.mpf], mp.mpf], low: mp.mpf, high: mp.mpf) -> mp.mpf:
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


def bounce(release: Release) -> dict[str, mp.mpf | None]:
    """Return the numbers of the first bounce; a release that falls opens it."""
    start = (release.phi, release.phi_dot, release.psi_dot, release.theta_dot, 0, 0)
    state = [mp.mpf(value) for value in start]
    time, maxima, bottom = mp.mpf(0), [], None
    if release.phi_dot < 0 or (release.phi_dot == 0 and taylor(state, release)[1][1] < 0):
        maxima.append((time, state))
    best: dict[str, tuple[mp.mpf, Callable[[mp.mpf], mp.mpf], mp.mpf, mp.mpf]] = {}
    pulled = False
    while len(maxima) < 2:
        series = taylor(state, release)
        step = step_size(series)

        def of_friction(t: mp.mpf, series: list[State] = series) -> mp.mpf | None:
            values = [evaluate(s, t) for s in series[:4]]
            slopes = [evaluate([n * x for n, x in enumerate(s)][1:], t) for s in series[:4]]
            return friction(release, values, slopes)

        def of_rate(t: mp.mpf, series: list[State] = series) -> mp.mpf:
            return evaluate(series[2], t)

        for name, of in (("peak_psi_dot", of_rate), ("peak_friction_ratio", of_friction)):
            for piece in range(PIECES + 1):
                at = step * piece / PIECES
                value = of(at)
                if value is None:
                    pulled = True
                elif name not in best or abs(value) > best[name][0]:
                    low = at - step / PIECES if time + at > 0 else at
                    best[name] = abs(value), of, max(low, -time), at + step / PIECES
        root = first_root(series[1], step)
        if root is not None and not (root < step * mp.mpf(10) ** -30):
            at = [evaluate(s, root) for s in series]
            if evaluate([n * s for n, s in enumerate(series[1])][1:], root) < 0:
                maxima.append((time + root, at))
            elif maxima:
                bottom = at
        time += step
        state = [evaluate(s, step) for s in series]
    (t0, first), (t1, last) = maxima
    assert bottom is not None
    out = {"period": t1 - t0, "angle_of_turn": last[4] - first[4], "phi_min": bottom[0]}
    for name, (_, of, low, high) in best.items():
        out[name] = None if pulled and name == "peak_friction_ratio" else peak(of, low, high)
    return out


def derivatives(release: Release) -> dict[str, dict[str, str | None]]:
    """Return central differences of the bounce by each number; of a rest by phi_dot none."""
    out: dict[str, dict[str, str | None]] = {}
    for name in NAMES:
        value = mp.mpf(getattr(release, name))
        if name == "phi_dot" and not value:
            continue
        shift = abs(value) * SHIFT
        ahead, behind = (
            bounce(replace(release, **{name: value + sign * shift})) for sign in (1, -1)
        )
        for key, one in ahead.items():
            other = behind[key]
            slope = None if one is None or other is None else (one - other) / (2 * shift)
            out.setdefault(key, {})[name] = None if slope is None else mp.nstr(slope, DIGITS)
    return out


def main() -> None:
    """Write derivatives.json."""
    rows = []
    for name, fraction, (phi_dot, psi_dot, theta_dot) in RELEASES:
        can = CANS[name]
        phi = fraction * math.atan(1 / can["h"])
        rates = {"phi_dot": phi_dot, "psi_dot": psi_dot, "theta_dot": theta_dot}
        release = Release(**can, phi=phi, **rates)
        fields = {field: getattr(release, field) for field in Release.__slots__}
        rows.append({"can": name, **fields, "derivatives": derivatives(release)})
        print(name, release, rows[-1]["derivatives"]["angle_of_turn"], flush=True)  # noqa: T201
        path = Path(__file__).with_name("derivatives.json")
        path.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
