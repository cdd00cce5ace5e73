"""The reference against heyoka, a Taylor integrator that compiles the equations given to it.

heyoka is given all that spares it work. The equations are those of nutation, b and the spin
(`reference.integrable.frobenius`) and psi, with T = tan(phi/2) for phi, so that all is rational.
It is told the period and so watches for no event. Releases of a batch are sorted by how hard the
bounce is, so that none waits for another. `fast_math` is on, `compact_mode` and `high_accuracy` are
off. Our error is that against turns known to forty digits, heyoka's that against ours.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from reference import PAPER_CAN, PeriodicMotions
from tests.benchmarks.clock import Ratio, in_turns

LANES = 8
ROUND_OFF = 5e-14
"""rad: a hundred roundings of a turn, below which two integrations are equally good."""
TOLERANCES = (1e-15, 1e-14)
"""Of heyoka: its own round-off, and the loosest that leaves its error no larger than that."""
ALLOWED = 1e-12
"""rad: error of a turn up to which an integration counts."""
GOLDEN = Path(__file__).parents[1] / "reference" / "golden" / "golden.json"
_INSTALL = "heyoka is not installed, and its rows are left out: pip install 'rockingcan[heyoka]'"

Releases = Mapping[str, np.ndarray]


def missing() -> str:
    """Return in a sentence that heyoka is missing; nothing if it is there."""
    return "" if find_spec("heyoka") is not None else _INSTALL


def equations() -> list[tuple[Any, Any]]:
    """Return the equations of T, phi', b, spin and psi of the paper's can for heyoka."""
    import heyoka as hy  # noqa: PLC0415 - optional, and slow to import

    p = PAPER_CAN
    kc, hk, ka = p.k * p.c_p, p.h * p.k, p.k * p.a_p
    T, Phi, b, s, psi = hy.make_vars("T", "Phi", "b", "s", "psi")
    double = 1 + T * T
    S, C = 2 * T / double, 2 / double - 1
    q = b / S
    rate = q / S
    bend = p.a_p * C + p.c_p * T * S + p.h * T * (1 + 2 * C)
    W = kc * T + hk
    M = double / 2 * (double / T - W - hk - ka / T)
    force = rate * (q * bend - (p.c_p * S + p.h * C) * s) + p.h * S - C
    return [
        (T, double / 2 * Phi),
        (Phi, force / (p.a_p + 1)),
        (b, Phi * (kc * S * s - W * b)),
        (s, Phi * (W * s + M * b)),
        (psi, rate),
    ]


def starts(releases: Releases) -> np.ndarray:
    """Return the states of releases at rest, shape (5, n)."""
    phi, psi_dot = releases["phi"], releases["psi_dot"]
    zero = np.zeros_like(phi)
    spin = psi_dot + releases["theta_dot"]
    return np.stack([np.tan(phi / 2), zero, np.sin(phi) ** 2 * psi_dot, spin, zero])


class Batches:
    """heyoka's integration of releases, eight at a time, over a bounce each.

    Parameters
    ----------
    releases : mapping of str to ndarray, shape (n,)
        phi, psi_dot and theta_dot.
    known : PeriodicMotions
        What is told: periods, and how hard each bounce is.
    tolerance : float
    """

    def __init__(self, releases: Releases, known: PeriodicMotions, tolerance: float) -> None:
        import heyoka as hy  # noqa: PLC0415 - see above

        n = known.period.size
        if n % LANES:
            raise ValueError(f"heyoka takes {LANES} releases at a time, and {n} are no multiple")
        self._order = np.argsort(known.phi_min / known.phi_max)
        sorted_states = starts(releases)[:, self._order].reshape(5, -1, LANES)
        self._states = np.ascontiguousarray(sorted_states.transpose(1, 0, 2))
        self._periods = known.period[self._order].reshape(-1, LANES)
        self._integrator = hy.taylor_adaptive_batch(
            equations(), np.full((5, LANES), 0.1), tol=tolerance, fast_math=True
        )
        self.count = n

    def turns(self) -> np.ndarray:
        """Return the angles of turn in the order of the releases, rad."""
        turns = np.empty(self._periods.shape)
        integrator = self._integrator
        for batch, states in enumerate(self._states):
            integrator.set_time(0.0)
            integrator.state[:] = states
            integrator.propagate_until(self._periods[batch])
            turns[batch] = integrator.state[4]
        out = np.empty(self.count)
        out[self._order] = turns.ravel()
        return out


def golden_error(solve: Callable[[Releases], PeriodicMotions]) -> float:
    """Return the largest error of turns that are known to forty digits, of the paper's can, rad."""
    p = PAPER_CAN
    rows = [
        row
        for row in json.loads(GOLDEN.read_text())
        if (row["a"], row["c"], row["h"], row["phi_dot"]) == (p.a, p.c, p.h, 0.0)
    ]
    found = solve(
        {name: np.array([row[name] for row in rows]) for name in ("phi", "psi_dot", "theta_dot")}
    )
    true = np.array([float(row["angle_of_turn"]) for row in rows])
    return float(np.abs(found.angle_of_turn - true).max())


def batch_ratios(
    releases: Releases, solve: Callable[[Releases], PeriodicMotions], few: int
) -> Iterator[Ratio]:
    """Measure exact bounces of all releases against heyoka's of a few, per bounce.

    Parameters
    ----------
    releases : mapping of str to ndarray, shape (n,)
    solve : callable
        From releases to their exact bounces.
    few : int
        Releases that heyoka integrates.
    """
    some = {name: values[:few] for name, values in releases.items()}
    known, own_error = solve(some), golden_error(solve)
    for tolerance in TOLERANCES:
        batches = Batches(some, known, tolerance)
        own, rival = in_turns(lambda: solve(releases), batches.turns, repeats=3)
        ours, theirs = own / releases["phi"].size, rival / batches.count
        error = float(np.abs(batches.turns() - known.angle_of_turn).max())
        yield Ratio(
            what=f"exact bounce in a batch of {releases['phi'].size:,} against heyoka in batches "
            f"of {LANES} at tolerance {tolerance:g}, per bounce",
            ratio=theirs / ours,
            claim="at least 2 times faster",
            holds=theirs >= 2.0 * ours and own_error <= ALLOWED and error <= ALLOWED,
            first_s=ours,
            second_s=theirs,
            note=f"turns within {own_error:.1e} rad of forty digits, heyoka's within {error:.1e} "
            "of these; it is told the periods, and given releases of like hardness together",
        )


def single_ratio(
    release: Releases,
    known: PeriodicMotions,
    solve: Callable[[], float],
    true_turn: float,
    most: float | None,
) -> Ratio:
    """Measure one bounce by the time integrator against heyoka.

    Parameters
    ----------
    release : mapping of str to ndarray, shape (1,)
    known : PeriodicMotions
        Of the release.
    solve : callable
        Integrates it, and returns the turn, rad.
    true_turn : float
        In rad.
    most : float or None
        How many times slower than heyoka is claimed; None claims nothing.
    """
    import heyoka as hy  # noqa: PLC0415 - see above

    rounds = 20  # of either: a bounce is too short for the clock
    state, period = starts(release)[:, 0], float(known.period[0])
    integrator = hy.taylor_adaptive(equations(), [0.1] * 5, tol=TOLERANCES[-1], fast_math=True)

    def by_heyoka() -> float:
        integrator.time = 0.0
        integrator.state[:] = state
        integrator.propagate_until(period)
        return float(integrator.state[4])

    def repeated(work: Callable[[], float]) -> Callable[[], list[float]]:
        return lambda: [work() for _ in range(rounds)]

    own, rival = (taken / rounds for taken in in_turns(repeated(solve), repeated(by_heyoka)))
    errors = [abs(turn - true_turn) for turn in (solve(), by_heyoka())]
    ratio = own / rival
    return Ratio(
        what="default time integrator against heyoka at tolerance "
        f"{TOLERANCES[-1]:g}, one bounce of the paper's release",
        ratio=ratio,
        claim="" if most is None else f"at most {most:g} times slower",
        holds=most is None or (ratio <= most and errors[0] <= max(errors[1], ROUND_OFF)),
        first_s=own,
        second_s=rival,
        note=f"error of the turn {errors[0]:.1e} rad against {errors[1]:.1e} rad; compiling is not "
        "counted, and heyoka is told the period",
    )
