"""Forty-digit values of the rocking can, by a method that shares nothing with the package.

The full equations as printed (eq01:non_dimensionalised_eom) are integrated in time by Taylor series
of high order in 84-digit arithmetic, from a maximum of phi to the next; extrema are roots of the
series of phi'. No first integral, energy, quadrature or regularisation is used. Run this file to
rewrite golden.json (half an hour), or hard.json (some minutes), the releases at which round-off
would have the say if they were not taken for exactly the doubles they are:

    python -m tests.reference.golden.make_golden [golden | hard]
"""

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import mpmath as mp

ORDER = 70
# Near the flat state the two rates cancel to 24 digits when epsilon is 1e-24: 84 - 24 leaves 60.
mp.mp.dps = 84
TOLERANCE = mp.mpf(10) ** -58
DIGITS = 40

CANS = {
    "paper": {"a": 0.727, "c": 0.615, "h": 1.473},
    "thin disk": {"a": 0.25 + 0.05**2 / 3, "c": 0.5, "h": 0.05},
    "tall": {"a": 0.25 + 16 / 3, "c": 0.5, "h": 4.0},
    "hoop": {"a": 0.5 + 0.25 / 3, "c": 1.0, "h": 0.5},
    "uniform cylinder": {"a": 0.25 + 1 / 3, "c": 0.5, "h": 1.0},
}
# Nutation as a fraction of the balancing angle; epsilon; precession and rotation rates in units of
# sqrt(epsilon)/phi^2, so that B is about sqrt(epsilon); the rate of nutation.
RELEASES = [
    (0.05, 1e-3, (0.3, -0.2), 0.0),
    (0.05, 1e-6, (1.0, -0.99), 0.0),
    (0.05, 1e-10, (1.0, -0.999), 0.0),
    (0.1, 1e-12, (-1.0, 0.5), 0.0),
    (0.3, 1e-14, (1.0, 0.25), 0.0),
    (0.2, 1e-16, (-0.5, -0.75), 0.0),
    (0.5, 1e-18, (0.25, -1.0), 0.0),
    (0.4, 1e-20, (1.0, 0.0), 0.0),
    (0.6, 1e-24, (-1.0, 1.5), 0.0),
    (1 - 1e-5, 1e-8, (0.5, 1.0), 0.0),
    (1 - 1e-3, 1e-12, (-1.0, 0.5), 0.0),
    (0.3, 1e-4, (0.5, 0.5), 0.02),
    (0.5, 1e-9, (-1.0, 0.7), -0.05),
]
# Can, nutation as it is or as a distance below the balancing angle, and rates of phi, psi, theta.
HARD = [
    ("paper", {"short": 1e-12}, (0.0, 0.0, 0.123)),
    ("paper", {"short": 1e-14}, (0.0, 0.0, -0.3)),
    ("thin disk", {"short": 1e-9}, (0.0, 1e-7, 0.2)),
    ("hoop", {"short": 1e-10}, (0.0, -1e-9, 1e-3)),
    ("tall", {"phi": 0.1}, (1e-9, 0.01, -0.02)),
    ("paper", {"phi": 0.3}, (-1e-8, 0.05, 0.1)),
    ("uniform cylinder", {"phi": 0.2}, (3e-14, 1.0, 0.5)),
    ("hoop", {"phi": 1e-4}, (0.3, 1.0, -0.999)),
    ("paper", {"phi": 3e-7}, (0.2, 3.0, -2.9999)),
    ("flywheel", {"phi": 0.9223794896086074}, (0.0, 1e-9, -16.3)),
    ("uniform cylinder", {"phi": 0.2}, (0.0, 4.0, -3.0)),
    ("paper", {"phi": 0.7}, (0.0, 0.5, 30.0)),
]
MORE_CANS = {**CANS, "flywheel": {"a": 22.4, "c": 44.6, "h": 0.746}}


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """A can and how it is let go, in doubles."""

    a: float
    c: float
    h: float
    phi: float
    phi_dot: float
    psi_dot: float
    theta_dot: float


def releases() -> list[tuple[str, Release]]:
    """Every can with every release."""
    out = []
    for name, can in CANS.items():
        balance = math.atan(1 / can["h"])
        for fraction, epsilon, (precession, rotation), phi_dot in RELEASES:
            phi = fraction * balance
            unit = math.sqrt(epsilon) / phi**2
            release = Release(
                **can,
                phi=phi,
                phi_dot=phi_dot,
                psi_dot=precession * unit,
                theta_dot=rotation * unit,
            )
            out.append((name, release))
    return out


def hard_releases() -> list[tuple[str, Release]]:
    """Releases beside balance, that hardly move, are thrown up, or spin fast."""
    out = []
    for name, place, (phi_dot, psi_dot, theta_dot) in HARD:
        can = MORE_CANS[name]
        phi = place.get("phi") or math.atan(1 / can["h"]) - place["short"]
        out.append(
            (name, Release(**can, phi=phi, phi_dot=phi_dot, psi_dot=psi_dot, theta_dot=theta_dot))
        )
    return out


def product(x: list[mp.mpf], y: list[mp.mpf], n: int) -> mp.mpf:
    """Coefficient n of a product of two series."""
    return mp.fdot(zip(x[: n + 1], y[n::-1], strict=True))


def taylor(state: list[mp.mpf], release: Release) -> list[list[mp.mpf]]:
    """Series of phi, Phi, Psi, Theta, psi, theta in time about a state."""
    a, c, h = mp.mpf(release.a), mp.mpf(release.c), mp.mpf(release.h)
    a_p, c_p = a + h * h, c + 1
    k = c / (a + c * a_p)
    phi, Phi, Psi, Theta, psi, theta = ([value] for value in state)
    S, C = [mp.sin(state[0])], [mp.cos(state[0])]
    SC: list[mp.mpf] = []
    CC: list[mp.mpf] = []
    rate: list[mp.mpf] = []  # Phi/S
    f_Psi: list[mp.mpf] = []
    f_Theta: list[mp.mpf] = []
    f_Phi: list[mp.mpf] = []
    quad: list[mp.mpf] = []
    for n in range(ORDER):
        SC.append(product(S, C, n))
        CC.append(product(C, C, n))
        known = mp.fdot(zip(rate, S[n:0:-1], strict=True)) if n else mp.mpf(0)
        rate.append((Phi[n] - known) / S[0])
        # coefficients that multiply Theta and Psi, from 1 - C^2 = S^2 and cos 2 phi = 2 C^2 - 1
        psi_on_psi = [(k * c_p - 2) * C[i] - h * k * S[i] for i in range(n + 1)]
        theta_on_theta = [h * k * S[i] - k * c_p * C[i] for i in range(n + 1)]
        psi_on_theta = [
            (a_p - c_p) * k * CC[i] + 2 * h * k * SC[i] + ((2 - k * a_p) if i == 0 else 0)
            for i in range(n + 1)
        ]
        f_Psi.append(k * c_p * Theta[n] + product(psi_on_psi, Psi, n))
        f_Theta.append(product(theta_on_theta, Theta, n) + product(psi_on_theta, Psi, n))
        on_square = [
            (a_p - c_p) * SC[i] - h * (2 * CC[i] - (1 if i == 0 else 0)) for i in range(n + 1)
        ]
        on_product = [c_p * S[i] + h * C[i] for i in range(n + 1)]
        quad.append(product(on_square, Psi, n) - product(on_product, Theta, n))
        f_Phi.append((product(quad, Psi, n) + h * S[n] - C[n]) / (a_p + 1))
        m = n + 1
        phi.append(Phi[n] / m)
        Phi.append(f_Phi[n] / m)
        psi.append(Psi[n] / m)
        theta.append(Theta[n] / m)
        Psi.append(product(rate, f_Psi, n) / m)
        Theta.append(product(rate, f_Theta, n) / m)
        S.append(product(C, Phi, n) / m)
        C.append(-product(S[: n + 1], Phi, n) / m)
    return [phi, Phi, Psi, Theta, psi, theta]


def evaluate(series: list[mp.mpf], time: mp.mpf) -> mp.mpf:
    """Value of a series."""
    return mp.polyval(series[::-1], time)


def step_size(series: list[list[mp.mpf]]) -> mp.mpf:
    """Step at which the last terms are below the tolerance, relative to each series."""
    steps = []
    for coefficients in series[:4]:
        scale = max(abs(coefficients[0]), mp.mpf("1e-30"))
        steps += [
            (TOLERANCE * scale / abs(coefficients[n])) ** (mp.mpf(1) / n)
            for n in (ORDER - 1, ORDER)
            if coefficients[n]
        ]
    return min(steps)


def first_root(series: list[mp.mpf], step: mp.mpf) -> mp.mpf | None:
    """Where phi' changes sign within a step, away from its start."""
    pieces = 8
    times = [step * i / pieces for i in range(pieces + 1)]
    values = [evaluate(series, t) for t in times]
    values[0] = values[1] if abs(values[0]) < mp.mpf(10) ** -50 else values[0]
    for left, right, f_left, f_right in zip(times, times[1:], values, values[1:], strict=False):
        if f_left * f_right < 0:
            return mp.findroot(
                lambda t: evaluate(series, t), (left, right), solver="anderson", tol=1e-130
            )
    return None


def solve(release: Release) -> dict[str, str]:
    """Period, turn, rotation, phi_min and peak rate between two maxima."""
    state = [
        mp.mpf(release.phi),
        mp.mpf(release.phi_dot),
        mp.mpf(release.psi_dot),
        mp.mpf(release.theta_dot),
        mp.mpf(0),
        mp.mpf(0),
    ]
    time, maxima, bottom, largest = mp.mpf(0), [], None, mp.mpf(0)
    if release.phi_dot == 0 and taylor(state, release)[1][1] < 0:
        maxima.append((time, state))
    while len(maxima) < 2:
        series = taylor(state, release)
        step = step_size(series)
        root = first_root(series[1], step)
        if root is not None:
            at = [evaluate(s, root) for s in series]
            if evaluate([n * s for n, s in enumerate(series[1])][1:], root) < 0:
                maxima.append((time + root, at))
            elif maxima:
                bottom = at
        if maxima:
            largest = max(largest, *(abs(evaluate(series[2], step * i / 8)) for i in range(8)))
        time += step
        state = [evaluate(s, step) for s in series]
    (t0, first), (t1, last) = maxima
    # the motion is periodic: what returns measures what was lost on the way
    lost = max(abs(last[i] / first[i] - 1) for i in (0, 2, 3) if first[i])
    if lost > mp.mpf(10) ** -(DIGITS + 2):
        raise ArithmeticError(f"lost digits: {mp.nstr(lost, 3)} in {release}")
    assert bottom is not None
    peak = max((bottom[2], first[2]), key=abs)
    if largest > abs(peak) * (1 + mp.mpf(10) ** -DIGITS):
        # the script reads the peak at the extrema of phi: choose another release
        raise ArithmeticError(f"the precession peaks between the extrema in {release}")
    return {
        name: mp.nstr(value, DIGITS)
        for name, value in {
            "first_maximum": t0,
            "period": t1 - t0,
            "angle_of_turn": last[4] - first[4],
            "rotation_turn": last[5] - first[5],
            "phi_min": bottom[0],
            "phi_max": last[0],
            "peak_psi_dot": peak,
        }.items()
    }


def main() -> None:
    """Write the table that was asked for beside this file."""
    table = sys.argv[1] if len(sys.argv) > 1 else "golden"
    rows = []
    for name, release in {"golden": releases, "hard": hard_releases}[table]():
        fields = {field: getattr(release, field) for field in Release.__slots__}
        rows.append({"can": name, **fields, **solve(release)})
        if table == "golden":
            # which no test of these asks for
            del rows[-1]["first_maximum"]
        print(name, release, rows[-1]["angle_of_turn"][:18], flush=True)  # noqa: T201 - progress
    path = Path(__file__).with_name(f"{table}.json")
    path.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
