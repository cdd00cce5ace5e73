"""Laws that oppose theta', against a rigid body of six degrees of freedom in quaternions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from reference import PAPER_CAN, EffectError, Effects, Outcome, Problem, solve
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.can import Parameters
from reference.solver import SolverError
from tests.support.contour_friction import UP, balance, body

LOCUS = frozenset({"contact_locus"})
DISK = Parameters(a=0.25 + 0.17**2 / 3, c=0.5, h=0.17)
# Near steady rolling about a centre at rest, psi'^2 sin(phi) = 4 for a thin disk.
RELEASE = Problem(parameters=DISK, phi=0.2, psi_dot=4.4, theta_dot=-4.2, phi_dot=0.02, duration=2.0)
# Precession at 0.05 rad of such a rolling, to the square root of phi, and -theta' over it.
SPIN, AT_REST = math.sqrt(4 / 0.05), math.cos(0.05) - DISK.h * math.sin(0.05)
LAWS = {
    "dry": Effects(contour=0.01),
    "viscous": Effects(contour_damping=2e-3),
    "film": Effects(film=2e-4),
    "boundary layers": Effects(boundary_layer=1e-3),
    "all": Effects(contour=2e-3, contour_damping=1e-3, film=1e-4, boundary_layer=5e-4),
}


def started(problem: Problem) -> np.ndarray:
    """Return the state of the body at the release of a disk that rolls."""
    found = solve(replace(problem, effects=Effects(mu=50.0)), model="general").at(0.0)
    S, C = math.sin(problem.phi), math.cos(problem.phi)
    level, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    axis = C * UP - S * level
    w = problem.psi_dot * UP - problem.phi_dot * across + problem.theta_dot * axis
    assert found.phi[0] == pytest.approx(problem.phi)
    in_plane = (UP - C * axis) / S
    arm = -in_plane - DISK.h * axis
    attitude = Rotation.from_rotvec(-problem.phi * across)
    return np.concatenate([-arm, attitude.as_quat(), -np.cross(w, arm), w])


@pytest.mark.parametrize("name", LAWS)
def test_a_body_of_six_degrees_of_freedom_moves_the_same(name: str) -> None:
    effects = LAWS[name]
    problem = replace(RELEASE, effects=effects)
    ours = solve(problem, outputs=LOCUS)
    assert ours.outcome is Outcome.FINISHED
    times = np.linspace(0.0, problem.duration or 0.0, 40)
    theirs = solve_ivp(
        lambda _t, y: body(y, effects, DISK),
        (0.0, times[-1]),
        started(problem),
        "DOP853",
        t_eval=times,
        rtol=3e-13,
        atol=1e-14,
    )
    axis = Rotation.from_quat(theirs.y[3:7].T).apply(UP)
    states = ours.at(times)
    phi = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])
    psi = np.unwrap(np.arctan2(-axis[:, 1], -axis[:, 0]))
    # what the tolerance of DOP853 leaves after some turns
    assert np.abs(phi - states.phi).max() < 1e-10
    assert np.abs(psi - states.psi).max() < 1e-9


@pytest.mark.parametrize("name", LAWS)
def test_energy_is_there_or_lost_to_the_very_end(name: str) -> None:
    steady = replace(RELEASE, phi=0.05, psi_dot=SPIN, theta_dot=-SPIN * AT_REST, phi_dot=0.0)
    found = solve(replace(steady, effects=LAWS[name], duration=100.0), outputs=LOCUS)
    assert found.outcome is Outcome.FELL_FLAT
    assert balance(found) < 1e-13
    force = found.at(np.linspace(0.0, found.t_end, 500)).force
    assert force is not None
    assert force[:, 2].min() > 0.0


@pytest.mark.parametrize("law", ["contour", "contour_damping", "film", "boundary_layer"])
def test_a_weak_law_changes_the_rolling_can_in_proportion(law: str) -> None:
    times = np.linspace(0.1, 1.9, 10)
    ideal = solve(RELEASE, model="rolling").at(times).phi

    def change(strength: float) -> np.ndarray:
        effects = replace(Effects(), **{law: strength})  # type: ignore[arg-type]
        return np.asarray(solve(replace(RELEASE, effects=effects)).at(times).phi - ideal)

    one, half = change(2e-7), change(1e-7)
    # the second order is 1e-7 of the first times what a turn amplifies; round-off of phi 1e-8 of it
    assert np.abs(one - 2 * half).max() < 1e-3 * np.abs(one).max()


def test_dry_friction_holds_the_contact_point_until_it_must_run() -> None:
    """Upright in a plane theta' = 0 for good; a can that turns lets its point run and stop."""
    still = Problem(parameters=PAPER_CAN, phi=0.4, duration=3.0, effects=Effects(contour=0.01))
    fell = solve(still)
    assert fell.outcome is Outcome.FELL_FLAT
    assert np.abs(fell.at(np.linspace(0.0, fell.t_end, 50)).psi).max() == 0.0
    rocks = replace(still, psi_dot=0.05, theta_dot=0.02, effects=Effects(contour=0.05))
    found = solve(rocks, outputs=LOCUS)
    assert isinstance(found.path, SegmentsPath)
    assert {piece.mode.runs for piece in found.path.pieces} >= {0, 1}
    assert balance(found) < 1e-13


def test_compiled_code_leaves_these_laws_to_numpy() -> None:
    pytest.importorskip("numba")
    problem = replace(RELEASE, effects=LAWS["all"], duration=0.5)
    plain, asked = solve(problem), solve(problem, compiled=True)
    assert (plain.t_end, plain.evaluations) == (asked.t_end, asked.evaluations)
    assert asked.method == plain.method


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("contour", {"contour": -0.1}),
        ("film", {"film": math.nan}),
        ("contour", {"contour": 0.1, "rolling_resistance": 0.1}),
        ("mu_static", {"mu": 0.3, "mu_static": 0.2}),
        ("mu_static", {"mu_static": 0.2}),
    ],
)
def test_what_makes_no_sense_is_refused_by_its_key(key: str, values: dict[str, float]) -> None:
    with pytest.raises(EffectError) as caught:
        Effects(**values)  # type: ignore[arg-type]
    assert caught.value.key == key


def test_a_smaller_model_is_refused() -> None:
    with pytest.raises(SolverError, match="general"):
        solve(replace(RELEASE, effects=LAWS["film"]), model="coulomb")
