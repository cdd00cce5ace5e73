"""Thirty digits of how a rolling can's disturbances grow, by differences of motions.

Two motions a part in 1e20 apart, each by the Taylor series of `make_golden` in 84 digits, and their
difference over it: neither a Jacobian nor a variational equation is used. Run this file to rewrite
tangent.json (a minute):

    python -m tests.reference.golden.make_tangent
"""

import json
from dataclasses import replace
from pathlib import Path

import mpmath as mp

from tests.reference.golden.make_golden import CANS, Release, evaluate, step_size, taylor

DIGITS = 30
SHIFT = mp.mpf(10) ** -20
RELEASE = {"phi": 0.4, "psi_dot": 0.12, "theta_dot": -0.06}
DURATION = 4.0


def end(release: Release, theta: mp.mpf) -> list[mp.mpf]:
    """State (phi, phi', psi', theta', psi, theta) after `DURATION`, through a bounce."""
    rates = (release.phi_dot, release.psi_dot, release.theta_dot)
    state = [mp.mpf(value) for value in (release.phi, *rates, 0, theta)]
    left = mp.mpf(DURATION)
    while left > 0:
        series = taylor(state, release)
        step = min(step_size(series), left)
        state, left = [evaluate(one, step) for one in series], left - step
    return state


def main() -> None:
    """Write tangent.json."""
    start = Release(**CANS["paper"], **RELEASE, phi_dot=0.0)
    phi, _, Psi, *_ = end(start, mp.mpf(0))
    columns = []
    for name in ("phi", "theta", "psi_dot", "theta_dot"):
        pair = []
        for shift in (SHIFT, -SHIFT):
            moved = start
            if name != "theta":
                moved = replace(start, **{name: mp.mpf(RELEASE[name]) + shift})
            pair.append(end(moved, shift if name == "theta" else mp.mpf(0)))
        d = [(ahead - behind) / (2 * SHIFT) for ahead, behind in zip(*pair, strict=True)]
        axial = d[2] * mp.cos(phi) - Psi * mp.sin(phi) * d[0] + d[3]
        columns.append((d[0], d[4], d[4] + d[5], axial))
    answer: dict[str, object] = {"release": RELEASE, "duration": DURATION}
    for row, name in enumerate(("phi", "psi", "total", "axial")):
        answer[name] = [mp.nstr(column[row], DIGITS) for column in columns]
    Path(__file__).with_name("tangent.json").write_text(json.dumps(answer, indent=2) + "\n")


if __name__ == "__main__":
    main()
