"""The reference against scipy and heyoka: the exact bounce in batches, and the time integrator.

Compiled kernels are asked for where numba is installed; compiling is not counted.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from reference import (
    PAPER_CAN,
    Effects,
    PeriodicMotions,
    Problem,
    Restitution,
    exact_bounces,
    solve,
)
from reference.numerics.compiled import available, path_taken
from tests.benchmarks import heyoka_rows
from tests.benchmarks.clock import Ratio, in_turns, seconds

_BATCH = 100_000
_HEYOKA_RELEASES = 20_000
_SCIPY_RELEASES = 12  # DOP853 takes tens of milliseconds each
_TURNS, _RUNS = 5, 10
_TIGHT = 1e-12
_SIDE = 400  # of the map
_SEED = 20230222
_DROPPED = 6.0  # in sqrt(R/g)
_SHORT_REPEATS = 3
_SCIPY_FASTER, _COMPILED_FASTER, _HEYOKA_SLOWER = 20.0, 100.0, 5.0
"""Claims: of the integrator over DOP853, of the compiled one, and of that one under heyoka."""


def reference_ratios() -> Iterator[Ratio]:
    """Measure the claims about the reference, one by one."""
    yield _batch_against_scipy()
    if not heyoka_rows.missing():
        yield from heyoka_rows.batch_ratios(_releases(_BATCH), _solved, _HEYOKA_RELEASES)
    yield from (_integrator_against_scipy(bounces) for bounces in (1, 3))
    if not heyoka_rows.missing():
        yield _integrator_against_heyoka()
    yield _sign_map()
    yield _bounces_of_a_dropped_can()


def _releases(count: int) -> dict[str, np.ndarray]:
    """Return random releases of the paper's can that bounce, from gentle to hard."""
    rng = np.random.default_rng(_SEED)
    return {
        "phi": rng.uniform(0.02, 0.5, count),
        "psi_dot": rng.uniform(-0.2, 0.2, count),
        "theta_dot": rng.uniform(-0.2, 0.2, count),
    }


def _solved(releases: Mapping[str, np.ndarray]) -> PeriodicMotions:
    """Return the exact bounces of releases, by compiled kernels where there is numba."""
    can = {"a": PAPER_CAN.a, "c": PAPER_CAN.c, "h": PAPER_CAN.h}
    return exact_bounces(**can, **releases, compiled=available())


def _batch(releases: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the angles of turn of releases, rad."""
    return _solved(releases).angle_of_turn


def _by_scipy(releases: dict[str, np.ndarray]) -> np.ndarray:
    """Return the angles of turn of a few releases by scipy's DOP853 in the paper's variables."""
    turns = []
    for phi, psi_dot, theta_dot in zip(*releases.values(), strict=True):
        problem = Problem(
            parameters=PAPER_CAN,
            phi=float(phi),
            psi_dot=float(psi_dot),
            theta_dot=float(theta_dot),
            bounces=1,
        )
        solution = solve(problem, model="rolling", method="DOP853", rtol=_TIGHT)
        turns.append(solution.bounces[0].angle_of_turn if solution.bounces else math.nan)
    return np.array(turns)


def _batch_against_scipy() -> Ratio:
    """Time 100,000 exact bounces, and DOP853 per bounce."""
    releases = _releases(_BATCH)
    few = {name: values[:_SCIPY_RELEASES] for name, values in releases.items()}
    batch, scipy = in_turns(lambda: _batch(releases), lambda: _by_scipy(few), repeats=2)
    difference = float(np.abs(_batch(few) - _by_scipy(few)).max())
    ratio = (scipy / _SCIPY_RELEASES) / (batch / _BATCH)
    return Ratio(
        what=f"exact bounce in a batch of {_BATCH:,} against DOP853, per bounce",
        ratio=ratio,
        claim="at least 1,000 times faster",
        holds=ratio >= 1000.0,
        first_s=batch / _BATCH,
        second_s=scipy / _SCIPY_RELEASES,
        note=f"{path_taken(compiled=available())}; DOP853 at rtol 1e-12 is within "
        f"{difference:.1e} rad of the exact turn",
    )


_UNIT = math.sqrt(0.037 / 9.81)  # s
_PAPER: dict[str, Any] = {
    "phi": math.pi / 100,
    "psi_dot": 0.1001 * _UNIT,
    "theta_dot": -0.1 * _UNIT,
}

_INTEGRATOR: dict[str, Any] = {"compiled": available()}
"""Options of the default integrator beside the model."""


def _paper_release(method: str | None, bounces: int) -> float:
    """Return the first angle of turn of the paper's release by time integration."""
    problem = Problem(parameters=PAPER_CAN, **_PAPER, bounces=bounces)
    chosen = _INTEGRATOR if method is None else {"method": method, "rtol": _TIGHT}
    solution = solve(problem, model="rolling", **chosen)
    return solution.bounces[0].angle_of_turn


_TRUE_TURN = math.radians(209.363400462452)
"""Of the paper's release, to 15 digits; see tests/reference/golden."""


def _integrator_against_scipy(bounces: int) -> Ratio:
    """Time bounces of the paper's release by the default integrator and by DOP853."""
    once, scipy = in_turns(
        lambda: _paper_release(None, bounces),
        lambda: _paper_release("DOP853", bounces),
        repeats=_TURNS,
        runs=_RUNS,
    )
    own_error = abs(_paper_release(None, bounces) - _TRUE_TURN)
    scipy_error = abs(_paper_release("DOP853", bounces) - _TRUE_TURN)
    least = _COMPILED_FASTER if _INTEGRATOR.get("compiled") else _SCIPY_FASTER
    named = "one bounce" if bounces == 1 else f"{bounces} bounces"
    return Ratio(
        what=f"default time integrator against DOP853 at rtol 1e-12, {named}",
        ratio=scipy / once,
        claim=f"at least {least:.0f} times faster, and at least as accurate",
        holds=scipy >= least * once and own_error <= scipy_error,
        first_s=once,
        second_s=scipy,
        note=f"error of the turn {own_error:.1e} rad against {scipy_error:.1e} rad",
    )


def _integrator_against_heyoka() -> Ratio:
    """Time one bounce of the paper's release by the default integrator and by heyoka."""
    release = {name: np.array([value]) for name, value in _PAPER.items()}
    return heyoka_rows.single_ratio(
        release,
        _solved(release),
        lambda: _paper_release(None, 1),
        _TRUE_TURN,
        _HEYOKA_SLOWER if _INTEGRATOR.get("compiled") else None,
    )


def _sign_map() -> Ratio:
    """Time the paper's sign map over a square of releases."""
    side = np.linspace(-1.0, 1.0, _SIDE) * _UNIT
    psi_dot, theta_dot = (grid.ravel() for grid in np.meshgrid(side, side))
    grid = {
        "phi": np.full(psi_dot.size, math.pi / 100),
        "psi_dot": psi_dot,
        "theta_dot": theta_dot,
    }
    taken = seconds(lambda: _batch(grid))
    limit = 10.0
    return Ratio(
        what=f"sign map over {_SIDE} x {_SIDE} releases against ten seconds",
        ratio=limit / taken,
        claim="under 10 s on one core",
        holds=taken < limit,
        first_s=taken,
        second_s=limit,
        note="",
    )


def _bounces_of_a_dropped_can() -> Ratio:
    """Time a can that is dropped on its rim, with friction, for each hundred of its impacts."""
    effects = Effects(mu=0.5, restitution=Restitution(coefficient=0.85))
    release = Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=0.3,
        theta_dot=-0.2,
        height=0.02,
        duration=_DROPPED,
        effects=effects,
    )
    count = len(solve(release).impacts)
    taken = min(seconds(lambda: solve(release)) for _ in range(_SHORT_REPEATS)) * 100 / count
    return Ratio(
        what="a hundred bounces of a dropped can with friction against one second",
        ratio=1.0 / taken,
        claim="under 1 s on one core",
        holds=taken < 1.0,
        first_s=taken,
        second_s=1.0,
        note=f"{count} impacts, up to the end of their infinite sequence and beyond",
    )
