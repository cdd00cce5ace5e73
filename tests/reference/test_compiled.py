"""Compiled code gives what numpy gives: contact and rates to a few eps, motions to round-off."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Effects,
    Gravity,
    Mass,
    Outcome,
    Parameters,
    Problem,
    SolverError,
    exact_bounces,
    solve,
    solver,
)
from reference.equations.compiled_equations import (
    CONTACT_ROWS,
    FORCE,
    MOBILITY,
    MOMENT,
    SLIPPING,
    TURNING,
    CompiledEquations,
)
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import U1, U2, W1, W2, W3, tail_of
from reference.equations.steady_motion import steady_rotation
from reference.nonsmooth.radau_iia import STAGES
from reference.problem.states import Floats
from tests.support.compiled import needs_numba

GOLDEN = json.loads((Path(__file__).parent / "golden" / "golden.json").read_text())
EPS = float(np.finfo(float).eps)
LOCUS = frozenset({"contact_locus"})
TILT = (0.1, 0.05, -float(np.sqrt(1 - 0.1**2 - 0.05**2)))
MASS = Mass(share=0.1, x=0.3, y=-0.2, z=0.4)
GENTLE = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.1, theta_dot=-0.05, duration=4.0)
EVERYTHING = Effects(
    mu=0.3,
    linear_damping=0.05,
    angular_damping=0.02,
    rim=0.05,
    mass=MASS,
    drilling=0.01,
    rolling_resistance=0.002,
    gravity=Gravity(constant=TILT, amplitude=(0.05, 0.0, 0.1), rate=3.0, phase=0.3),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Windy(Effects):
    """Effects with one that no kernel carries."""

    wind: float = 0.0


@needs_numba
@pytest.mark.parametrize(("wind", "method"), [(0.0, "half-period, compiled"), (1.0, "half-period")])
def test_effects_that_no_kernel_carries_are_computed_in_numpy(wind: float, method: str) -> None:
    problem = replace(GENTLE, duration=0.1, effects=Windy(mu=0.3, wind=wind))
    assert CompiledEquations.know(problem.effects) == (wind == 0)
    assert solve(problem, compiled=True).method == method


@needs_numba
@pytest.mark.parametrize("imaginary", [0.0, 1e-3], ids=["real", "complex"])
@pytest.mark.parametrize(
    ("effects", "mode"),
    [
        (Effects(mu=0.3), Mode()),
        (Effects(mu=0.3), Mode(slips=True)),
        (EVERYTHING, Mode()),
        (EVERYTHING, Mode(slips=True, turns=-1)),
        (EVERYTHING, Mode(turns=1)),
        (EVERYTHING, Mode(rests=True)),
        (EVERYTHING, Mode(slips=True, rests=True)),
    ],
)
def test_contact_and_rates_are_those_of_numpy(
    effects: Effects, mode: Mode, imaginary: float
) -> None:
    plain = GeneralEquations(parameters=PAPER_CAN, effects=effects)
    compiled = CompiledEquations.of(plain, replace(GENTLE, effects=effects))
    rng = np.random.default_rng(4)
    y = 0.3 * rng.normal(size=(13, 16))
    y[0] -= 1.0
    if imaginary:
        y = y + 1j * imaginary * rng.normal(size=y.shape)
    # some hundred roundings of numbers of size 1
    assert np.abs(compiled.rates(y, mode) - plain.rates(y, mode)).max() < 64 * EPS
    mine, theirs = compiled.contact(y, mode), plain.contact(y, mode)
    for name in ("force", "moment", "turning", "slipping", "normal_mobility"):
        assert np.abs(getattr(mine, name) - getattr(theirs, name)).max() < 64 * EPS, name


@needs_numba
@pytest.mark.parametrize("slips", [False, True])
def test_a_rim_without_moments_of_friction_needs_fewer_equations(*, slips: bool) -> None:
    from reference.equations import kernels, rim_kernels  # noqa: PLC0415 - numba comes with them

    effects = replace(EVERYTHING, drilling=0.0, rolling_resistance=0.0)
    plain = GeneralEquations(parameters=PAPER_CAN, effects=effects)
    constants = CompiledEquations.of(plain, replace(GENTLE, effects=effects)).constants
    y = 0.3 * np.random.default_rng(4).normal(size=(13, 16))
    y[0] -= 1.0
    theirs, here = plain.contact(y, Mode(slips=slips)), np.empty(CONTACT_ROWS)
    for j in range(16):
        kernels.contact_of(constants, (slips, 0, False), y, j, np.empty((10, 6)), here)
        assert np.abs(here[FORCE:MOMENT] - theirs.force[:, j]).max() < 64 * EPS
        assert np.abs(here[TURNING:SLIPPING] - theirs.turning[:, j]).max() < 64 * EPS
        assert np.abs(here[SLIPPING:MOBILITY] - theirs.slipping[:, j]).max() < 64 * EPS
        assert not slips or abs(here[MOBILITY] - theirs.normal_mobility[j]) < 64 * EPS
    rows, rates, of_rim = (
        [W1, W2, W3, U1, U2],
        plain.rates(y, Mode(slips=slips)),
        np.empty((13, 16)),
    )
    rim_kernels.rim_rates(constants, slips, y, np.empty(rim_kernels.WORK_ROWS * 16), of_rim)
    assert np.abs(of_rim[rows] - rates[rows]).max() < 64 * EPS


@needs_numba
@pytest.mark.parametrize("resistance", [0.0, 0.01])
def test_a_step_is_judged_by_the_same_tail(resistance: float) -> None:
    from numba import njit  # noqa: PLC0415 - an extra

    from reference.nonsmooth import collocation_kernels  # noqa: PLC0415 - numba comes with it

    kernel, constants = collocation_kernels.tail_and_present, np.zeros(21)
    constants[17] = resistance
    rng = np.random.default_rng(6)

    def judged(E: Floats, start: Floats, series: Floats) -> tuple[float, int]:
        return kernel(E, start, series)

    compiled: Any = njit(judged)
    for _ in range(20):
        start = rng.normal(size=13) * 10.0 ** rng.uniform(-6, 1, 13)
        series = rng.normal(size=(13, STAGES + 1)) * 10.0 ** -np.arange(STAGES + 1)
        expected = tail_of(start, series, resisted=resistance > 0)
        assert compiled(constants, start, series)[0] == pytest.approx(expected, rel=4 * EPS)


@needs_numba
@pytest.mark.parametrize(
    ("method", "allowed"), [("half-period", 1e-10), ("picard-chebyshev", 3e-8)]
)
def test_golden_digits(method: str, allowed: float) -> None:
    """Ten of them at least; fewer where a return amplifies round-off: 1.6e-8 on one machine."""
    for row in GOLDEN[::7]:
        release = {name: row[name] for name in ("phi", "phi_dot", "psi_dot", "theta_dot")}
        can = Parameters(a=row["a"], c=row["c"], h=row["h"])
        problem = Problem(parameters=can, bounces=2, **release)
        plain = solve(problem, model="rolling", method=method)
        found = solve(problem, model="rolling", method=method, compiled=True)
        assert found.method == f"{method}, compiled"
        assert found.outcome is plain.outcome
        for name in ("angle_of_turn", "rotation_turn", "phi_min", "peak_psi_dot"):
            truth = float(row[name])
            assert getattr(found.bounces[1], name) == pytest.approx(truth, rel=allowed, abs=0), name


@needs_numba
def test_random_releases_are_solved_as_by_quadrature() -> None:
    rng = np.random.default_rng(9)
    count = 40
    release = {
        "phi": rng.uniform(0.02, 0.5, count),
        "psi_dot": rng.uniform(-0.2, 0.2, count),
        "theta_dot": rng.uniform(-0.2, 0.2, count),
    }
    exact = exact_bounces(
        a=0.727,
        c=0.615,
        h=1.473,
        phi=release["phi"],
        psi_dot=release["psi_dot"],
        theta_dot=release["theta_dot"],
    )
    for number in range(count):
        problem = Problem(
            parameters=PAPER_CAN,
            phi=float(release["phi"][number]),
            psi_dot=float(release["psi_dot"][number]),
            theta_dot=float(release["theta_dot"][number]),
            bounces=1,
        )
        found = solve(problem, model="rolling", compiled=True)
        assert found.outcome is Outcome.FINISHED
        turn = exact.angle_of_turn[number]
        assert found.bounces[0].angle_of_turn == pytest.approx(turn, rel=1e-11)


@needs_numba
@pytest.mark.parametrize(
    ("effects", "slip"),
    [
        (Effects(mu=0.01), (0.0, 0.0)),
        (Effects(mu=0.2), (0.05, 0.02)),
        (Effects(gravity=Gravity(constant=TILT)), (0.0, 0.0)),
        (Effects(mass=MASS, rim=0.1, linear_damping=0.05, angular_damping=0.02), (0.0, 0.0)),
        (Effects(drilling=0.01), (0.0, 0.0)),
        (Effects(rolling_resistance=0.002), (0.0, 0.0)),
        (Effects(mu=0.06, mass=MASS, linear_damping=0.05, angular_damping=0.02), (0.05, 0.02)),
        (EVERYTHING, (0.0, 0.0)),
    ],
    ids=lambda given: "+".join(given.declared()) if isinstance(given, Effects) else "",
)
def test_effects_move_the_can_as_in_numpy(effects: Effects, slip: tuple[float, float]) -> None:
    problem = replace(GENTLE, effects=effects, slip=slip)
    plain = solve(problem, outputs=LOCUS)
    found = solve(problem, outputs=LOCUS, compiled=True)
    assert found.method == "half-period, compiled"
    assert found.outcome is plain.outcome
    assert [phase.kind for phase in found.phases] == [phase.kind for phase in plain.phases]
    times = np.linspace(0.0, min(found.t_end, plain.t_end), 300)
    mine, theirs = found.at(times), plain.at(times)
    for name in ("phi", "psi", "theta", "x", "y", "slip", "force"):
        apart = np.abs(getattr(mine, name) - getattr(theirs, name)).max()
        # forty steps, each of some round-offs, which a bounce amplifies a hundredfold
        assert apart < 1e-10, name
    assert np.abs(found.lost(times) - plain.lost(times)).max() < 1e-11


@needs_numba
@pytest.mark.parametrize("nutation", [0.0, 1e-13, 1e-10])
def test_steady_rolling_is_a_few_long_steps_and_a_faint_nutation_is_none(nutation: float) -> None:
    """What changes by round-off alone stays; what nutates with an amplitude of 1e-13 does that."""
    phi, psi_dot = 0.3, 1.2282770973728538
    steady = Problem(
        parameters=PAPER_CAN,
        phi=phi,
        psi_dot=psi_dot,
        theta_dot=steady_rotation(PAPER_CAN, phi, psi_dot),
        phi_dot=nutation,
        duration=30.0,
        effects=Effects(mu=1.0),
    )
    own, plain = solve(steady, compiled=True), solve(steady)
    times = np.linspace(0.0, 30.0, 301)
    moved, expected = own.at(times), plain.at(times)
    assert (own.steps < 6) == (nutation == 0.0)
    assert np.abs(moved.psi - psi_dot * times).max() < 1e-14 * psi_dot * 30 + 10 * nutation
    assert np.abs(moved.psi - expected.psi).max() < 1e-13
    # of a rate next to nothing the round-off of the others is left
    assert np.abs(moved.phi_dot - expected.phi_dot).max() < 3e-15
    if nutation:
        assert np.abs(moved.phi_dot).max() == pytest.approx(nutation, rel=0.1)


@needs_numba
@pytest.mark.parametrize(
    ("phi", "psi_dot", "theta_dot", "effects"),
    [
        (0.07, 0.05, 1.6, Effects(mu=5.0)),
        (0.3, 0.12, -0.06, Effects(mu=0.3)),
        (0.3, 0.4, -0.3, Effects(mu=5.0, angular_damping=0.02)),
    ],
)
def test_a_step_that_is_shortened_is_no_steady_motion(
    phi: float, psi_dot: float, theta_dot: float, effects: Effects
) -> None:
    """Its guess is the longer step, which a first round does not change either."""
    moves = Problem(
        parameters=PAPER_CAN,
        phi=phi,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        duration=10.0,
        effects=effects,
    )
    own, plain = solve(moves, compiled=True), solve(moves)
    times = np.linspace(0.0, 10.0, 101)
    for name in ("phi", "psi", "theta"):
        apart = getattr(own.at(times), name) - getattr(plain.at(times), name)
        assert np.abs(apart).max() < 1e-11, name


def test_compiled_code_without_numba_is_one_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solver, "available", lambda: False)
    with pytest.raises(SolverError, match="install the extra `fast`"):
        solve(GENTLE, model="rolling", compiled=True)
