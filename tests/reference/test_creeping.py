"""A can that falls on its face while dry friction along the rim all but stops its contact point."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from reference import PAPER_CAN, Effects, Mass, Outcome, Parameters, Problem, solve
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    PSI,
    ROWS,
    TIME,
    TOTAL,
    TURN,
    U1,
    W1,
    W2,
    W3,
    X,
    Y,
)
from reference.nonsmooth import creep
from reference.nonsmooth.hybrid_integrator import HybridIntegrator
from reference.nonsmooth.segments import SegmentsPath
from tests.support.contour_friction import UP, balance, body

LOCUS = frozenset({"contact_locus"})
CAN = Parameters(a=0.9, c=0.46, h=0.46)
DRY = Effects(contour=0.02)
W, FALLS, PSI_0 = 0.2, 0.5, 0.3
CANS = {
    "plain": (CAN, DRY),
    "rounded, damped": (CAN, replace(DRY, rim=0.1, linear_damping=0.1)),
    "loaded": (CAN, replace(DRY, mass=Mass(share=0.3, x=0.0, y=0.0, z=0.2))),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Fall:
    """The end of a fall, with the ratio and the exponent that its can has on the manifold."""

    outcome: Outcome | None
    end: np.ndarray
    path: SegmentsPath
    exponent: float


def manifold(can: Parameters, effects: Effects) -> tuple[float, float]:
    """Return k and p of `reference.equations.creeping`, per unit of the whole mass."""
    share, z = (effects.mass.share, effects.mass.z) if effects.mass else (0.0, 0.0)
    whole, radius = 1 + share, 1 - effects.rim
    h = can.h + share / whole * z
    a, c = (can.a + share / whole * z * z) / whole, can.c / whole
    p = h * h / ((a + h * h) * (1 + c / radius**2) - h * h)
    return (a + h * h) / (h * radius), p


def fallen(can: Parameters, effects: Effects, phi: float) -> Fall:
    """Follow a can that begins on the manifold of small phi."""
    ratio, exponent = manifold(can, effects)
    y = np.zeros(ROWS)
    y[LEAN], y[TURN] = np.log(np.tan(phi / 2)), (W, FALLS, ratio * W)
    y[PSI], y[TOTAL] = PSI_0, 1.0
    problem = Problem(parameters=can, phi=phi, duration=10.0, effects=effects)
    equations = GeneralEquations(parameters=can, effects=effects)
    integrator = HybridIntegrator(problem, equations, locus=True, start=y)
    path = integrator.follow()
    return Fall(
        outcome=integrator.watch.outcome,
        end=integrator.reached[0],
        path=path,
        exponent=exponent,
    )


@pytest.mark.parametrize("name", CANS)
def test_what_a_contact_point_turns_before_its_face_lands_has_a_closed_form(name: str) -> None:
    can, effects = CANS[name]
    missed = []
    for phi in (1e-6, 1e-8):
        fall = fallen(can, effects, phi)
        assert fall.outcome is Outcome.FELL_FLAT
        assert fall.end[[W1, W3, U1]].tolist() == [0.0, 0.0, 0.0]
        missed.append((fall.end[PSI] - PSI_0 - W / (fall.exponent * FALLS), fall.end[W2] - FALLS))
        # round the centre of the face, which rests
        radius = 1 - effects.rim
        moved = np.array([np.cos(PSI_0), np.sin(PSI_0)]) * radius
        moved -= np.array([np.cos(fall.end[PSI]), np.sin(fall.end[PSI])]) * radius
        assert np.abs(fall.end[[X, Y]] - moved).max() < 10 * phi
    # the closed form leaves out the terms of S, of which phi is the first order
    assert np.array(missed[0]) == pytest.approx(100 * np.array(missed[1]), rel=1e-3)
    assert np.abs(missed[1]).max() < 1e-6


@pytest.mark.parametrize("phi", [1e-2, 1e-3])
def test_it_does_not_matter_where_the_normal_force_becomes_a_state(
    phi: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = []
    for share in (0.1, 1e-5):
        monkeypatch.setattr(creep, "CENTRIFUGAL", share)
        fall = fallen(CAN, DRY, phi)
        kinds = [piece.mode.creeps for piece in fall.path.pieces]
        assert True in kinds
        assert False in kinds
        ends.append(fall.end)
    # round-off of w in the normal force, 1e-16 w1^2/S, by which the later one loses energy
    assert np.abs(ends[0] - ends[1])[[PSI, W2]].max() < 1e-14
    assert abs(ends[0] - ends[1])[DISSIPATED] < 1e-12


def test_the_energy_is_there_or_lost_and_the_plane_pushes_to_the_last() -> None:
    ratio, _ = manifold(CAN, DRY)
    problem = Problem(
        parameters=CAN,
        phi=0.01,
        phi_dot=-FALLS,
        psi_dot=W / np.sin(0.01),
        theta_dot=ratio * W - W / np.tan(0.01),
        duration=10.0,
        effects=DRY,
    )
    found = solve(problem, outputs=LOCUS)
    assert found.outcome is Outcome.FELL_FLAT
    assert balance(found) < 1e-13
    late = found.t_end * (1 - np.logspace(-15, 0, 400))
    force = found.at(np.append(late, found.t_end)).force
    assert force is not None
    assert force[:-1, 2].min() > 0.0
    assert force[-1, 2] == 0.0


@pytest.mark.slow
def test_a_body_of_six_degrees_of_freedom_falls_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    # earlier than need be: an explicit method can follow it down to 1e-4 rad
    monkeypatch.setattr(creep, "CENTRIFUGAL", 1.0)
    effects, phi, psi_dot = Effects(contour=0.05), 0.01, 60.0
    theta_dot = 1.3 - psi_dot * np.cos(phi)
    problem = Problem(
        parameters=CAN,
        phi=phi,
        phi_dot=-FALLS,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        duration=1.0,
        effects=effects,
    )
    ours = solve(problem, outputs=LOCUS)
    assert isinstance(ours.path, SegmentsPath)
    level, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    axis = np.cos(phi) * UP - np.sin(phi) * level
    w = psi_dot * UP + FALLS * across + theta_dot * axis
    arm = -(UP - np.cos(phi) * axis) / np.sin(phi) - CAN.h * axis
    attitude = Rotation.from_rotvec(-phi * across).as_quat()
    start = np.concatenate([-arm, attitude, -np.cross(w, arm), w])
    times = ours.t_end - np.geomspace(ours.t_end, 2e-4, 15)
    begins = min(piece.start[TIME] for piece in ours.path.pieces if piece.mode.creeps)
    assert begins < times[2]
    theirs = solve_ivp(
        lambda _t, y: body(y, effects, CAN),
        (0.0, times[-1]),
        start,
        "DOP853",
        t_eval=times,
        rtol=1e-12,
        atol=1e-14,
    )
    axis = Rotation.from_quat(theirs.y[3:7].T).apply(UP)
    states = ours.at(times)
    sine, psi = np.hypot(axis[:, 0], axis[:, 1]), np.unwrap(np.arctan2(-axis[:, 1], -axis[:, 0]))
    # the tolerance of DOP853, over phi where it is a direction
    assert np.abs(sine - np.sin(states.phi)).max() < 1e-13
    assert np.abs(psi - states.psi).max() < 1e-12 / states.phi[-1]


@pytest.mark.parametrize(
    "can", [Parameters(a=0.16, c=0.05, h=2.0), Parameters(a=0.5, c=0.3, h=1.0)]
)
def test_a_slender_can_is_stopped_by_its_weight(can: Parameters) -> None:
    """Of p > 1, whose normal force does not stay small, and is never taken for a state."""
    fall = fallen(can, DRY, 1e-5)
    assert fall.exponent > 1.0
    assert fall.outcome is Outcome.FELL_FLAT
    modes = [piece.mode for piece in fall.path.pieces]
    assert not any(mode.creeps for mode in modes)
    assert modes[-1].runs == 0
    assert fall.end[U1] == 0.0


def test_a_can_that_is_not_mirrored_in_its_lean_does_not_creep() -> None:
    beside = replace(DRY, mass=Mass(share=0.3, x=0.1, y=0.0, z=0.0))
    assert not any(piece.mode.creeps for piece in fallen(CAN, beside, 1e-4).path.pieces)


@pytest.mark.parametrize("psi_dot", [1e-8, 1e-6, 1e-4])
def test_a_bounce_however_deep_does_not_creep(psi_dot: float) -> None:
    """S is below 1e-3 w1^2 there too, but the parts of the normal force do not cancel."""
    effects = Effects(contour=0.01 * psi_dot)
    deep = Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=psi_dot,
        theta_dot=-psi_dot / 2,
        bounces=2,
        effects=effects,
    )
    solution = solve(deep, model="general")
    assert isinstance(solution.path, SegmentsPath)
    assert not any(piece.mode.creeps for piece in solution.path.pieces)
    assert solution.outcome is Outcome.FINISHED
    assert len(solution.bounces) == 2
